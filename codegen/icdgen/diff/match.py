"""Matching of the objects of two ICDs: first by name, then the remaining objects by ids
and layout.

In: two ICDs. Out: a `Match` with a pair for each node, message, field, enumeration and
member; an object without counterpart has None on the other side. The matching is
symmetric: swapped ICDs result in the same pairs.
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

SAME_NODE = 0.4  # minimum score of a match of nodes with different names
SAME_MESSAGE = 0.55
SAME_ENUM = 0.5
SAME_FIELD = 0.6


class _NamedObject(Protocol):
    @property
    def name(self) -> str: ...


Thing = TypeVar("Thing")
Named = TypeVar("Named", bound=_NamedObject)
Declared = TypeVar("Declared", Enum, Message)
Paired = TypeVar("Paired", EnumPair, MessagePair)
Two = tuple[Thing, Thing, float]  # old, new, and confidence of the match
Sides = tuple[list[Thing], list[Thing]]  # of the old and of the new ICD
Score = Callable[[Thing, Thing], float]
Keys = Callable[[Thing], Iterable[object]]


def match(old: Icd, new: Icd) -> Match:
    """Return all matched pairs of two ICDs."""
    result = Match(old, new)
    result.nodes = [
        NodePair(*pair) for pair in _side_by_side(old.nodes, new.nodes, _renamed_nodes)
    ]
    for node, enum in _paired(
        result.nodes,
        EnumPair,
        lambda node: node.enums,
        lambda enum: enum.name,
        _ENUMS_LIKELY,
        _members,
    ):
        node.enums.append(enum)
        result.enums.update(
            (id(side), enum) for side in (enum.before, enum.after) if side is not None
        )
    for node, pair in _paired(
        result.nodes,
        MessagePair,
        lambda node: node.messages,
        _rank,
        _MESSAGES_LIKELY,
        _fields,
    ):
        node.messages.append(pair)
        result.messages.update(
            (id(side), pair) for side in (pair.before, pair.after) if side is not None
        )
    _in_order(result)
    return result


def _side_by_side(
    old: Iterable[Named],
    new: Iterable[Named],
    likely: Callable[[list[Two[Named]], list[Named], list[Named]], list[Two[Named]]],
) -> list[tuple[Named | None, Named | None, float]]:
    """Return pairs of equal names, then ``likely`` pairs of the remaining objects, then
    objects of one side only.
    """
    # If one side has no remaining object, no renaming is possible.
    pairs, remaining = _by_name(old, new)
    if all(remaining):
        pairs += likely(pairs, *remaining)
    taken = {id(thing) for pair in pairs for thing in pair[:2]}
    removed, added = (
        [thing for thing in things if id(thing) not in taken] for things in remaining
    )
    return [
        *pairs,
        *((thing, None, 1.0) for thing in removed),
        *((None, thing, 1.0) for thing in added),
    ]


def _by_name(
    old: Iterable[Named], new: Iterable[Named]
) -> tuple[list[Two[Named]], Sides[Named]]:
    """Return pairs of equal names, and the remaining objects of each side.

    Repeated names are matched in order.
    """
    by_name: dict[str, list[Named]] = {}
    for thing in new:
        by_name.setdefault(thing.name, []).append(thing)
    pairs: list[Two[Named]] = []
    left: list[Named] = []
    for thing in old:
        same = by_name.get(thing.name)
        if same:
            pairs.append((thing, same.pop(0), 1.0))
        else:
            left.append(thing)
    return pairs, (left, [thing for things in by_name.values() for thing in things])


def _best_pairs(
    old: Sequence[Thing],
    new: Sequence[Thing],
    score: Score[Thing],
    least: float,
    keys: Keys[Thing],
) -> list[Two[Thing]]:
    """Return the best pairs by score, selected greedily. Ties prefer similar positions.

    Only pairs with a common key are scored; `keys` must ensure that other pairs score
    below ``least``.
    """
    indexes_by_key: dict[object, list[int]] = {}
    for j, other in enumerate(new):
        for key in keys(other):
            indexes_by_key.setdefault(key, []).append(j)
    candidates = []
    for i, thing in enumerate(old):
        for j in {j for key in keys(thing) for j in indexes_by_key.get(key, ())}:
            value = score(thing, new[j])
            if value >= least:
                # The first three are the same if the sides are swapped, and so are the
                # pairs.
                candidates.append((-value, abs(i - j), i + j, i, j))
    # Highest score first, then the smallest distance of positions.
    candidates.sort()
    pairs: list[Two[Thing]] = []
    taken_old: set[int] = set()
    taken_new: set[int] = set()
    for value, _, _, i, j in candidates:
        if i not in taken_old and j not in taken_new:
            taken_old.add(i)
            taken_new.add(j)
            # Only equal names have a confidence of 1.
            pairs.append((old[i], new[j], min(0.99, -value)))
    return pairs


def _renamed_nodes(
    pairs: list[Two[Node]], old: list[Node], new: list[Node]
) -> list[Two[Node]]:
    """Return pairs of nodes with different names and common messages."""

    def keys(node: Node) -> frozenset[object]:
        return frozenset((m.name, m.kind, m.ids) for m in node.messages)

    def score(old_node: Node, new_node: Node) -> float:
        old_keys, new_keys = keys(old_node), keys(new_node)
        if not old_keys and not new_keys:
            return 0.0
        alike = likeness(old_node.name, new_node.name)
        return 0.9 * overlap(old_keys, new_keys) + 0.1 * alike

    return _best_pairs(old, new, score, SAME_NODE, keys)


@dataclass(eq=False)
class _Unmatched(Generic[Declared]):
    """Message or enumeration without a counterpart of the same name, with cached
    attributes.
    """

    home: NodePair
    thing: Declared

    @cached_property
    def shape(self: _Unmatched[Message]) -> frozenset[tuple[int, int, str]]:
        """Position, width and interpretation of the fields of a message."""
        return frozenset((f.at, f.width, kind(f)) for f in lines(self.thing.layout))

    @cached_property
    def field_names(self: _Unmatched[Message]) -> frozenset[str]:
        return frozenset(f.name for f in lines(self.thing.layout))

    @cached_property
    def members(self: _Unmatched[Enum]) -> frozenset[tuple[str, str]]:
        """Members of an enumeration."""
        return frozenset((m.values, m.name) for m in self.thing.members)


def _paired(
    nodes: list[NodePair],
    kind: Callable[..., Paired],
    declared: Callable[[Node], Sequence[Declared]],
    rank: Callable[[Declared], Any],
    likely: Iterable[
        tuple[Score[_Unmatched[Declared]], Keys[_Unmatched[Declared]], float]
    ],
    parts: Callable[[Paired], list[Any]],
) -> Iterator[tuple[NodePair, Paired]]:
    """Yield pairs of declarations with the node of their new side: by name within a
    node, then by each score in turn.
    """

    def paired(
        home: NodePair,
        node: NodePair,
        old: object,
        new: object,
        confidence: float = 1.0,
    ) -> tuple[NodePair, Paired]:
        elsewhere = home is not node
        pair = kind(
            old,
            new,
            confidence,
            old_node=home.before or home.any,
            new_node=node.any,
            is_of_another_node=elsewhere,
        )
        # Most declarations of two versions are equal, and their parts need no pairs.
        if not pair.both or pair.changed:
            pair.parts = parts(pair)
        return node, pair

    left_old: list[_Unmatched[Declared]] = []
    left_new: list[_Unmatched[Declared]] = []
    for node in nodes:
        pairs, (old, new) = _by_name(
            *(
                declared(side) if side is not None else ()
                for side in (node.before, node.after)
            )
        )
        yield from (paired(node, node, *pair) for pair in pairs)
        # Positions in these lists decide ties, so that they follow the ids and not the
        # order of a file.
        left_old += [_Unmatched(node, thing) for thing in sorted(old, key=rank)]
        left_new += [_Unmatched(node, thing) for thing in sorted(new, key=rank)]
    # Each score only sees the objects that earlier scores left unmatched.
    for score, keys, least in likely:
        taken: set[_Unmatched[Declared]] = set()
        for old_item, new_item, confidence in _best_pairs(
            left_old, left_new, score, least, keys
        ):
            yield paired(
                old_item.home, new_item.home, old_item.thing, new_item.thing, confidence
            )
            taken |= {old_item, new_item}
        left_old = [left for left in left_old if left not in taken]
        left_new = [left for left in left_new if left not in taken]
    yield from (paired(left.home, left.home, left.thing, None) for left in left_old)
    yield from (paired(left.home, left.home, None, left.thing) for left in left_new)


def _name(left: _Unmatched[Any]) -> Iterable[object]:
    return (left.thing.name,)


def _moved_enum(old: _Unmatched[Enum], new: _Unmatched[Enum]) -> float:
    # Many ICDs have an enumeration `Mode`, so the name alone proves nothing.
    is_same = (
        old.thing.name == new.thing.name and overlap(old.members, new.members) >= 0.3
    )
    return 1.0 if is_same else 0.0


def _member_keys(left: _Unmatched[Enum]) -> Iterable[object]:
    # Without a common member the score is 0.15 at most. Two enumerations without any
    # overlap by half.
    return [(left.home, *member) for member in left.members] or [(left.home,)]


def _renamed_enum(old: _Unmatched[Enum], new: _Unmatched[Enum]) -> float:
    if old.home is not new.home:
        return 0.0
    return 0.85 * overlap(old.members, new.members) + 0.15 * likeness(
        old.thing.name, new.thing.name
    )


_ENUMS_LIKELY = (
    (_moved_enum, _name, SAME_ENUM),
    (_renamed_enum, _member_keys, SAME_ENUM),
)


def _members(pair: EnumPair) -> list[MemberPair]:
    old = list(pair.before.members) if pair.before else []
    new = list(pair.after.members) if pair.after else []
    pairs: list[MemberPair] = []
    # From the most to the least reliable key; ambiguous keys match nothing.
    keys: tuple[Callable[[Member], object], ...] = (
        lambda m: (m.values, m.name),
        lambda m: m.name,
        lambda m: m.value,
    )
    for key in keys:
        for member in list(old):
            same_key = [m for m in old if key(m) == key(member)]
            matches = [m for m in new if key(m) == key(member)]
            # An ambiguous key (a repeated value or name) proves nothing.
            if len(matches) == 1 and len(same_key) == 1:
                pairs.append(MemberPair(member, matches[0], owner=pair))
                old.remove(member)
                new.remove(matches[0])
    pairs += [MemberPair(member, None, owner=pair) for member in old]
    return pairs + [MemberPair(None, member, owner=pair) for member in new]


# Messages


def _rank(message: Message) -> object:
    return message.kind, message.ids, message.name


def _moved_message(left: _Unmatched[Message], right: _Unmatched[Message]) -> float:
    old, new = left.thing, right.thing
    if old.name != new.name or old.kind != new.kind:
        return 0.0
    return 1.0 if old.ids == new.ids or _layouts_alike(left, right) > 0.5 else 0.0


def _message_keys(left: _Unmatched[Message]) -> Iterable[object]:
    """Yield the keys of a message: ids, field names (None without fields), and the
    layout with the letters of the name.
    """
    yield from (
        (left.home, place, id)
        for place, id in enumerate(_ids(left.thing))
        if id is not None
    )
    yield from ((left.home, name) for name in left.field_names or (None,))
    # Without an equal id or a common field, layout and name give 0.4 and 0.15, which is
    # just `SAME_MESSAGE` if both are equal.
    yield left.home, left.shape, letters(left.thing.name)


def _renamed_message(left: _Unmatched[Message], right: _Unmatched[Message]) -> float:
    """Return the score of two messages with different names, and perhaps different ids."""
    old, new = left.thing, right.thing
    # A configuration message is a telecommand and telemetry at once.
    is_same_direction = old.kind == new.kind or CONFIGURATION in (old.kind, new.kind)
    if left.home is not right.home or not is_same_direction:
        return 0.0
    same_id = any(
        a is not None and a == b for a, b in zip(_ids(old), _ids(new), strict=True)
    )
    names = overlap(left.field_names, right.field_names)
    # The layout counts most, then the id: names change more often than both.
    layout = 0.4 * _layouts_alike(left, right) + 0.2 * names + 0.25 * same_id
    if layout + 0.15 < SAME_MESSAGE:
        # Even equal names could not reach the minimum; their comparison is slow
        return 0.0
    alike = likeness(old.name, new.name)
    if (
        not same_id
        and min(len(lines(old.layout)), len(lines(new.layout))) < 2
        and alike < 0.6
    ):
        return 0.0  # too few fields for a match by layout alone
    return layout + 0.15 * alike


def _ids(message: Message) -> tuple[int | None, int | None]:
    return message.telecommand_id, message.telemetry_id


def _layouts_alike(old: _Unmatched[Message], new: _Unmatched[Message]) -> float:
    if old.shape or new.shape:
        return overlap(old.shape, new.shape)
    # Messages without fields can only agree in their length.
    return 0.75 if old.thing.length == new.thing.length else 0.0


_MESSAGES_LIKELY = (
    (_moved_message, _name, SAME_MESSAGE),
    (_renamed_message, _message_keys, SAME_MESSAGE),
)


# Fields


def _fields(pair: MessagePair) -> list[FieldPair]:
    """Return the pairs of fields that have a line in the ICD; fields of a struct for
    each use of it.
    """
    pairs = _side_by_side(
        _lines_by_place(pair.before),
        _lines_by_place(pair.after),
        lambda pairs_by_name, *left: _renamed_fields(pair, pairs_by_name, *left),
    )
    field_pairs = [FieldPair(*sides, owner=pair) for sides in pairs]
    return sorted(field_pairs, key=lambda p: _place(p.before or p.new))


def _lines_by_place(message: Message | None) -> list[Line]:
    """Return the lines of a message in the order of their places, without counts of
    elements.
    """
    if message is None:
        return []
    return sorted((ln for ln in lines(message.layout) if not ln.is_count), key=_place)


def _place(field: Line) -> tuple[int, str]:
    return field.at, field.name


def _renamed_fields(
    pair: MessagePair, pairs_by_name: list[Two[Line]], old: list[Line], new: list[Line]
) -> list[Two[Line]]:
    spans = {id(line): position(pair.old_node, line) for line in old}
    spans.update((id(line), position(pair.new_node, line)) for line in new)
    shifts = _Shifts(pairs_by_name)

    def sense(line: Line) -> object:
        return line.type, line.scale, line.curve, line.unit, line.limits

    def keys(line: Line) -> Iterable[object]:
        """Return position and meaning of a field."""
        # Two fields with neither in common have the score 0.
        return spans[id(line)], (line.bits, sense(line))

    def score(old_line: Line, new_line: Line) -> float:
        same_kind = kind(old_line) == kind(new_line)
        same_span = spans[id(old_line)] == spans[id(new_line)]
        # A field that changed both position and size has no evidence left but its name.
        if not same_span and (old_line.bits != new_line.bits or not same_kind):
            return 0.0
        alike = likeness(old_line.name, new_line.name)
        same_sense = sense(old_line) == sense(new_line)
        if same_span:
            # Position and interpretation alone reach `SAME_FIELD`: the name is what a
            # renaming changes.
            if same_kind:
                return 0.6 + 0.15 * alike + 0.2 * same_sense
            return 0.7 * alike + 0.1 if alike >= 0.75 else 0.0
        if not same_sense:
            return 0.0
        if shifts.allows(old_line.at, new_line.at):
            return 0.6 + 0.3 * alike
        return 0.8 * alike if alike >= 0.75 else 0.0

    return _best_pairs(old, new, score, SAME_FIELD, keys)


class _Shifts:
    """Shift in bits of the nearest matched field before a position, seen from the old
    and from the new frame.
    """

    def __init__(self, pairs: list[Two[Line]]) -> None:
        self.old = sorted((old.at, new.at - old.at) for old, new, _ in pairs)
        self.new = sorted((new.at, new.at - old.at) for old, new, _ in pairs)

    def allows(self, old_at: int, new_at: int) -> bool:
        """Return whether a field with these positions moved together with the field
        before it.
        """
        for rows, at in ((self.old, old_at), (self.new, new_at)):
            index = bisect_left(rows, (at,))
            # The nearest matched field before it moved by the same distance.
            if index and rows[index - 1][1] == new_at - old_at:
                return True
        return False


def _in_order(result: Match) -> None:
    """Sort the pairs in the order of the new ICD; removed objects come last, in their
    old order.
    """
    places: dict[int, int] = {}
    for node in (*result.old.nodes, *result.new.nodes):
        for declarations in (node.messages, node.enums):
            places.update((id(thing), i) for i, thing in enumerate(declarations))

    def rank(pair: DeclaredPair) -> tuple[bool, int]:
        return pair.after is None, places[id(pair.any)]

    for pair_of_nodes in result.nodes:
        pair_of_nodes.messages.sort(key=rank)
        pair_of_nodes.enums.sort(key=rank)
