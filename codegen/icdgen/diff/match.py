"""Finds what is the same thing in both ICDs: first by name, then, of what is left, by ids and layout.

Everything here is symmetric: from new to old the same pairs are found.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, Protocol, TypeVar

from icdgen.diff.pairs import (
    DeclaredPair,
    EnumPair,
    FieldPair,
    Match,
    MemberPair,
    MessagePair,
    NodePair,
    kind,
    position,
)
from icdgen.diff.similar import letters, likeness, overlap
from icdgen.icd.lines import Line, lines
from icdgen.icd.model import CONFIGURATION, Enum, Icd, Member, Message, Node

SAME_NODE = 0.4  # from here on, nodes of different names are one
SAME_MESSAGE = 0.55
SAME_ENUM = 0.5
SAME_FIELD = 0.6


class _Named(Protocol):
    @property
    def name(self) -> str: ...


Thing = TypeVar("Thing")
Named = TypeVar("Named", bound=_Named)
Declared = TypeVar("Declared", Enum, Message)
Paired = TypeVar("Paired", EnumPair, MessagePair)
Two = tuple[Thing, Thing, float]  # old, new, and how sure it is that they are the same
Sides = tuple[list[Thing], list[Thing]]  # of old and new
Score = Callable[[Thing, Thing], float]
Keys = Callable[[Thing], Iterable[object]]


def match(old: Icd, new: Icd) -> Match:
    """Both ICDs side by side."""
    found = Match(old, new)
    found.nodes = [NodePair(*pair) for pair in _side_by_side(old.nodes, new.nodes, _renamed_nodes)]
    for node, enum in _paired(
        found.nodes, EnumPair, lambda node: node.enums, lambda enum: enum.name, _ENUMS_LIKELY, _members
    ):
        node.enums.append(enum)
        found.enums.update((id(one), enum) for one in (enum.before, enum.after) if one is not None)
    for node, pair in _paired(found.nodes, MessagePair, lambda node: node.messages, _rank, _MESSAGES_LIKELY, _fields):
        node.messages.append(pair)
        found.messages.update((id(one), pair) for one in (pair.before, pair.after) if one is not None)
    _in_order(found)
    return found


def _side_by_side(
    old: Iterable[Named],
    new: Iterable[Named],
    likely: Callable[[list[Two[Named]], list[Named], list[Named]], list[Two[Named]]],
) -> list[tuple[Named | None, Named | None, float]]:
    """Pairs of equal names, ``likely`` ones of what is left, then what is only on one side."""
    pairs, left = _by_name(old, new)
    if all(left):
        pairs += likely(pairs, *left)
    taken = {id(one) for pair in pairs for one in pair[:2]}
    gone, come = ([one for one in side if id(one) not in taken] for side in left)
    return [*pairs, *((one, None, 1.0) for one in gone), *((None, one, 1.0) for one in come)]


def _by_name(old: Iterable[Named], new: Iterable[Named]) -> tuple[list[Two[Named]], Sides[Named]]:
    """Pairs of equal names, and what is left on either side. The first of several equal names counts."""
    by_name: dict[str, list[Named]] = {}
    for one in new:
        by_name.setdefault(one.name, []).append(one)
    pairs: list[Two[Named]] = []
    left: list[Named] = []
    for one in old:
        same = by_name.get(one.name)
        if same:
            pairs.append((one, same.pop(0), 1.0))
        else:
            left.append(one)
    return pairs, (left, [one for rest in by_name.values() for one in rest])


def _alike(
    old: Sequence[Thing], new: Sequence[Thing], score: Score[Thing], least: float, keys: Keys[Thing]
) -> list[Two[Thing]]:
    """The best pairs of what is left, greedily; ties go to those that stand at like places.

    Only pairs that have one of their ``keys`` in common are looked at: no others may have a score of ``least`` or more.
    """
    of_key: dict[object, list[int]] = {}
    for j, other in enumerate(new):
        for key in keys(other):
            of_key.setdefault(key, []).append(j)
    found = []
    for i, one in enumerate(old):
        for j in {j for key in keys(one) for j in of_key.get(key, ())}:
            value = score(one, new[j])
            if value >= least:
                found.append((-value, abs(i - j), i + j, i, j))
    found.sort()
    pairs: list[Two[Thing]] = []
    taken_old: set[int] = set()
    taken_new: set[int] = set()
    for value, _, _, i, j in found:
        if i not in taken_old and j not in taken_new:
            taken_old.add(i)
            taken_new.add(j)
            pairs.append((old[i], new[j], min(0.99, -value)))
    return pairs


def _renamed_nodes(known: list[Two[Node]], old: list[Node], new: list[Node]) -> list[Two[Node]]:
    return _alike(old, new, _node_score, SAME_NODE, _node_keys)


def _node_keys(node: Node) -> frozenset[object]:
    return frozenset((m.name, m.kind, m.ids) for m in node.messages)


def _node_score(one: Node, other: Node) -> float:
    keys = _node_keys(one), _node_keys(other)
    return 0.9 * overlap(*keys) + 0.1 * likeness(one.name, other.name) if any(keys) else 0.0


@dataclass(eq=False)
class _Left(Generic[Declared]):
    """A message or an enumeration that has no counterpart of its name, with what is compared more than once."""

    home: NodePair
    one: Declared

    @cached_property
    def shape(self: _Left[Message]) -> frozenset[tuple[int, int, str]]:
        """Of a message: where its fields lie, and how they are read."""
        return frozenset((f.at, f.width, kind(f)) for f in lines(self.one.layout))

    @cached_property
    def field_names(self: _Left[Message]) -> frozenset[str]:
        return frozenset(f.name for f in lines(self.one.layout))

    @cached_property
    def members(self: _Left[Enum]) -> frozenset[tuple[str, str]]:
        """Of an enumeration."""
        return frozenset((m.values, m.name) for m in self.one.members)


def _paired(
    nodes: list[NodePair],
    kind: Callable[..., Paired],
    declared: Callable[[Node], Sequence[Declared]],
    rank: Callable[[Declared], Any],
    likely: Iterable[tuple[Score[_Left[Declared]], Keys[_Left[Declared]], float]],
    parts: Callable[[Paired], list[Any]],
) -> Iterator[tuple[NodePair, Paired]]:
    """Pairs of what nodes declare, each with the node of its new side: by name within a node, then by each of the scores."""

    def made(home: NodePair, node: NodePair, old: object, new: object, sure: float = 1.0) -> tuple[NodePair, Paired]:
        elsewhere = home is not node
        pair = kind(old, new, sure, old_node=home.before or home.any, new_node=node.any, is_of_another_node=elsewhere)
        if not pair.both or pair.changed:
            pair.parts = parts(pair)
        return node, pair

    left_old: list[_Left[Declared]] = []
    left_new: list[_Left[Declared]] = []
    for node in nodes:
        pairs, (old, new) = _by_name(
            *(declared(side) if side is not None else () for side in (node.before, node.after))
        )
        yield from (made(node, node, *pair) for pair in pairs)
        left_old += [_Left(node, one) for one in sorted(old, key=rank)]
        left_new += [_Left(node, one) for one in sorted(new, key=rank)]
    for score, keys, least in likely:
        taken: set[_Left[Declared]] = set()
        for mine, theirs, sure in _alike(left_old, left_new, score, least, keys):
            yield made(mine.home, theirs.home, mine.one, theirs.one, sure)
            taken |= {mine, theirs}
        left_old = [left for left in left_old if left not in taken]
        left_new = [left for left in left_new if left not in taken]
    yield from (made(left.home, left.home, left.one, None) for left in left_old)
    yield from (made(left.home, left.home, None, left.one) for left in left_new)


def _name(left: _Left[Any]) -> Iterable[object]:
    return (left.one.name,)


def _moved_enum(one: _Left[Enum], other: _Left[Enum]) -> float:
    return 1.0 if one.one.name == other.one.name and overlap(one.members, other.members) >= 0.3 else 0.0


def _member_keys(left: _Left[Enum]) -> Iterable[object]:
    return [(left.home, *member) for member in left.members] or [(left.home,)]


def _renamed_enum(one: _Left[Enum], other: _Left[Enum]) -> float:
    if one.home is not other.home:
        return 0.0
    return 0.85 * overlap(one.members, other.members) + 0.15 * likeness(one.one.name, other.one.name)


_ENUMS_LIKELY = ((_moved_enum, _name, SAME_ENUM), (_renamed_enum, _member_keys, SAME_ENUM))


def _members(pair: EnumPair) -> list[MemberPair]:
    old = list(pair.before.members) if pair.before else []
    new = list(pair.after.members) if pair.after else []
    found: list[MemberPair] = []
    keys: tuple[Callable[[Member], object], ...] = (lambda m: (m.values, m.name), lambda m: m.name, lambda m: m.value)
    for key in keys:
        for one in list(old):
            twins = [m for m in old if key(m) == key(one)]
            others = [m for m in new if key(m) == key(one)]
            if len(others) == 1 and len(twins) == 1:
                found.append(MemberPair(one, others[0], owner=pair))
                old.remove(one)
                new.remove(others[0])
    found += [MemberPair(one, None, owner=pair) for one in old]
    return found + [MemberPair(None, one, owner=pair) for one in new]


# Messages


def _rank(message: Message) -> object:
    return message.kind, message.ids, message.name


def _moved_message(one: _Left[Message], other: _Left[Message]) -> float:
    same = one.one.name == other.one.name and one.one.kind == other.one.kind
    return 1.0 if same and (one.one.ids == other.one.ids or _layouts_alike(one, other) > 0.5) else 0.0


def _message_keys(left: _Left[Message]) -> Iterable[object]:
    """An id, the name of a field (or that there is none), or the whole layout together with the letters of the name."""
    yield from ((left.home, place, id) for place, id in enumerate(_ids(left.one)) if id is not None)
    yield from ((left.home, name) for name in left.field_names or (None,))
    yield left.home, left.shape, letters(left.one.name)


def _renamed_message(one: _Left[Message], other: _Left[Message]) -> float:
    """The same layout under another name, or name and id."""
    old, new = one.one, other.one
    if one.home is not other.home or not _same_direction(old, new):
        return 0.0
    same_id = any(a is not None and a == b for a, b in zip(_ids(old), _ids(new), strict=True))
    names = overlap(one.field_names, other.field_names)
    layout = 0.4 * _layouts_alike(one, other) + 0.2 * names + 0.25 * same_id
    if layout + 0.15 < SAME_MESSAGE:
        return 0.0  # no likeness of names, which takes long to tell, can make up for it
    alike = likeness(old.name, new.name)
    if not same_id and min(len(lines(old.layout)), len(lines(new.layout))) < 2 and alike < 0.6:
        return 0.0  # too little to go by
    return layout + 0.15 * alike


def _same_direction(old: Message, new: Message) -> bool:
    return old.kind == new.kind or CONFIGURATION in (old.kind, new.kind)


def _ids(message: Message) -> tuple[int | None, int | None]:
    return message.telecommand_id, message.telemetry_id


def _layouts_alike(one: _Left[Message], other: _Left[Message]) -> float:
    if one.shape or other.shape:
        return overlap(one.shape, other.shape)
    return 0.75 if one.one.length == other.one.length else 0.0


_MESSAGES_LIKELY = ((_moved_message, _name, SAME_MESSAGE), (_renamed_message, _message_keys, SAME_MESSAGE))


# Fields


def _fields(pair: MessagePair) -> list[FieldPair]:
    """Those that the ICD has lines for, those of structs wherever they stand."""
    old, new = (
        sorted((one for one in lines(message.layout) if not one.implied), key=_place) if message else []
        for message in (pair.before, pair.after)
    )
    pairs = _side_by_side(old, new, lambda known, *left: _renamed_fields(pair, known, *left))
    found = [FieldPair(*one, owner=pair) for one in pairs]
    return sorted(found, key=lambda p: _place(p.before or p.new))


def _place(field: Line) -> tuple[int, str]:
    return field.at, field.name


def _renamed_fields(pair: MessagePair, known: list[Two[Line]], old: list[Line], new: list[Line]) -> list[Two[Line]]:
    spans_old, spans_new = ([position(node, f) for f in rows] for node, rows in
                            ((pair.old_node, old), (pair.new_node, new)))  # fmt: skip
    spans = {id(f): span for f, span in zip((*old, *new), (*spans_old, *spans_new), strict=True)}
    shifts = _Shifts(known)

    def sense(one: Line) -> object:
        return one.type, one.scale, one.curve, one.unit, one.limits

    def keys(one: Line) -> Iterable[object]:
        """Where it lies, or what it holds."""
        return spans[id(one)], (one.bits, sense(one))

    def score(one: Line, other: Line) -> float:
        same_kind, same_span = kind(one) == kind(other), spans[id(one)] == spans[id(other)]
        if not same_span and (one.bits != other.bits or not same_kind):
            return 0.0
        alike = likeness(one.name, other.name)
        same_sense = sense(one) == sense(other)
        if same_span:
            if same_kind:
                return 0.6 + 0.15 * alike + 0.2 * same_sense
            return 0.7 * alike + 0.1 if alike >= 0.75 else 0.0
        if not same_sense:
            return 0.0
        if shifts.allows(one.at, other.at):
            return 0.6 + 0.3 * alike
        return 0.8 * alike if alike >= 0.75 else 0.0

    return _alike(old, new, score, SAME_FIELD, keys)


class _Shifts:
    """By how much the nearest known field before a place has moved, as seen in the old frame and in the new one."""

    def __init__(self, known: list[Two[Line]]) -> None:
        self.old = sorted((one.at, other.at - one.at) for one, other, _ in known)
        self.new = sorted((other.at, other.at - one.at) for one, other, _ in known)

    def allows(self, old_at: int, new_at: int) -> bool:
        """Whether a field that moved so far moved with the one before it."""
        for rows, at in ((self.old, old_at), (self.new, new_at)):
            index = bisect_left(rows, (at,))
            if index and rows[index - 1][1] == new_at - old_at:
                return True
        return False


def _in_order(found: Match) -> None:
    """As the ICDs have them: what is new or there still as in the new one, what is gone at its end."""
    nodes = (*found.old.nodes, *found.new.nodes)
    rows = (some for node in nodes for some in (node.messages, node.enums))
    places = {id(one): number for some in rows for number, one in enumerate(some)}

    def rank(pair: DeclaredPair) -> tuple[bool, int]:
        return pair.after is None, places[id(pair.any)]

    for node in found.nodes:
        node.messages.sort(key=rank)
        node.enums.sort(key=rank)
