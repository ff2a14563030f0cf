"""Which C type holds a raw value, and how masks and casts to it are written."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from icdgen.backends.c.names import Names
from icdgen.icd.model import Enum, Field, Icd


class Storage(NamedTuple):
    """``bits`` of the integer that holds the raw value and its sign; ``type`` as declared."""

    type: str
    bits: int
    signed: bool

    @property
    def min(self) -> int:
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def max(self) -> int:
        return (1 << (self.bits - self.signed)) - 1


def holding(bits: int) -> int:
    """The smallest of 8, 16, 32 and 64 that is not below ``bits``."""
    return 8 if bits <= 8 else 16 if bits <= 16 else 32 if bits <= 32 else 64


class Storages:
    """Storage of every field; an enumeration is as wide as its declaring node needs it."""

    def __init__(self, icd: Icd, names: Names) -> None:
        self._names = names
        self._enums: dict[tuple[str, str], int] = {}
        for node in icd.nodes:
            for enum in node.enums:
                self._widen(enum, max((m.value.bit_length() for m in enum.members), default=1))
            for message in node.messages:
                for field in message.fields:
                    if field.enum is not None and field.enum.node == node.name:
                        self._widen(field.enum, field.bits)

    def _widen(self, enum: Enum, bits: int) -> None:
        key = (enum.node, enum.name)
        self._enums[key] = max(self._enums.get(key, 8), holding(bits))

    def enum_bits(self, enum: Enum) -> int:
        """Width of the enumeration's type."""
        return self._enums[enum.node, enum.name]

    def of(self, field: Field) -> Storage:
        """Storage of an integer, enum or bool field, or of the bits of a float."""
        bits = holding(field.bits)
        if field.type == "bool":
            return Storage("bool", 8, False)
        if field.type == "float":
            return Storage("float" if field.bits == 32 else "double", bits, False)
        if field.type == "enum" and field.enum is not None:
            enum_bits = self.enum_bits(field.enum)
            if bits <= enum_bits:
                return Storage(f"{self._names.enum(field.enum)}_t", enum_bits, False)
        return Storage(f"{'' if field.signed else 'u'}int{bits}_t", bits, field.signed)


@cache
def mask(value: int, bits: int) -> str:
    """``0x0Fu``: an unsigned literal of the width."""
    if bits == 64:
        return f"UINT64_C(0x{value:016X})"
    return f"0x{value:0{bits // 4}X}u"


def cast(value: str, bits: int, signed: bool = False) -> str:
    """The value converted to an integer of the width, by a macro that C++ accepts without complaint."""
    return f"ICDGEN_{'I' if signed else 'U'}{bits}({value})"
