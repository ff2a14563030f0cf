"""Types of a .ksy: the nested types that the file declares, and the built-in numbers,
texts and bytes.

A built-in type becomes a `KaitaiFieldType`, to which `kaitai_layout` adds the position.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from icdgen.definitions import containers
from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.kaitai_yaml import integer
from icdgen.definitions.model import Definitions, Item, NotSupported
from icdgen.definitions.wording import line
from icdgen.icd.located import Map, Seq
from icdgen.icd.variable_length import MOST_BYTES

_NUMBER = re.compile(r"([usf])([1248])(le|be)?\Z")
_BITS = re.compile(r"b([1-9][0-9]?)(le|be)?\Z")
_KINDS = {"u": "uint", "s": "int", "f": "float"}
_ORDERS = {"le": LITTLE, "be": BIG}
# Encodings with one byte for each ASCII character; text in other encodings is imported
# as bytes.
_PLAIN = frozenset({"ASCII", "US-ASCII", "UTF-8", "ISO-8859-1"})
_DEEPEST = 40  # levels of nested types


@dataclass
class KaitaiFieldType(containers.FieldType):
    """Field that the type of an attribute describes.

    ``bits`` is the width of one element.
    """

    # A bit-sized integer, which begins at the next bit; other types begin at a byte.
    is_bits: bool = False


@dataclass
class KaitaiType:
    """Type that the file declares, with its nested types."""

    name: str
    body: Map
    outer: KaitaiType | None
    endian: str | None = None
    bit_endian: str = BIG
    types: dict[str, KaitaiType] = field(default_factory=dict)

    @property
    def seq(self) -> list[Map]:
        """Attributes in their order; empty without a `seq`.

        Raises `NotSupported` if `seq` is not a list of mappings.
        """
        attributes = self.body.get("seq")
        if attributes is None:
            return []
        if not isinstance(attributes, Seq) or not all(
            isinstance(attribute, Map) for attribute in attributes
        ):
            raise NotSupported(
                f"the `seq` of `{self.name}` is not a list of attributes"
            )
        return attributes

    @property
    def instances(self) -> Map | dict[str, Any]:
        """Computed values, and attributes at a stated position (`pos`)."""
        return mapping(self.body, "instances")

    def find_type(self, reference: str) -> KaitaiType:
        """Return the type that a reference names in this type or an enclosing one.

        Raises `NotSupported` if it is missing.
        """
        first, *inner_names = reference.split("::")
        scope: KaitaiType | None = self
        while scope is not None:
            result = scope.types.get(first) or (
                scope if scope.outer is None and scope.name == first else None
            )
            for inner_name in inner_names:
                result = result.types.get(inner_name) if result else None
            if result is not None:
                return result
            scope = scope.outer
        raise NotSupported(f"there is no type `{line(reference, 60)}`")

    def members(self, reference: str) -> dict[int, str]:
        """Return the members of an enumeration by value.

        Raises `NotSupported` if this and the enclosing types lack it.
        """
        *path, name = reference.split("::")
        scope: KaitaiType | None = self.find_type("::".join(path)) if path else self
        while scope is not None:
            enumeration = mapping(scope.body, "enums").get(name)
            if isinstance(enumeration, Map):
                return {
                    value: _member_name(member)
                    for key, member in enumeration.items()
                    if (value := integer(key)) is not None
                }
            scope = scope.outer
        raise NotSupported(f"there is no enumeration `{line(reference, 60)}`")


def _member_name(member: object) -> str:
    """Return the name of a member that is a mapping with an `id`, or only a name."""
    return str(member.get("id", "") if isinstance(member, Map) else member)


def mapping(body: Map, key: str) -> Map | dict[str, Any]:
    """Return the mapping of a key, an empty one if the key is missing or has no
    mapping.
    """
    value = body.get(key)
    return value if isinstance(value, Map) else {}


def declare_types(
    name: str, body: Map, outer: KaitaiType | None = None, depth: int = 0
) -> KaitaiType:
    """Return a type with its nested types.

    A type inherits the byte order and bit order of the enclosing one.
    """
    meta = mapping(body, "meta")
    endian = outer.endian if outer else None
    if "endian" in meta:
        endian = _ORDERS.get(str(meta["endian"]))
    bits = _ORDERS.get(str(meta.get("bit-endian")), outer.bit_endian if outer else BIG)
    result = KaitaiType(name, body, outer, endian, bits)
    for inner, of in mapping(body, "types").items() if depth < _DEEPEST else ():
        if isinstance(of, Map):
            result.types[inner] = declare_types(inner, of, result, depth + 1)
    return result


def built_in_type(
    name: str, attribute: Map, within: KaitaiType
) -> KaitaiFieldType | None:
    """Return the field of a built-in type, None for a type that the file declares.

    ``within`` has the default byte order and encoding. A size that another field gives
    is 0 bits. Raises `NotSupported` if the type is not supported.
    """
    if (number := _NUMBER.match(name)) is not None:
        kind, size, suffix = number.groups()
        if kind == "f" and size in "12":
            raise NotSupported(f"there is no type `{name}`")
        order = _ORDERS[suffix] if suffix else within.endian
        if order is None and size != "1":
            raise NotSupported(f"the byte order of `{name}` is not stated")
        return KaitaiFieldType({"type": _KINDS[kind]}, 8 * int(size), order or BIG)
    if (bits := _BITS.match(name)) is not None:
        width, order = int(bits[1]), _ORDERS[bits[2]] if bits[2] else within.bit_endian
        if width > 64:
            raise NotSupported(f"an integer has {width} bits")
        # `b1` is a boolean in Kaitai Struct, wider types are integers.
        kind = "bool" if width == 1 and "enum" not in attribute else "uint"
        return KaitaiFieldType({"type": kind}, width, order, is_bits=True)
    if name not in ("str", "strz", ""):
        return None
    encoding = attribute.get("encoding") or _encoding(within)
    kind = "text" if name and str(encoding).upper() in _PLAIN else "bytes"
    if (size := stated_size(attribute)) is not None:
        return KaitaiFieldType({"type": kind}, 8 * size)
    if "size" in attribute:
        return KaitaiFieldType({"type": kind}, 0)  # a field gives the size
    if attribute.get("size-eos") is True:
        return KaitaiFieldType({"type": kind}, 0)
    if name == "strz" or "terminator" in attribute:
        raise NotSupported("its size is not stated: it ends at a terminator")
    raise NotSupported("its size is not stated")


def stated_size(attribute: Map) -> int | None:
    """Return the `size` of an attribute in bytes, None if it is not a number.

    Raises `NotSupported` if it is out of range.
    """
    stated = attribute.get("size")
    size = integer(stated.strip()) if isinstance(stated, str) else stated
    if not isinstance(size, int) or isinstance(size, bool):
        return None
    if not 0 <= size <= MOST_BYTES:
        raise NotSupported(f"its size is {size}")
    return size


def stated_contents(attribute: Map) -> bytes | None:
    """Return the constant bytes of an attribute (`contents`), None without the key.

    Raises `NotSupported` for bad values.
    """
    stated = attribute.get("contents")
    if stated is None:
        return None
    parts = stated if isinstance(stated, Seq) else [stated]
    result = b""
    for part in parts:
        value = (
            integer(part)
            if isinstance(part, str) and integer(part) is not None
            else part
        )
        if isinstance(value, int) and 0 <= value <= 255:
            result += bytes([value])
        elif isinstance(part, str):
            result += part.encode()
        else:
            raise NotSupported(f"its contents are `{line(str(part), 60)}`")
    if not 1 <= len(result) <= MOST_BYTES:
        raise NotSupported(f"its contents are {len(result)} bytes")
    return result


def add_enumeration(
    item: Item,
    bits: int,
    reference: str,
    within: KaitaiType,
    enums: Enumerations,
    to: Definitions,
) -> None:
    """Add the enumeration that ``reference`` names to an integer of ``bits``.

    Raises `NotSupported`.
    """
    choices = within.members(reference)
    if item["type"] not in ("uint", "int"):
        raise NotSupported(
            f"it has names for values, and is of the type {item['type']}"
        )
    enums.assign_value_names(
        item,
        bits,
        choices,
        reference.rsplit("::", 1)[-1],
        within.name,
        f"`{reference}`",
        to,
    )


def _encoding(within: KaitaiType) -> object:
    """Return the default text encoding (`meta.encoding`) of a type or the nearest
    enclosing one.
    """
    scope: KaitaiType | None = within
    while scope is not None:
        if (encoding := mapping(scope.body, "meta").get("encoding")) is not None:
            return encoding
        scope = scope.outer
    return None
