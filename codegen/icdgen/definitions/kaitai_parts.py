"""Parts of a message of a .ksy, and the scopes in which expressions refer to them.

`placed` makes a `KaitaiPart` from the field type of an attribute and its position.
`TypeScope.find_part` finds a preceding part by a path such as ``_parent.length``, and
`apply_valid` adds constants and limits. `File` is the state that all messages of a file
share. `kaitai_layout` calls these in the order of the attributes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from icdgen.definitions import containers
from icdgen.definitions.containers import Counter
from icdgen.definitions.frames import FrameBits
from icdgen.definitions.kaitai_expressions import number
from icdgen.definitions.kaitai_types import KaitaiFieldType, KaitaiType
from icdgen.definitions.model import Item, NotSupported
from icdgen.definitions.reading import ReadingState
from icdgen.definitions.wording import line
from icdgen.frozen import NamedTuple
from icdgen.icd.layout import integer_range
from icdgen.icd.located import Map
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


class BranchLabel(NamedTuple):
    """Word that a branch adds to the name of the message, and the value that selects
    the branch.
    """

    word: str
    value: str


@dataclass
class KaitaiPart(containers.ContainerPart):
    """Attribute at its position.

    The bits of ``mask`` have the fixed values in ``value``. ``excluded`` are pairs of
    mask and value that do not occur.
    """

    field_type: KaitaiFieldType = field(kw_only=True)
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
            self.field_type.is_bits
            or self.field_type.bits > 8
            or (self.mask > 0 and "count" not in self.item)
        )

    @property
    def place(self) -> FrameBits:
        """Position of the part in the message."""
        return FrameBits(self.at, self.bits, self.field_type.order)


def placed(
    path: tuple[str, ...],
    field_type: KaitaiFieldType,
    at: int,
    counter: Counter | None = None,
) -> KaitaiPart:
    """Return the part that a field type makes at a bit.

    ``counter`` counts its elements, or bytes.
    """
    item, count = field_type.item, field_type.item.get("count", 1)
    bits = field_type.bits * count if isinstance(count, int) else 0
    if not bits:
        most = MOST_ELEMENTS if "count" in item else MOST_BYTES
        item["up_to"] = min(most, counter.most) if counter is not None else most
    return KaitaiPart(
        path,
        item,
        at,
        bits,
        field_type.order,
        field_type.bits or 8,
        counter,
        field_type=field_type,
    )


@dataclass
class TypeScope:
    """Names that expressions within a type can refer to."""

    type: KaitaiType
    outer: TypeScope | None = None
    names: dict[str, KaitaiPart | TypeScope] = field(default_factory=dict)

    def find_part(self, path: str) -> KaitaiPart:
        """Return the part at a path such as ``_parent.header.length``.

        Raises `NotSupported` if no preceding part has it.
        """
        here: KaitaiPart | TypeScope | None = self
        for name in path.split("."):
            if not isinstance(here, TypeScope):
                here = None
            elif name == "_root":
                while here.outer is not None:
                    here = here.outer
            elif name == "_parent":
                here = here.outer
            else:
                here = here.names.get(name)
        if not isinstance(here, KaitaiPart):
            raise NotSupported(f"`{line(path, 80)}` is not a number in front of it")
        return here


def apply_valid(part: KaitaiPart, valid: Any, scope: TypeScope) -> None:
    """Apply the key `valid`: a single value becomes a constant, `min` and `max`
    become limits.

    Ignores other forms.
    """
    item = part.item
    if (
        valid is None
        or item["type"] not in ("uint", "int", "enum", "bool")
        or "count" in item
    ):
        return
    equal = valid.get("eq") if isinstance(valid, Map) else valid
    all_bits = (1 << part.bits) - 1
    if isinstance(valid, Map) and item["type"] in ("uint", "int"):
        low, high = integer_range(part.bits, item["type"] == "int")
        item |= {
            key: valid[key]
            for key in ("min", "max")
            if type(valid.get(key)) is int and low <= valid[key] <= high
        }
    try:
        value = number(str(equal), scope.type.members)
    except NotSupported:
        return  # `valid` has an expression
    part.mask, part.value = all_bits, value & all_bits


@dataclass
class File(ReadingState):
    """State that all messages of a file share."""

    # Attributes of all messages; a small file can have many combinations of branches.
    most_steps = 100_000

    structs: dict[int, Item] = field(default_factory=dict)  # by `id` of the type

    def note(
        self, code: str, message: str, help: str, severity: str, at: int | None
    ) -> None:
        """Report a finding once, even if it applies to several messages."""
        self.heard(message).warn(code, message, help, severity, at)
