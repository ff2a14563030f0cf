"""Declared facts of the protocol: their names and values in Rust."""

from __future__ import annotations

from icdgen.backends.rust.literals import Expression, flat, flat_rows, some, spelled
from icdgen.backends.rust.text import mask
from icdgen.protocol.declared import Fact, Kind
from icdgen.protocol.sections import BUSES, Crc, Download, Erasure, HoleMap, Index, Listing, Operation, Upload

# Types whose names in generated code are not those of the facts.
_TYPES: dict[type, str] = {
    Crc: "CrcForm", Index: "IndexForm", HoleMap: "HoleMapForm", Listing: "ListForm",
    Download: "DownloadForm", Upload: "UploadForm", Erasure: "ErasureForm", Operation: "OperationForm",
}  # fmt: skip


def type_name(part: type) -> str:
    """What the type of a part is called."""
    return _TYPES.get(part, part.__name__)


def member_name(fact: Fact) -> str:
    """What the field of a fact is called; a time says its unit."""
    return f"{fact.name}_ms" if fact.kind is Kind.TIME else fact.name


def value_of(fact: Fact, part: object) -> Expression:
    """The value of a fact that is no step."""
    value = getattr(part, fact.name)
    known = None if value is None else _known(fact, value, part)
    return some(known) if fact.is_optional else known or ""


def _known(fact: Fact, value: object, part: object) -> Expression:
    if isinstance(value, tuple):
        if fact.kind is Kind.BUSES:
            return flat("PerBus", **{bus: bus in value for bus in BUSES})
        return flat("Span", at=value[0], bytes=value[1]) if fact.kind is Kind.SPAN else flat_rows(map(spelled, value))
    assert isinstance(value, bool | int)
    if fact.kind is Kind.OCTET:
        return mask(value, 8)
    width = getattr(part, "width", 32)  # of the codes: those of a CRC are as wide as it
    return mask(value, -(-width // 4) * 4) if fact.kind is Kind.CODE else spelled(value)
