"""Parts of the matching: pairs by name, by score, and shifted fields."""

from __future__ import annotations

from itertools import permutations
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.diff import match
from icdgen.diff.match import _best_pairs, _by_name, _layouts_alike, _Shifts
from tests.diff.cases import compared_texts
from tests.limits import assert_limits


def named(*names: str) -> list[SimpleNamespace]:
    return [SimpleNamespace(name=name, at=at) for at, name in enumerate(names)]


def test_equal_names_are_pairs_and_repeated_names_in_their_order():
    old, new = named("A", "B", "A", "C", "A"), named("D", "A", "C", "A")
    pairs, (left_old, left_new) = _by_name(old, new)
    assert [(a.at, b.at, sure) for a, b, sure in pairs] == [
        (0, 1, 1.0),
        (2, 3, 1.0),
        (3, 2, 1.0),
    ]
    assert [a.at for a in left_old] == [1, 4]
    assert [b.at for b in left_new] == [0]


SCORES = st.sampled_from([0.0, 0.4, 0.5, 0.6, 0.8, 1.0])


@settings(max_examples=40)
@given(st.lists(st.lists(SCORES, min_size=4, max_size=4), min_size=3, max_size=3))
def test_the_best_pairs_are_selected_by_score_then_by_position(scores):
    """As an obvious selection does, and equally for swapped sides."""
    left = {(i, j): scores[i][j] for i in range(3) for j in range(4)}
    expected = []
    while left:
        (i, j), score = min(
            left.items(),
            key=lambda item: (
                -item[1],
                abs(item[0][0] - item[0][1]),
                sum(item[0]),
                item[0],
            ),
        )
        if score < 0.5:
            break
        expected.append((i, j, min(score, 0.99)))
        left = {(a, b): s for (a, b), s in left.items() if a != i and b != j}

    def every(index: int) -> tuple[str]:
        return ("all",)

    pairs = _best_pairs(range(3), range(4), lambda i, j: scores[i][j], 0.5, every)
    assert pairs == expected
    swapped = _best_pairs(range(4), range(3), lambda j, i: scores[i][j], 0.5, every)
    assert sorted((i, j, sure) for j, i, sure in swapped) == sorted(expected)


def test_only_objects_with_a_common_key_are_compared():
    seen = []

    def score(old: str, new: str) -> float:
        seen.append((old, new))
        return 1.0

    pairs = _best_pairs(["ab", "c"], ["bd", "ce", "f"], score, 0.5, set)
    assert pairs == [("ab", "bd", 0.99), ("c", "ce", 0.99)]
    assert sorted(seen) == [("ab", "bd"), ("c", "ce")]


def lines(*places: tuple[int, int]) -> list[tuple]:
    return [
        (SimpleNamespace(at=old), SimpleNamespace(at=new), 1.0) for old, new in places
    ]


@pytest.mark.parametrize(
    ("old_at", "new_at", "expected"),
    [
        # The nearest field before it moved from 16 to 24.
        (20, 28, True),
        (24, 32, True),
        (20, 20, True),
        (20, 27, False),
        # In the old frame only the first field, which did not move, is before it.
        (16, 20, False),
        (12, 12, True),
        (0, 0, False),
        # In the new frame the first field is the nearest one.
        (32, 24, False),
        (10, 18, False),
        (17, 25, True),
    ],
)
def test_a_field_moves_with_the_nearest_matched_field_before_it(
    old_at, new_at, expected
):
    shifts = _Shifts(lines((0, 0), (16, 24)))
    assert shifts.allows(old_at, new_at) is expected
    swapped = _Shifts(lines((0, 0), (24, 16)))
    assert swapped.allows(new_at, old_at) is expected


def test_without_a_matched_field_nothing_shows_a_shift():
    assert not _Shifts([]).allows(0, 0)


MEMBERS = """\
enums:
  - name: Mode
    members: [%s]
"""


def member_pairs(folder, old: str, new: str) -> list[tuple]:
    comparison = compared_texts(folder, MEMBERS % old, MEMBERS % new, is_checked=False)
    ((pair,),) = (node.enums for node in comparison.match.nodes)
    return [
        tuple(side and (side.value, side.name) for side in (part.before, part.after))
        for part in pair.parts
    ]


def test_members_are_pairs_by_value_and_name_then_by_name_then_by_value(tmp_path):
    assert member_pairs(
        tmp_path,
        "{value: 0, name: Idle}, {value: 1, name: Run}, {value: 2, name: Stop}, {value: 3, name: Old}",
        "{value: 0, name: Idle}, {value: 5, name: Run}, {value: 2, name: Halt}, {value: 9, name: New}",
    ) == [
        ((0, "Idle"), (0, "Idle")),
        ((1, "Run"), (5, "Run")),
        ((2, "Stop"), (2, "Halt")),
        ((3, "Old"), None),
        (None, (9, "New")),
    ]
    assert member_pairs(
        tmp_path,
        "{value: 0, name: A1}, {value: 1, name: B1}",
        "{value: 0, name: B1}, {value: 1, name: A1}",
    ) == [((0, "A1"), (1, "A1")), ((1, "B1"), (0, "B1"))]


def unmatched(shape: set, length: int) -> SimpleNamespace:
    return SimpleNamespace(shape=frozenset(shape), thing=SimpleNamespace(length=length))


def test_layouts_without_fields_agree_in_their_length_only():
    a, b, c = (0, 8, "int"), (8, 8, "int"), (16, 8, "int")
    assert _layouts_alike(unmatched({a, b}, 2), unmatched({b, c}, 2)) == 1 / 3
    assert _layouts_alike(unmatched({a}, 2), unmatched({a}, 3)) == 1
    assert _layouts_alike(unmatched(set(), 2), unmatched({a}, 2)) == 0
    assert _layouts_alike(unmatched(set(), 2), unmatched(set(), 2)) == 0.75
    assert _layouts_alike(unmatched(set(), 2), unmatched(set(), 3)) == 0


def message(name: str, id: int, *fields: str, length: int) -> str:
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    return (
        f"  - name: {name}\n    id: {id}\n    kind: telemetry\n    length: {length}\n"
        + (f"    fields:\n{rows}" if fields else "")
    )


def renamed(folder, old: str, new: str) -> list[tuple[str, str]]:
    """Return the messages with two names that are matched."""
    texts = (f"messages:\n{text}" for text in (old, new))
    comparison = compared_texts(folder, *texts, is_checked=False)
    return [
        (pair.old.name, pair.new.name)
        for node in comparison.match.nodes
        for pair in node.messages
        if pair.both and pair.old.name != pair.new.name
    ]


def fields(count: int, first: str = "A") -> list[str]:
    names = [chr(ord(first) + n) * 2 for n in range(count)]
    return [
        f"at: {8 * n}, bits: 8, name: {name}, type: uint"
        for n, name in enumerate(names)
    ]


def test_a_renamed_message_shares_enough_of_its_layout_and_its_id(tmp_path):
    def is_renamed(id: int, same: int, others: int = 0) -> bool:
        old = message("Rates", 130, *fields(10), length=10)
        own = [*fields(10)[:same], *fields(10, "P")[same : same + others]]
        new = message("Xylophon", id, *own, length=10)
        return bool(renamed(tmp_path, old, new))

    # With the same id, the common part of layout and names needs the score 0.3 of 0.6.
    assert_limits(lambda same: is_renamed(130, same), least=5)
    # Another id and name: the layout and the names of the fields must agree.
    assert_limits(lambda same: is_renamed(140, same), least=10)
    assert not is_renamed(140, 0, 10)


def test_messages_of_another_direction_are_no_rename(tmp_path):
    old = message("Rates", 130, *fields(4), length=4)
    for kind, ids, expected in (
        ("telemetry", "id: 130", [("Rates", "Levels")]),
        ("telecommand", "id: 130", []),
        ("configuration", "set_id: 20, get_id: 130", [("Rates", "Levels")]),
    ):
        new = message("Levels", 130, *fields(4), length=4)
        new = new.replace("kind: telemetry", f"kind: {kind}").replace(
            "    id: 130\n", "".join(f"    {each}\n" for each in ids.split(", "))
        )
        assert renamed(tmp_path, old, new) == expected


def test_the_least_scores_are_those_of_the_documentation():
    assert (
        match.SAME_NODE,
        match.SAME_MESSAGE,
        match.SAME_ENUM,
        match.SAME_FIELD,
    ) == (0.4, 0.55, 0.5, 0.6)


def test_swapped_icds_give_the_same_pairs(tmp_path):
    texts = [
        message("Rates", 130, *fields(4), length=4)
        + message("Levels", 131, *fields(4), length=4),
        message("Turns", 131, *fields(4), length=4)
        + message("Fills", 130, *fields(3), length=4),
    ]
    results = [
        {frozenset(pair) for pair in renamed(tmp_path, *order)}
        for order in permutations(texts)
    ]
    assert results[0] == results[1] and len(results[0]) == 2
