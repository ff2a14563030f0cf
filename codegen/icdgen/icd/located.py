"""Mappings and sequences of a YAML file that store the places of their keys, values and
items.

`Map` is a dict and `Seq` a list, so code that ignores places reads a tree as usual.
`icdgen.icd.source` makes them, and objects of the model refer to them as ``source``.
`Map.at` and `Map.key_at` return the `Place` that a finding shows. `plain` copies a tree
without places.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

from icdgen.diagnostics import Place


class Mark(Protocol):
    """Position in the file ``name``, from PyYAML; index, line and column count from 0."""

    name: str
    index: int
    line: int
    column: int


Spot = Place | tuple[Mark, Mark]
"""Place of a node, or its start and end marks.

Converting marks to places only on demand makes loading faster.
"""


def place_of(spot: Spot) -> Place:
    """Return the place of a spot."""
    if isinstance(spot, Place):
        return spot
    start, end = spot
    length = end.column - start.column if end.line == start.line else 1
    return Place(start.name, start.line + 1, start.column + 1, max(length, 1))


class Map(dict[str, Any]):
    """A mapping.

    ``spots`` has the places of each key and its value, including keys that an erratum
    removed.
    """

    __slots__ = ("spot", "spots")

    def __init__(self, spot: Spot) -> None:
        self.spot = spot
        self.spots: dict[str, tuple[Spot, Spot]] = {}

    @property
    def place(self) -> Place:
        """Place of the start of the mapping."""
        return place_of(self.spot)

    def key_at(self, key: str) -> Place:
        """Return the place of a key. Raises `KeyError`."""
        return place_of(self.spots[key][0])

    def at(self, key: str) -> Place:
        """Return the place of the value of a key; the place of the mapping if it does
        not have the key.
        """
        return place_of(self.spots[key][1] if key in self.spots else self.spot)


class Seq(list[Any]):
    """A sequence. ``spots`` has the place of each item."""

    __slots__ = ("spot", "spots")

    def __init__(self, spot: Spot) -> None:
        self.spot = spot
        self.spots: list[Spot] = []

    @property
    def place(self) -> Place:
        """Place of the start of the sequence."""
        return place_of(self.spot)

    def item_at(self, index: int) -> Place:
        """Return the place of an item."""
        return place_of(self.spots[index])

    def placed(self) -> Iterator[tuple[Any, Place]]:
        """Yield each item with its place."""
        return zip(self, map(place_of, self.spots), strict=True)


_UNREAD = Map(Place(""))


def unread() -> Map:
    """Return the source of objects that were not read from a file: a shared empty
    mapping without a place.
    """
    return _UNREAD


def yaml_text(value: object) -> str:
    """Return a scalar as in YAML; ``(absent)`` for None."""
    if value is None:
        return "(absent)"
    return str(value).lower() if isinstance(value, bool) else str(value)


def plain(value: Any) -> Any:
    """Return a copy of a tree as plain dicts and lists, without places."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, list) else value
