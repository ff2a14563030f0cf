"""Moved fields: shifted by an insertion before them, moved as a block, or moved alone.

`moves` groups the moved fields of a message, so that an inserted field is reported as
one change and not as one for each field behind it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from icdgen.diff.pairs import FieldPair, MessagePair
from icdgen.icd.lines import Line


@dataclass
class Move:
    """Adjacent fields that moved by the same number of bits, and the added, removed or
    resized fields before them.
    """

    fields: list[FieldPair]
    by: int  # in bits; positive towards the end
    gained: list[FieldPair] = field(default_factory=list)
    lost: list[FieldPair] = field(default_factory=list)
    resized: list[FieldPair] = field(default_factory=list)
    # Reserved bits were added or removed before them, and the length of the frame
    # changed
    reserved: bool = False

    @property
    def is_shift(self) -> bool:
        """Whether the fields moved because of a change before them."""
        return bool(self.gained or self.lost or self.resized or self.reserved)


@dataclass
class Moves:
    """Moves of a message.

    ``causes``: added or removed fields that moved other fields.
    """

    moves: list[Move] = field(default_factory=list)
    causes: set[int] = field(default_factory=set)  # id(pair)


class _Order:
    """Fields that exist in both ICDs, in the order of one frame."""

    def __init__(
        self, pairs: list[FieldPair], side: Callable[[FieldPair], Line]
    ) -> None:
        self.rows = sorted(pairs, key=lambda pair: (side(pair).at, side(pair).name))
        self.rank = {id(pair): number for number, pair in enumerate(self.rows)}

    def before(self, pair: FieldPair) -> FieldPair | None:
        rank = self.rank[id(pair)]
        return self.rows[rank - 1] if rank else None


def moves(message: MessagePair) -> Moves:
    """Return the moves within a message that exists in both ICDs."""
    result = Moves()
    if not any(pair.moved for pair in message.common):
        return result
    old, new = (
        _Order(message.common, lambda pair: pair.old),
        _Order(message.common, lambda pair: pair.new),
    )
    groups: dict[int, list[FieldPair]] = {}
    # Fields that moved by the same distance may belong to one move.
    for pair in old.rows:
        if pair.moved:
            groups.setdefault(pair.new.at - pair.old.at, []).append(pair)
    for step, rows in groups.items():
        for run in _runs(rows, old, new):
            move = Move(run, step)
            _causes(message, move, old, new)
            result.moves.append(move)
    result.moves.sort(key=lambda move: (move.fields[0].old.at, move.fields[0].new.at))
    for move in result.moves:
        result.causes.update(id(pair) for pair in (*move.gained, *move.lost))
    return result


def _runs(rows: list[FieldPair], old: _Order, new: _Order) -> list[list[FieldPair]]:
    """Split fields into groups of adjacent fields, adjacent in the old or in the new
    frame.
    """
    runs: list[list[FieldPair]] = []
    for pair in rows:
        last = runs[-1][-1] if runs else None
        if last is not None and last in (old.before(pair), new.before(pair)):
            runs[-1].append(pair)
        else:
            runs.append([pair])
    return runs


def _causes(message: MessagePair, move: Move, old: _Order, new: _Order) -> None:
    first, last = move.fields[0], move.fields[-1]
    before_old, before_new = old.before(first), new.before(first)
    # Only fields between the previous common field and the move can have caused it.
    start_old = before_old.old.at if before_old else -1
    start_new = before_new.new.at if before_new else -1
    lost, gained = (
        [pair for pair in side if not pair.any.is_read_only]
        for side in (message.lost, message.gained)
    )
    move.lost = [pair for pair in lost if start_old <= pair.old.at < first.old.at]
    move.gained = [pair for pair in gained if start_new <= pair.new.at < first.new.at]
    # A field that only changed its width shifts all fields behind it.
    if (
        before_old is not None
        and before_old is before_new
        and before_old.old.width != before_old.new.width
    ):
        move.resized = [before_old]
    longer = (message.new.layout.length - message.old.layout.length) * 8
    at_the_end = last is old.rows[-1] or last is new.rows[-1]
    # Without another cause, reserved bits were inserted or removed.
    move.reserved = not move.is_shift and at_the_end and longer == move.by
