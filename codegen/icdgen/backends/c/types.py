"""C types of raw values, masks and casts.

Casts are macros of the support header, because C++ compilers warn about casts of C.
"""

from __future__ import annotations

from functools import cache

from icdgen.backends.c.symbols import C_NAMES
from icdgen.describe import FieldDescription


def type_of(field: FieldDescription) -> str:
    """Return the type of an integer, bool, enum or float field."""
    kind = field.model.type
    if kind == "bool":
        return "bool"
    if kind == "float":
        return "float" if field.model.bits == 32 else "double"
    if field.enum is not None:
        return C_NAMES.symbol(field.enum, "t")
    return f"{'int' if field.storage.signed else 'uint'}{field.storage.bits}_t"


def declaration(field: FieldDescription) -> str:
    """Return the declaration of a member of a struct."""
    name = field.name + (f"[{field.count}]" if field.count else "")
    if field.model.is_bytes:
        return f"uint8_t {name}[{field.size}]"
    return f"{C_NAMES.symbol(field.struct, 't') if field.struct is not None else type_of(field)} {name}"


@cache
def mask(value: int, bits: int) -> str:
    """Return an unsigned literal of the width: ``0x0Fu``."""
    # C99 7.18.4.1: the macro adds the suffix that the target needs for 64 bits.
    if bits == 64:
        return f"UINT64_C(0x{value:016X})"
    return f"0x{value:0{bits // 4}X}u"


def cast(value: str, bits: int, signed: bool = False) -> str:
    """Return a value converted to an integer of the width, by a macro that compiles
    without a warning in C++, too.
    """
    return f"ICDGEN_{'I' if signed else 'U'}{bits}({value})"
