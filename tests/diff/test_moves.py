"""Moved fields are grouped by distance, with the fields that caused the move."""

from __future__ import annotations

from icdgen.diff.moves import Moves, moves
from icdgen.diff.pairs import MessagePair
from tests.diff.cases import compared_texts
from tests.icd.files import status


def pair_of(tmp_path, old: dict, new: dict, lengths=(8, 8)) -> MessagePair:
    """Return the pair of two messages: name to first bit and number of bits."""
    texts = []
    for fields, length in zip((old, new), lengths, strict=True):
        rows = [
            f"at: {at}, bits: {bits}, name: {field}, type: uint"
            for field, (at, bits) in fields.items()
        ]
        texts.append(status(*rows, length=length))
    context = compared_texts(tmp_path, *texts).context
    return context.pair(context.match.old.nodes[0].messages[0])


def rows(message: MessagePair) -> list[tuple]:
    """Return each move with the names of its fields and causes."""

    def names(pairs: list) -> str:
        return " ".join(pair.any.name for pair in pairs)

    return [
        (
            names(move.fields),
            move.by,
            names(move.gained),
            names(move.lost),
            names(move.resized),
            move.reserved,
        )
        for move in moves(message).moves
    ]


BYTES = {name: (8 * n, 8) for n, name in enumerate(("Aa", "Bb", "Cc", "Dd"))}


def test_an_insertion_shifts_all_fields_behind_it(tmp_path):
    new = {"Aa": (0, 8), "Xx": (8, 16), "Bb": (24, 8), "Cc": (32, 8), "Dd": (40, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 6))
    assert rows(message) == [("Bb Cc Dd", 16, "Xx", "", "", False)]
    result = moves(message)
    assert result.moves[0].is_shift
    assert result.causes == {id(pair) for pair in message.gained}


def test_a_removal_shifts_all_fields_behind_it_to_the_front(tmp_path):
    new = {"Aa": (0, 8), "Cc": (8, 8), "Dd": (16, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 3))
    assert rows(message) == [("Cc Dd", -8, "", "Bb", "", False)]
    assert moves(message).causes == {id(pair) for pair in message.lost}


def test_a_field_inserted_at_the_first_bit_shifts_all(tmp_path):
    new = {"Xx": (0, 8)} | {name: (at + 8, 8) for name, (at, _) in BYTES.items()}
    message = pair_of(tmp_path, BYTES, new, (4, 5))
    assert rows(message) == [("Aa Bb Cc Dd", 8, "Xx", "", "", False)]


def test_a_wider_field_shifts_the_fields_behind_it(tmp_path):
    new = {"Aa": (0, 8), "Bb": (8, 16), "Cc": (24, 8), "Dd": (32, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 5))
    assert rows(message) == [("Cc Dd", 8, "", "", "Bb", False)]
    assert moves(message).causes == set()


def test_a_narrower_field_shifts_the_fields_behind_it_to_the_front(tmp_path):
    old = {"Aa": (0, 8), "Bb": (8, 16), "Cc": (24, 8)}
    new = {"Aa": (0, 8), "Bb": (8, 8), "Cc": (16, 8)}
    message = pair_of(tmp_path, old, new, (4, 3))
    assert rows(message) == [("Cc", -8, "", "", "Bb", False)]


def test_fields_that_are_neighbours_in_the_new_frame_only_are_one_move(tmp_path):
    old = {"Aa": (0, 8), "Xx": (8, 8), "Bb": (16, 8)}
    new = {"Xx": (0, 8), "Aa": (8, 8), "Bb": (24, 8), "Zz": (32, 8)}
    message = pair_of(tmp_path, old, new, (3, 5))
    assert [(row[0], row[1]) for row in rows(message)] == [("Aa Bb", 8), ("Xx", -8)]


def test_reserved_bits_shift_the_last_fields_by_what_the_frame_became_longer(tmp_path):
    new = {"Aa": (0, 8), "Bb": (8, 8), "Cc": (32, 8), "Dd": (40, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 6))
    assert rows(message) == [("Cc Dd", 16, "", "", "", True)]
    assert moves(message).moves[0].is_shift


def test_fields_that_moved_by_another_distance_than_the_length_moved_alone(tmp_path):
    new = {"Aa": (0, 8), "Bb": (8, 8), "Cc": (32, 8), "Dd": (40, 8), "Zz": (48, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 7))
    assert rows(message) == [("Cc Dd", 16, "", "", "", False)]
    assert not moves(message).moves[0].is_shift


def test_fields_that_change_places_are_separate_moves_in_the_old_order(tmp_path):
    new = BYTES | {"Aa": (24, 8), "Dd": (0, 8)}
    message = pair_of(tmp_path, BYTES, new, (4, 4))
    assert rows(message) == [
        ("Aa", 24, "", "", "", False),
        ("Dd", -24, "", "", "", False),
    ]


def test_a_message_without_moved_fields_has_no_moves(tmp_path):
    message = pair_of(tmp_path, BYTES, BYTES | {"Ee": (32, 8)}, (4, 5))
    assert moves(message) == Moves([], set())
