"""Data of a comparison that several rules need."""

from __future__ import annotations

import pytest

from icdgen.diff.context import ComparisonContext, by_id, free_before
from icdgen.diff.match import match
from icdgen.diff.pairs import FieldPair, MessagePair
from tests.icd.files import loaded


def field(at: int, bits: int, name: str, **more: object) -> str:
    rest = "".join(f", {key}: {value}" for key, value in more.items())
    return f"at: {at}, bits: {bits}, name: {name}, type: uint{rest}"


def status(*fields: str, length: int, name: str = "Status", id: int = 130) -> str:
    rows = "".join(f"      - {{{each}}}\n" for each in fields)
    return (
        f"  - name: {name}\n    id: {id}\n    kind: telemetry\n    length: {length}\n"
        + (f"    fields:\n{rows}" if fields else "")
    )


@pytest.fixture
def context(tmp_path):
    """Return a function that compares two texts."""

    def compare(old: str, new: str, head: str = "messages:\n") -> ComparisonContext:
        sides = []
        for name, text in (("old", old), ("new", new)):
            (tmp_path / name).mkdir(exist_ok=True)
            sides.append(loaded(tmp_path / name, head + text).icd)
        return ComparisonContext(match(*sides))

    return compare


def pair_of(context: ComparisonContext) -> MessagePair:
    ((pair,),) = (node.messages for node in context.match.nodes)
    return pair


def names(pairs: list[FieldPair]) -> list[str]:
    return [pair.any.name for pair in pairs]


A, B, C = field(0, 8, "A1"), field(8, 8, "B1"), field(16, 8, "C1")


@pytest.mark.parametrize(
    ("old", "new", "lengths", "expected"),
    [
        ([A], [A, B, C], (1, 3), ["B1", "C1"]),
        ([A, B, C], [A], (3, 1), ["B1", "C1"]),
        ([A], [A, B], (2, 3), []),  # within the old frame
        ([A], [A, B, C], (2, 3), ["C1"]),
        ([A], [A, B], (2, 2), []),
        ([A, B], [A, C], (2, 3), ["C1"]),
        ([A], [A], (1, 2), []),
    ],
)
def test_fields_at_the_end_are_beyond_the_shorter_frame(
    context, old, new, lengths, expected
):
    compared = context(status(*old, length=lengths[0]), status(*new, length=lengths[1]))
    pair = pair_of(compared)
    assert names(compared.at_the_end(pair)) == expected
    for each in pair.parts:
        assert compared.is_reported_for_message(each) is (each.any.name in expected)


def test_a_message_is_touched_before_a_bit_by_changes_in_front_of_it(context):
    inserted = context(status(A, B, length=2), status(A, B, C, length=3))
    pair = pair_of(inserted)
    assert [inserted.is_touched_before(pair, bit) for bit in (0, 16, 17)] == [
        False,
        False,
        True,
    ]
    moved = context(status(A, length=2), status(field(8, 8, "A1"), length=2))
    assert moved.is_touched_before(pair_of(moved), 0)


@pytest.mark.parametrize(
    ("old", "new", "is_free"),
    [
        ([A], [A, B], True),
        ([A, field(8, 4, "B1")], [A, field(8, 4, "B1"), field(12, 4, "D1")], True),
        ([A, field(8, 5, "B1")], [A, field(8, 4, "B1"), field(12, 4, "D1")], False),
        ([A, B], [A, field(8, 8, "D1"), field(16, 8, "B1")], False),
        (
            [A, "at: 8, bits: 16, name: Raw, type: bytes"],
            [A, field(23, 1, "D1")],
            False,
        ),
        ([A, B], [A, B, "at: 16, bits: 8, name: D1, type: bytes"], True),
    ],
)
def test_an_added_field_was_free_if_no_field_had_any_of_its_bits(
    context, old, new, is_free
):
    pair = pair_of(context(status(*old, length=3), status(*new, length=3)))
    assert [free_before(each) for each in pair.gained] == [is_free]


def test_messages_are_grouped_by_one_of_their_ids(context):
    text = (
        status(A, length=1, name="One", id=130)
        + status(A, length=1, name="Two", id=131)
        + "  - {name: Set, id: 130, kind: telecommand, length: 0}\n"
        "  - {name: Both, set_id: 7, get_id: 8, kind: configuration, length: 0}\n"
    )
    messages = context(text, text).match.new.nodes[0].messages
    grouped = {
        key: {id: [m.name for m in each] for id, each in by_id(messages, key).items()}
        for key in ("telemetry_id", "telecommand_id")
    }
    assert grouped == {
        "telemetry_id": {130: ["One"], 131: ["Two"], 8: ["Both"]},
        "telecommand_id": {130: ["Set"], 7: ["Both"]},
    }
    double = [*messages, messages[0]]
    assert [m.name for m in by_id(double, "telemetry_id")[130]] == ["One", "One"]


ENUMS = (
    "enums:\n"
    "  - name: Mode\n    members: [{value: 0, name: Idle}]\n"
    "  - name: Unused\n    members: [{value: 0, name: None}]\n"
    "messages:\n"
)


def test_users_of_an_enumeration_are_its_fields_in_the_new_icd(context):
    old = status("at: 0, bits: 8, name: Old, type: enum, enum: Mode", length=1)
    new = status(
        "at: 0, bits: 8, name: A1, type: enum, enum: Mode",
        "at: 8, bits: 8, name: B1, type: enum, enum: Mode",
        length=2,
    )
    compared = context(old, new, ENUMS)
    mode, unused = compared.match.new.nodes[0].enums
    assert compared.users == {id(mode): ["Status: A1", "Status: B1"]}
    assert id(unused) not in compared.users
    assert [pair.any.name for pair in compared.changed] == ["Status"]


def test_a_message_that_a_node_no_longer_includes_is_not_used(tmp_path):
    part = (
        "icdgen: 1\nnode: {name: part, title: Part, byte_order: little, bit_order: lsb0}\n"
        f"messages:\n{status(A, length=1)}"
    )
    head = "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n%smessages: []\n"
    sides = []
    for name, includes in (("old", "include: [part.yaml]\n"), ("new", "")):
        (tmp_path / name).mkdir()
        text = f"{head % includes}# part.yaml\n{part}"
        sides.append(loaded(tmp_path / name, text).icd)
    compared = ComparisonContext(match(*sides))
    nodes = {node.any.name: node for node in compared.match.nodes}

    def not_used(name: str, side: int) -> list[str]:
        return [m.name for m in compared.messages_not_used(nodes[name], side)]

    assert (not_used("demo", 0), not_used("demo", 1)) == (["Status"], [])
    assert (not_used("part", 0), not_used("part", 1)) == ([], [])
