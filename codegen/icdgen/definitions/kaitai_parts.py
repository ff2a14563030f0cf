"""What stands in a message of a .ksy, and what an expression can name of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from icdgen.definitions import containers
from icdgen.definitions.containers import Counter
from icdgen.definitions.frames import Place
from icdgen.definitions.kaitai_types import Piece, Type
from icdgen.definitions.model import Item, NotHeld
from icdgen.definitions.reading import Reading
from icdgen.definitions.wording import line
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

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


@dataclass
class Part(containers.Part):
    """Attribute in its place. The bits of ``mask`` have the values in ``value``; ``excluded`` are pairs of mask and value."""

    piece: Piece = field(kw_only=True)
    mask: int = 0
    value: int = 0
    excluded: set[tuple[int, int]] = field(default_factory=set)
    is_whole: bool = True  # whether it is what the file defines, and not bytes in its place

    @property
    def is_ordered(self) -> bool:
        """Whether it matters which of its bits or bytes is sent first."""
        is_number = self.item.get("type", "bytes") not in ("bytes", "text")
        return is_number and (self.piece.is_bits or self.piece.bits > 8 or (self.mask > 0 and "count" not in self.item))

    @property
    def place(self) -> Place:
        return Place(self.at, self.bits, self.piece.order)


def placed(path: tuple[str, ...], piece: Piece, at: int, counter: Counter | None = None) -> Part:
    """Return the part that a piece makes at a bit. ``counter`` counts its elements, or bytes."""
    item, count = piece.item, piece.item.get("count", 1)
    bits = piece.bits * count if isinstance(count, int) else 0
    if not bits:
        most = MOST_ELEMENTS if "count" in item else MOST_BYTES
        item["up_to"] = min(most, counter.most) if counter is not None else most
    return Part(path, item, at, bits, piece.order, piece.bits or 8, counter, piece=piece)


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
