"""Which C type holds a raw value, and how masks and casts to it are written."""

from __future__ import annotations

from functools import cache

from icdgen.backends.c.names import stem
from icdgen.describe import FieldDescription


def type_of(field: FieldDescription) -> str:
    """The type of an integer, bool, enum or float field."""
    kind = field.model.type
    if kind == "bool":
        return "bool"
    if kind == "float":
        return "float" if field.model.bits == 32 else "double"
    if field.enum is not None:
        return f"{stem(field.enum)}_t"
    return f"{'int' if field.storage.signed else 'uint'}{field.storage.bits}_t"


def declaration(field: FieldDescription) -> str:
    """The member of a message's struct."""
    name = field.name + (f"[{field.count}]" if field.count else "")
    if field.model.is_bytes:
        return f"uint8_t {name}[{field.size}]"
    return f"{f'{stem(field.struct)}_t' if field.struct is not None else type_of(field)} {name}"


@cache
def mask(value: int, bits: int) -> str:
    """``0x0Fu``: an unsigned literal of the width."""
    if bits == 64:
        return f"UINT64_C(0x{value:016X})"
    return f"0x{value:0{bits // 4}X}u"


def cast(value: str, bits: int, signed: bool = False) -> str:
    """The value converted to an integer of the width, by a macro that C++ accepts without complaint."""
    return f"ICDGEN_{'I' if signed else 'U'}{bits}({value})"
