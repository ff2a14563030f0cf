"""Types of a .ksy: those that the file declares, within each other, and the numbers, texts and bytes that are built in."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from icdgen.definitions import containers
from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.kaitai_yaml import integer
from icdgen.definitions.model import Definitions, Item, NotHeld
from icdgen.definitions.wording import line
from icdgen.icd.located import Map, Seq
from icdgen.icd.variable_length import MOST_BYTES

_NUMBER = re.compile(r"([usf])([1248])(le|be)?\Z")
_BITS = re.compile(r"b([1-9][0-9]?)(le|be)?\Z")
_KINDS = {"u": "uint", "s": "int", "f": "float"}
_ORDERS = {"le": LITTLE, "be": BIG}
_PLAIN = frozenset({"ASCII", "US-ASCII", "UTF-8", "ISO-8859-1"})
_DEEPEST = 40


@dataclass
class Piece(containers.Piece):
    """Field that the type of an attribute makes. ``bits`` are those of one element."""

    is_bits: bool = False  # whether it begins where the bit before it ended


@dataclass
class Type:
    """A type of the file, and what it declares within."""

    name: str
    body: Map
    outer: Type | None
    endian: str | None = None
    bit_endian: str = BIG
    types: dict[str, Type] = field(default_factory=dict)

    @property
    def seq(self) -> list[Map]:
        """The attributes one after the other; none of a type that only computes, or tells cases apart. Raises `NotHeld`."""
        found = self.body.get("seq")
        if found is None:
            return []
        if not isinstance(found, Seq) or not all(isinstance(one, Map) for one in found):
            raise NotHeld(f"the `seq` of `{self.name}` is not a list of attributes")
        return found

    @property
    def instances(self) -> Map | dict[str, Any]:
        """What is computed, or stands elsewhere."""
        return mapping(self.body, "instances")

    def find(self, reference: str) -> Type:
        """The type that is named here: of this type, or of one around it. Raises `NotHeld`."""
        first, *rest = reference.split("::")
        around: Type | None = self
        while around is not None:
            found = around.types.get(first) or (around if around.outer is None and around.name == first else None)
            for inner in rest:
                found = found.types.get(inner) if found else None
            if found is not None:
                return found
            around = around.outer
        raise NotHeld(f"there is no type `{line(reference, 60)}`")

    def members(self, reference: str) -> dict[int, str]:
        """The names of the values of an enumeration. Raises `NotHeld`."""
        *path, name = reference.split("::")
        around: Type | None = self.find("::".join(path)) if path else self
        while around is not None:
            found = mapping(around.body, "enums").get(name)
            if isinstance(found, Map):
                return {
                    value: str(said.get("id", "") if isinstance(said, Map) else said)
                    for key, said in found.items()
                    if (value := integer(key)) is not None
                }
            around = around.outer
        raise NotHeld(f"there is no enumeration `{line(reference, 60)}`")


def mapping(body: Map, key: str) -> Map | dict[str, Any]:
    """What stands under a key, if that is a mapping."""
    found = body.get(key)
    return found if isinstance(found, Map) else {}


def declared(name: str, body: Map, outer: Type | None = None, depth: int = 0) -> Type:
    """A type with those that it declares."""
    meta = mapping(body, "meta")
    endian = outer.endian if outer else None
    if "endian" in meta:
        endian = _ORDERS.get(str(meta["endian"]))
    bits = _ORDERS.get(str(meta.get("bit-endian")), outer.bit_endian if outer else BIG)
    made = Type(name, body, outer, endian, bits)
    for inner, of in mapping(body, "types").items() if depth < _DEEPEST else ():
        if isinstance(of, Map):
            made.types[inner] = declared(inner, of, made, depth + 1)
    return made


def built_in(name: str, attribute: Map, within: Type) -> Piece | None:
    """A number, a text or bytes; None for a type that the file declares. Raises `NotHeld`."""
    if (number := _NUMBER.match(name)) is not None:
        kind, size, said = number.groups()
        if kind == "f" and size in "12":
            raise NotHeld(f"there is no type `{name}`")
        order = _ORDERS[said] if said else within.endian
        if order is None and size != "1":
            raise NotHeld(f"the byte order of `{name}` is not stated")
        return Piece({"type": _KINDS[kind]}, 8 * int(size), order or BIG)
    if (bits := _BITS.match(name)) is not None:
        width, order = int(bits[1]), _ORDERS[bits[2]] if bits[2] else within.bit_endian
        if width > 64:
            raise NotHeld(f"an integer has {width} bits")
        kind = "bool" if width == 1 and "enum" not in attribute else "uint"
        return Piece({"type": kind}, width, order, is_bits=True)
    if name not in ("str", "strz", ""):
        return None
    encoding = attribute.get("encoding") or _encoding(within)
    kind = "text" if name and str(encoding).upper() in _PLAIN else "bytes"
    if (size := sized(attribute)) is not None:
        return Piece({"type": kind}, 8 * size)
    if "size" in attribute:
        return Piece({"type": kind}, 0)  # a field says it
    if attribute.get("size-eos") is True:
        return Piece({"type": kind}, 0)
    if name == "strz" or "terminator" in attribute:
        raise NotHeld("its size is not stated: it ends at a terminator")
    raise NotHeld("its size is not stated")


def sized(attribute: Map) -> int | None:
    """The bytes that an attribute has, where that is a number. Raises `NotHeld` for one that is none of a frame."""
    said = attribute.get("size")
    size = integer(said.strip()) if isinstance(said, str) else said
    if not isinstance(size, int) or isinstance(size, bool):
        return None
    if not 0 <= size <= MOST_BYTES:
        raise NotHeld(f"its size is {size}")
    return size


def contents(attribute: Map) -> bytes | None:
    """The bytes that an attribute always has; None if it may have any. Raises `NotHeld`."""
    said = attribute.get("contents")
    if said is None:
        return None
    parts = said if isinstance(said, Seq) else [said]
    made = b""
    for part in parts:
        value = integer(part) if isinstance(part, str) and integer(part) is not None else part
        if isinstance(value, int) and 0 <= value <= 255:
            made += bytes([value])
        elif isinstance(part, str):
            made += part.encode()
        else:
            raise NotHeld(f"its contents are `{line(str(part), 60)}`")
    if not 1 <= len(made) <= MOST_BYTES:
        raise NotHeld(f"its contents are {len(made)} bytes")
    return made


def named(item: Item, bits: int, reference: str, within: Type, enums: Enumerations, to: Definitions) -> None:
    """Gives the values of a number their names. Raises `NotHeld`."""
    choices = within.members(reference)
    if item["type"] not in ("uint", "int"):
        raise NotHeld(f"it has names for values, and is of the type {item['type']}")
    enums.hold(item, bits, choices, reference.rsplit("::", 1)[-1], within.name, f"`{reference}`", to)


def _encoding(within: Type) -> object:
    around: Type | None = within
    while around is not None:
        if (said := mapping(around.body, "meta").get("encoding")) is not None:
            return said
        around = around.outer
    return None
