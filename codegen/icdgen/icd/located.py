"""What a YAML file is read into: plain values in mappings and sequences that remember where everything stood."""

from __future__ import annotations

from typing import Any

from icdgen.diagnostics import Place


class Map(dict[str, Any]):
    """A mapping; ``place`` is where it starts, ``keys_at`` and ``values_at`` give the place of each key and value."""

    __slots__ = ("place", "keys_at", "values_at")

    def __init__(self, place: Place) -> None:
        self.place = place
        self.keys_at: dict[str, Place] = {}
        self.values_at: dict[str, Place] = {}

    def at(self, key: str) -> Place:
        """Where the value of ``key`` stands; the mapping itself if it has no such key."""
        return self.values_at.get(key, self.place)


class Seq(list[Any]):
    """A sequence; ``items_at`` gives the place of each item."""

    __slots__ = ("place", "items_at")

    def __init__(self, place: Place) -> None:
        self.place = place
        self.items_at: list[Place] = []


_UNREAD = Map(Place(""))


def unread() -> Map:
    """The source of what was not read from a file: an empty mapping that stands nowhere."""
    return _UNREAD
