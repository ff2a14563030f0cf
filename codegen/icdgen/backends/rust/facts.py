"""Declared facts of the protocol: their names and values in Rust.

Input is a `Fact` of `icdgen.protocol.declared`; the structs of the wire layer have
fields of the same names.
"""

from __future__ import annotations

from icdgen.backends.rust.literals import Expression, flat, flat_rows, some, spelled
from icdgen.backends.rust.text import mask
from icdgen.icd.buses import BUSES
from icdgen.protocol.declared import FactKind, ProtocolFact
from icdgen.protocol.sections import Crc, Index

# Types whose names in generated code are not those of the facts.
_TYPES: dict[type, str] = {Crc: "CrcForm", Index: "IndexForm"}


def type_name(part: type) -> str:
    """Return the name of the type of a part of the protocol."""
    return _TYPES.get(part, part.__name__)


def member_name(fact: ProtocolFact) -> str:
    """Return the name of the field of a fact; that of a time ends with its unit."""
    return f"{fact.name}_ms" if fact.kind is FactKind.TIME else fact.name


def value_of(fact: ProtocolFact, part: object) -> Expression:
    """Return the value of a fact."""
    value = getattr(part, fact.name)
    expression = None if value is None else _required(fact, value, part)
    return some(expression) if fact.is_optional else expression or ""


def _required(fact: ProtocolFact, value: object, part: object) -> Expression:
    if isinstance(value, tuple):
        if fact.kind is FactKind.BUSES:
            return flat("PerBus", **{bus: bus in value for bus in BUSES})
        return (
            flat("Span", at=value[0], bytes=value[1])
            if fact.kind is FactKind.SPAN
            else flat_rows(map(spelled, value))
        )
    assert isinstance(value, bool | int)
    if fact.kind is FactKind.OCTET:
        return mask(value, 8)
    width = getattr(part, "width", 32)  # a CRC states the width of its codes
    return (
        mask(value, -(-width // 4) * 4)
        if fact.kind is FactKind.CODE
        else spelled(value)
    )
