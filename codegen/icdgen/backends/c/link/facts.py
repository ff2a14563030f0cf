"""Declared facts of the protocol -> rows of an initialiser."""

from __future__ import annotations

from typing import Any

from icdgen.backends.c.link.base import BUSES, Tables
from icdgen.backends.c.link.rows import boolean, lines, or_none, row_of
from icdgen.backends.c.text import plain
from icdgen.protocol.declared import Fact, Kind, facts_of
from icdgen.protocol.sections import (
    Acknowledge,
    Can,
    Checksum,
    Crc,
    Download,
    Erasure,
    Extended,
    Files,
    Framing,
    HoleMap,
    Index,
    Listing,
    LogFile,
    LogMask,
    LogMessage,
    Operation,
    Settings,
    Step,
    Upload,
)

MOST_SIGNED = 0x7FFF_FFFF
TYPES: dict[type, str] = {
    Settings: "icd_client_settings_t", Framing: "icd_framing_t", Acknowledge: "icd_acknowledge_t", Crc: "icd_crc_form_t",
    Checksum: "icd_checksum_form_t", Can: "icd_can_form_t", Extended: "icd_can_extended_t", LogMask: "icd_log_mask_form_t",
    LogFile: "icd_log_file_form_t", LogMessage: "icd_log_message_form_t", Index: "icd_index_form_t",
    HoleMap: "icd_hole_map_form_t", Files: "icd_files_form_t", Listing: "icd_list_form_t", Download: "icd_download_form_t",
    Upload: "icd_upload_form_t", Erasure: "icd_erase_form_t", Operation: "icd_operation_form_t",
}  # fmt: skip


def is_told_apart(fact: Fact) -> bool:
    """Whether a member of its own says if an optional fact is known: neither -1 nor 0 can stand for unknown."""
    return fact.is_optional and fact.least == 0 and fact.holds > MOST_SIGNED


class FactTables(Tables):
    """Parts whose facts are declared; each gives the expression that leads to its table."""

    def part(self, name: str, part: object, section: str, *made: str) -> str:
        """The table of a part: its facts, then the rows that code ``made``. NULL if there is no such part."""
        if part is None:
            return "NULL"
        rows = [*self.facts(name, part), *made]
        return self.add(name, TYPES[type(part)], rows, self.section_notes(section))

    def facts(self, name: str, part: object) -> list[str]:
        """A row for each fact."""
        return [self._row(name, fact, getattr(part, fact.name)) for fact in facts_of(part)]

    def _row(self, name: str, fact: Fact, value: Any) -> str:
        if isinstance(value, Step):
            return row_of(self.step(f"{name}.{fact.name}", value), plain(value.message.name))
        if fact.kind is Kind.ALLOWED:
            return self._allowed(f"{name}_{fact.name}", fact.name, value)
        return row_of(_spelled(fact, value), f"{fact.name} in ms" if fact.kind is Kind.TIME else fact.name)

    def _allowed(self, name: str, about: str, numbers: tuple[int, ...]) -> str:
        """The numbers that can be chosen, and how many they are."""
        if not numbers:
            return row_of("NULL, 0u", about)
        table = self.add(f"{name}[]", "uint8_t", lines([f"{number}u," for number in numbers]))
        return row_of(f"{table}, {len(numbers)}u", about)


def _spelled(fact: Fact, value: Any) -> str:
    if is_told_apart(fact):
        return f"{boolean(value is not None)}, {_one(fact, value or 0)}"
    if fact.is_optional and fact.least == 0:
        return or_none(value)
    return _one(fact, value or 0)


def _one(fact: Fact, value: Any) -> str:
    if fact.kind is Kind.FLAG:
        return boolean(value)
    if fact.kind is Kind.BUSES:
        return f"{sum(1 << BUSES.index(bus) for bus in value or ())}u"
    if fact.kind is Kind.SPAN:
        return f"{{{value[0]}u, {value[1]}u}}"
    if fact.kind is Kind.OCTET:
        return f"{value:#04x}u"
    return f"{value:#x}u" if fact.kind is Kind.CODE else f"{value}u"
