"""Fields that lie elsewhere: shifted by something inserted before them, moved as a block, or alone."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.diff.pairs import FieldPair, MessagePair


@dataclass
class Move:
    """Neighbouring fields that moved by the same number of bits, and what before them came, went or grew."""

    fields: list[FieldPair]
    by: int  # bits; positive: towards the end
    gained: list[FieldPair] = field(default_factory=list)
    lost: list[FieldPair] = field(default_factory=list)
    resized: list[FieldPair] = field(default_factory=list)
    reserved: bool = False  # reserved bits came or went before them, and the frame changed its length

    @property
    def is_shift(self) -> bool:
        """Whether the fields only made room, or took it."""
        return bool(self.gained or self.lost or self.resized or self.reserved)


@dataclass
class Moves:
    """All moves of a message. ``causes`` are fields that came or went and made others move."""

    moves: list[Move] = field(default_factory=list)
    causes: set[int] = field(default_factory=set)  # id(pair)


def moves(message: MessagePair) -> Moves:
    """The moves within a message that is in both ICDs."""
    found = Moves()
    kept = message.kept
    shifted = [pair for pair in kept if pair.moved]
    if not shifted:
        return found
    by_old = sorted(kept, key=lambda p: (p.old.at, p.old.name))
    by_new = sorted(kept, key=lambda p: (p.new.at, p.new.name))
    rank_old = {id(pair): number for number, pair in enumerate(by_old)}
    rank_new = {id(pair): number for number, pair in enumerate(by_new)}
    groups: dict[int, list[FieldPair]] = {}
    for pair in by_old:
        if pair.moved:
            groups.setdefault(pair.new.at - pair.old.at, []).append(pair)
    for step, rows in groups.items():
        for run in _runs(rows, rank_old, rank_new):
            move = Move(run, step)
            _causes(message, move, by_old, by_new, rank_old, rank_new)
            found.moves.append(move)
    found.moves.sort(key=lambda move: (move.fields[0].old.at, move.fields[0].new.at))
    for move in found.moves:
        found.causes.update(id(pair) for pair in (*move.gained, *move.lost))
    return found


def _runs(rows: list[FieldPair], rank_old: dict[int, int], rank_new: dict[int, int]) -> list[list[FieldPair]]:
    """Split where another field lies between, in the old frame and in the new one."""
    runs: list[list[FieldPair]] = []
    for pair in rows:
        last = runs[-1][-1] if runs else None
        if last is not None and 1 in (rank[id(pair)] - rank[id(last)] for rank in (rank_old, rank_new)):
            runs[-1].append(pair)
        else:
            runs.append([pair])
    return runs


def _causes(
    message: MessagePair,
    move: Move,
    by_old: list[FieldPair],
    by_new: list[FieldPair],
    rank_old: dict[int, int],
    rank_new: dict[int, int],
) -> None:
    first = move.fields[0]
    before_old = by_old[rank_old[id(first)] - 1] if rank_old[id(first)] else None
    before_new = by_new[rank_new[id(first)] - 1] if rank_new[id(first)] else None
    move.lost = [
        pair
        for pair in message.lost
        if (before_old.old.at if before_old else -1) <= pair.old.at < first.old.at
    ]  # fmt: skip
    move.gained = [
        pair
        for pair in message.gained
        if (before_new.new.at if before_new else -1) <= pair.new.at < first.new.at
    ]  # fmt: skip
    if before_old is not None and before_old is before_new and before_old.old.bits != before_old.new.bits:
        move.resized = [before_old]
    longer = (message.new.length - message.old.length) * 8
    last = move.fields[-1] is by_old[-1] or move.fields[-1] is by_new[-1]
    move.reserved = not move.is_shift and last and longer == move.by
