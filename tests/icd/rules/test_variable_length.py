"""Rules of messages of variable length, apart from the checks of one field."""

from __future__ import annotations

import pytest

from tests.icd.rules.reported import messages, reported
from tests.limits import assert_limits


def message(
    name: str, *fields: str, id: int = 1, length: int = 1, keys: str = ""
) -> str:
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    head = (
        f"  - name: {name}\n    id: {id}\n    kind: telemetry\n    length: {length}\n"
    )
    return f"{head}{keys}    fields:\n{rows}"


COUNTER = "at: 0, bits: 8, name: Number, type: uint"
ITEMS = (
    "at: 8, bits: 8, name: Items, type: uint, count: {field: Number, plus: 2}, up_to: 9"
)


def test_fields_of_fixed_size_have_no_largest_size(tmp_path):
    """An array has a count, any other field has bits."""
    text = "messages:\n" + message(
        "Status",
        "at: 0, bits: 8, name: Level, type: uint, up_to: 9",
        "at: 8, bits: 8, name: Levels, type: uint, count: 4, up_to: 9",
        length=5,
    )
    help = "remove `up_to`; the largest value of a number is `max`"
    no_effect = "so `up_to` has no effect"
    assert reported(tmp_path, text, "ICD120") == [
        (9, "9", f"`Level` has a fixed size (`bits`), {no_effect}", help),
        (10, "9", f"`Levels` has a fixed size (`count: 4`), {no_effect}", help),
    ]
    text = "messages:\n" + message("Status", COUNTER, ITEMS)
    assert reported(tmp_path, text, "ICD120") == []


@pytest.mark.parametrize("is_last", [True, False])
def test_an_overlay_field_reads_bits_that_every_frame_has(is_last, tmp_path):
    """These are the bits in front of the items and of two items, if the items are the
    last part.
    """
    more = ["at: 8, after: Items, name: More, type: bytes, size: rest, up_to: 9"]

    def text(end: int) -> str:
        overlay = f"at: 0, bits: {end}, name: All, type: uint, view: true"
        return "messages:\n" + message(
            "Status", COUNTER, ITEMS, *more[is_last:], overlay
        )

    def is_accepted(end: int) -> bool:
        return reported(tmp_path, text(end), "ICD121") == []

    most = 24 if is_last else 8
    assert_limits(is_accepted, most=most)
    assert reported(tmp_path, text(most + 1), "ICD121") == [
        (
            11 + (not is_last),
            "0",
            "`All` is an overlay of `Items`, which not every frame has",
            "place the overlay on fields that every frame has",
        )
    ]


def test_the_last_part_that_an_overlay_field_reads_is_named(tmp_path):
    """`Items` can end at bit 80."""
    more = "at: 8, after: Items, name: More, type: bytes, size: rest, up_to: 9"
    for at, bits, name in ((8, 8, "Items"), (16, 64, "Items"), (24, 64, "More")):
        overlay = f"at: {at}, bits: {bits}, name: All, type: uint, view: true"
        text = "messages:\n" + message("Status", COUNTER, ITEMS, more, overlay)
        assert messages(tmp_path, text, "ICD121") == [
            f"`All` is an overlay of `{name}`, which not every frame has"
        ]


def test_a_field_without_a_variable_length_in_front_has_no_after(tmp_path):
    """Each is reported, also in a struct."""
    after = "at: 0, bits: 8, after: Number, name: {}, type: uint"
    text = (
        "structs:\n  - name: Pair\n    length: 1\n    fields:\n      - {"
        + after.format("Low")
        + "}\n"
    )
    text += "messages:\n" + message("Status", after.format("One"), after.format("Two"))
    found = reported(tmp_path, text, "ICD121")
    assert [each for each in found if "so its place is `at`" in each.message] == [
        (
            line,
            "Number",
            f"`{name}` has `after`, but `{owner}` has no variable-length field, so its "
            "place is `at`",
            "remove `after`",
        )
        for line, name, owner in ((7, "Low", "Pair"), (14, "One", "Status"), (15, "Two", "Status"))
    ]  # fmt: skip


CAN = "protocol: {link: {buses: {can: {max_data_bytes: 8}}}}\n"


@pytest.mark.parametrize(
    ("plus", "up_to", "lengths"), [(2, 9, "3 to 10 bytes"), (0, 1, "1 to 2 bytes")]
)
def test_every_message_of_variable_length_on_a_link_is_reported(
    plus, up_to, lengths, tmp_path
):
    items = ITEMS.replace("plus: 2", f"plus: {plus}").replace("9", str(up_to))
    rows = [message(name, COUNTER, items, id=id) for id, name in enumerate("AB", 1)]
    text = f"messages:\n{message('Fixed', COUNTER, id=3)}{''.join(rows)}"
    expected = [
        (
            line,
            "1",
            f"`{name}` has {lengths}, but the links in `protocol` need one length per "
            "message",
            "leave `protocol` out of this ICD, or give the message a fixed `count`",
        )
        for line, name in ((14, "A"), (21, "B"))
    ]
    assert reported(tmp_path, CAN + text, "ICD122") == expected
    assert reported(tmp_path, text, "ICD122") == []


def test_a_composite_message_contains_messages_of_one_length(tmp_path):
    """Every other part is reported, each at its place."""
    text = (
        "messages:\n"
        + message("Open", COUNTER, ITEMS)
        + message("Fixed", COUNTER, id=2)
    )
    text += (
        "  - name: All\n    id: 3\n    kind: telemetry\n    length: 3\n    contains:\n"
        + "".join(
            f"      - {{at: {8 * at}, message: {name}}}\n"
            for at, name in enumerate(("Open", "Fixed", "Open", "None"))
        )
    )
    assert reported(tmp_path, text, "ICD122") == [
        (
            line,
            "Open",
            "`Open` has no fixed length, so `All` cannot repeat it",
            "remove it from `contains`",
        )
        for line in (22, 24)
    ]


def test_a_composite_message_contains_no_message_of_another_node(tmp_path):
    head = "icdgen: 1\nnode: {name: base, title: Base, byte_order: little, bit_order: lsb0}\n"
    open_message = "messages:\n" + message("Open", COUNTER, ITEMS)
    text = (
        "messages:\n  - name: All\n    id: 3\n    kind: telemetry\n    length: 3\n"
        f"    contains:\n      - {{at: 0, message: Open}}\n# base.yaml\n{head}{open_message}"
    )
    assert messages(tmp_path, text, "ICD122") == []
    assert messages(tmp_path, f"include: [base.yaml]\n{text}", "ICD122") == [
        "`Open` has no fixed length, so `All` cannot repeat it"
    ]


EARLY = "    may_end_early: zeros\n"
WORD, BYTE = (
    "at: 0, bits: 16, name: A, type: uint",
    "at: 0, bits: 8, name: A, type: uint",
)
REST = "at: 0, name: A, type: bytes, size: rest, up_to: 9"
NEED_ONE = "may end early, but the links in `protocol` need one length per message"
ALWAYS_SENT = "has 1 byte, and the first byte is always sent"
BELONG = "has a variable-length field, and the zeros at the end of a frame belong to it"


@pytest.mark.parametrize(
    ("head", "length", "field", "why"),
    [
        ("", 2, WORD, None),
        (CAN, 2, WORD, NEED_ONE),
        (CAN, 1, BYTE, ALWAYS_SENT),
        (CAN, 0, REST, BELONG),
    ],
)
def test_the_first_reason_against_an_early_end_is_named(
    head, length, field, why, tmp_path
):
    text = f"{head}messages:\n" + message("Status", field, length=length, keys=EARLY)
    line = 8 + (head != "")
    expected = (line, "zeros", f"`Status` {why}", "remove `may_end_early`")
    assert reported(tmp_path, text, "ICD150") == ([expected] if why else [])
