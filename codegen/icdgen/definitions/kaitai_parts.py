"""What stands in a message of a .ksy, and what an expression can name of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from icdgen.definitions.frames import Place
from icdgen.definitions.kaitai_types import Piece, Type
from icdgen.definitions.model import Item, NotHeld
from icdgen.definitions.reading import Reading
from icdgen.definitions.wording import line

Key = tuple[tuple[str, ...], int, tuple[int, ...]]  # a field by its path, bits of it, and the values that are asked for


class Undecided(Exception):
    """What comes next depends on a value: one of ``options``, or none of them (None)."""

    def __init__(self, key: Key, options: list[int | None]) -> None:
        self.key, self.options = key, options


class Ended(Exception):
    """The rest of what is being read is imported as bytes."""


class Label(NamedTuple):
    """What a decision adds to the name of the message, and the value that was decided on."""

    word: str
    value: str


class Counter(NamedTuple):
    """What says how many elements there are, or bytes: a field, and what is added to it."""

    of: Part
    plus: int

    @property
    def most(self) -> int:
        return (1 << self.of.bits) - 1 + self.plus


@dataclass
class Part:
    """A field in its place. Of ``mask`` the bits are known, as ``value`` has them; ``excluded`` are values that it has not."""

    path: tuple[str, ...]
    item: Item
    piece: Piece
    at: int
    mask: int = 0
    value: int = 0
    excluded: set[tuple[int, int]] = field(default_factory=set)
    is_whole: bool = True  # whether it is what the file defines, and not bytes that stand for it
    counter: Counter | None = None  # of what goes on as long as a field says

    @property
    def bits(self) -> int:
        """All of it; 0 where it goes on to the end."""
        count = self.item.get("count", 1)
        return self.piece.bits * count if isinstance(count, int) else 0

    @property
    def is_ordered(self) -> bool:
        """Whether it matters which of its bits or bytes is sent first."""
        is_number = self.item.get("type", "bytes") not in ("bytes", "text")
        return is_number and (self.piece.is_bits or self.piece.bits > 8 or (self.mask > 0 and "count" not in self.item))

    @property
    def place(self) -> Place:
        return Place(self.at, self.bits, self.piece.order)


@dataclass
class Scope:
    """What an expression can name within a type."""

    type: Type
    outer: Scope | None = None
    names: dict[str, Part | Scope] = field(default_factory=dict)

    def find(self, path: str) -> Part:
        """Raises `NotHeld`."""
        here: Part | Scope | None = self
        for name in path.split("."):
            if not isinstance(here, Scope):
                here = None
            elif name == "_root":
                while here.outer is not None:
                    here = here.outer
            elif name == "_parent":
                here = here.outer
            else:
                here = here.names.get(name)
        if not isinstance(here, Part):
            raise NotHeld(f"`{line(path, 80)}` is not a number in front of it")
        return here


@dataclass
class File(Reading):
    """What all messages of a file share."""

    most_steps = 100_000  # attributes of all messages

    structs: dict[int, Item] = field(default_factory=dict)  # by the type

    def note(self, code: str, message: str, help: str, severity: str, at: int | None) -> None:
        """Once, however many messages it concerns."""
        self.heard(message).warn(code, message, help, severity, at)
