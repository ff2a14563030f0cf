"""Declared facts of the protocol -> parts of struct literals."""

from __future__ import annotations

from icdgen.backends.rust.literals import Optional, Part, Raw, Rows, Struct, flat
from icdgen.backends.rust.text import mask
from icdgen.backends.rust.wire_steps import step
from icdgen.protocol.declared import Fact, Kind, facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import (
    BUSES,
    Crc,
    Download,
    Erasure,
    HoleMap,
    Index,
    Listing,
    Operation,
    Settings,
    Step,
    Upload,
)

# Types whose names in generated code are not those of the facts.
_TYPES: dict[type, str] = {
    Settings: "Settings", Crc: "CrcForm", Index: "IndexForm", HoleMap: "HoleMapForm", Listing: "ListForm",
    Download: "DownloadForm", Upload: "UploadForm", Erasure: "ErasureForm", Operation: "OperationForm",
}  # fmt: skip


def type_name(part: type) -> str:
    """What the type of a part is called."""
    return _TYPES.get(part, part.__name__)


def member_name(fact: Fact) -> str:
    """What the field of a fact is called; a time says its unit."""
    return f"{fact.name}_ms" if fact.kind is Kind.TIME else fact.name


def struct(known: Facts, part: object, section: str, *made: Part) -> Struct | None:
    """The facts of a part, and what code ``made`` beside them."""
    if part is None:
        return None
    width = getattr(part, "width", 32)  # of the codes: those of a CRC are as wide as it
    found = [
        Part(
            member_name(fact),
            _spelled(known, fact, getattr(part, fact.name), width),
            f"{section}.{fact.key.partition('.')[0]}" if fact.key else "",
        )
        for fact in facts_of(part)
    ]
    return Struct(type_name(type(part)), (*found, *made))


def _spelled(known: Facts, fact: Fact, value: object, width: int) -> object:
    if fact.is_optional:
        return Optional(None if value is None else _one(known, fact, value, width))
    return _one(known, fact, value, width)


def _one(known: Facts, fact: Fact, value: object, width: int) -> object:
    if isinstance(value, Step):
        return step(known, value, fact.direction)
    if isinstance(value, tuple):
        if fact.kind is Kind.BUSES:
            return flat("PerBus", **{bus: bus in value for bus in BUSES})
        return flat("Span", at=value[0], bytes=value[1]) if fact.kind is Kind.SPAN else Rows(value)
    if isinstance(value, int) and fact.kind in (Kind.OCTET, Kind.CODE):
        return Raw(mask(value, 8 if fact.kind is Kind.OCTET else -(-width // 4) * 4))
    return value
