"""What a YAML file is read into: plain values in mappings and sequences that remember where everything stood."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

from icdgen.diagnostics import Place


class Mark(Protocol):
    """A point in the file ``name``, as the reader of YAML gives it; all count from 0."""

    name: str
    index: int
    line: int
    column: int


Spot = Place | tuple[Mark, Mark]
"""Place of a node, or its begin and end marks, from which the place is computed on demand."""


def place_of(spot: Spot) -> Place:
    """The place that a spot is."""
    if isinstance(spot, Place):
        return spot
    start, end = spot
    length = end.column - start.column if end.line == start.line else 1
    return Place(start.name, start.line + 1, start.column + 1, max(length, 1))


class Map(dict[str, Any]):
    """A mapping; ``spots`` has where each key and its value stood, those that an erratum took away included."""

    __slots__ = ("spot", "spots")

    def __init__(self, spot: Spot) -> None:
        self.spot = spot
        self.spots: dict[str, tuple[Spot, Spot]] = {}

    @property
    def place(self) -> Place:
        """Where the mapping starts."""
        return place_of(self.spot)

    def key_at(self, key: str) -> Place:
        """Where ``key`` stands."""
        return place_of(self.spots[key][0])

    def at(self, key: str) -> Place:
        """Where the value of ``key`` stands; the mapping itself if it has no such key."""
        return place_of(self.spots[key][1] if key in self.spots else self.spot)


class Seq(list[Any]):
    """A sequence; ``spots`` has where each item stood."""

    __slots__ = ("spot", "spots")

    def __init__(self, spot: Spot) -> None:
        self.spot = spot
        self.spots: list[Spot] = []

    @property
    def place(self) -> Place:
        """Where the sequence starts."""
        return place_of(self.spot)

    def item_at(self, index: int) -> Place:
        """Where the item of this index stands."""
        return place_of(self.spots[index])

    def placed(self) -> Iterator[tuple[Any, Place]]:
        """Each item and where it stands."""
        return zip(self, map(place_of, self.spots), strict=True)


_UNREAD = Map(Place(""))


def unread() -> Map:
    """The source of what was not read from a file: an empty mapping that stands nowhere."""
    return _UNREAD


def plain(value: Any) -> Any:
    """A tree without positions, at any depth."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, list) else value
