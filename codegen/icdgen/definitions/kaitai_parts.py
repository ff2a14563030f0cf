"""Parts of a message of a .ksy, and the scopes in which expressions refer to them."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.definitions import containers
from icdgen.definitions.containers import Counter
from icdgen.definitions.frames import Place
from icdgen.definitions.kaitai_types import Piece, Type
from icdgen.definitions.model import Item, NotSupported
from icdgen.definitions.reading import Reading
from icdgen.definitions.wording import line
from icdgen.frozen import NamedTuple
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

# Path of a field, mask of its bits, and the values that have branches.
Key = tuple[tuple[str, ...], int, tuple[int, ...]]


class Undecided(Exception):
    """Raised if the layout depends on a value that is not decided yet.

    ``options`` are the values to try; None stands for all other values.
    """

    def __init__(self, key: Key, options: list[int | None]) -> None:
        self.key, self.options = key, options


class Ended(Exception):
    """Raised if the remaining bytes of the enclosing type are imported without their
    structure.
    """


class Label(NamedTuple):
    """Word that a branch adds to the name of the message, and the value that selects
    the branch.
    """

    word: str
    value: str


@dataclass
class Part(containers.Part):
    """Attribute at its position.

    The bits of ``mask`` have the fixed values in ``value``. ``excluded`` are pairs of
    mask and value that do not occur.
    """

    piece: Piece = field(kw_only=True)
    mask: int = 0
    value: int = 0
    excluded: set[tuple[int, int]] = field(default_factory=set)
    # False for bytes that replace an attribute that is not supported
    is_whole: bool = True

    @property
    def is_ordered(self) -> bool:
        """Whether the byte or bit order affects the part."""
        is_number = self.item.get("type", "bytes") not in ("bytes", "text")
        return is_number and (
            self.piece.is_bits
            or self.piece.bits > 8
            or (self.mask > 0 and "count" not in self.item)
        )

    @property
    def place(self) -> Place:
        """Position of the part in the message."""
        return Place(self.at, self.bits, self.piece.order)


def placed(
    path: tuple[str, ...], piece: Piece, at: int, counter: Counter | None = None
) -> Part:
    """Return the part that a piece makes at a bit.

    ``counter`` counts its elements, or bytes.
    """
    item, count = piece.item, piece.item.get("count", 1)
    bits = piece.bits * count if isinstance(count, int) else 0
    if not bits:
        most = MOST_ELEMENTS if "count" in item else MOST_BYTES
        item["up_to"] = min(most, counter.most) if counter is not None else most
    return Part(
        path, item, at, bits, piece.order, piece.bits or 8, counter, piece=piece
    )


@dataclass
class Scope:
    """Names that expressions within a type can refer to."""

    type: Type
    outer: Scope | None = None
    names: dict[str, Part | Scope] = field(default_factory=dict)

    def find(self, path: str) -> Part:
        """Return the part at a path such as ``_parent.header.length``.

        Raises `NotSupported` if no preceding part has it.
        """
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
            raise NotSupported(f"`{line(path, 80)}` is not a number in front of it")
        return here


@dataclass
class File(Reading):
    """State that all messages of a file share."""

    # Attributes of all messages; a small file can have many combinations of branches.
    most_steps = 100_000

    structs: dict[int, Item] = field(default_factory=dict)  # by `id` of the type

    def note(
        self, code: str, message: str, help: str, severity: str, at: int | None
    ) -> None:
        """Report a finding once, even if it applies to several messages."""
        self.heard(message).warn(code, message, help, severity, at)
