"""Changes by what they are about, in the order of the report."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from icdgen.diff.change import Change
from icdgen.diff.pairs import EnumPair, FieldPair, MemberPair, MessagePair, Pair
from icdgen.diff.wording import ids


class Group(NamedTuple):
    """Changes of one message, enumeration or node."""

    title: str  # "ADCS State"
    about: str  # "telemetry 190"
    node: str
    owner: Pair
    changes: list[Change]


def groups(changes: Iterable[Change]) -> list[Group]:
    """In the order in which they first appear."""
    found: dict[int, Group] = {}
    for change in changes:
        owner = owner_of(change.pair)
        group = found.get(id(owner))
        if group is None:
            group = found[id(owner)] = Group(*_title(owner, change), owner, [])
        group.changes.append(change)
    return list(found.values())


def owner_of(pair: Pair) -> Pair:
    """The message or enumeration that a field or member belongs to."""
    return pair.owner if isinstance(pair, FieldPair | MemberPair) else pair


def _title(owner: Pair, change: Change) -> tuple[str, str, str]:
    if isinstance(owner, MessagePair):
        return owner.any.name, f"{owner.any.kind} {ids(owner.any.ids)}", owner.node.name
    if isinstance(owner, EnumPair):
        return owner.any.name, "enumeration", owner.node.name
    return owner.any.name, "node", owner.any.name


def notes(change: Change) -> Iterator[str]:
    """What is said below a change: consequences, how sure the match is, decisions about the manual."""
    yield from change.details
    if change.certainty:
        yield f"That old and new are the same thing is {change.certainty} ({change.sure:.0%})."
    if change.errata:
        yield f"Because erratum {', '.join(change.errata)}."
