"""Facts of the protocol as values of initialisers.

`fact_value` spells a declared fact (`icdgen.protocol.declared`) as the members of the
runtime's structs need it, optional facts included. `TableRow` is a line of such
an initialiser.
"""

from __future__ import annotations

from typing import Any

from icdgen.backends.lines import STEP
from icdgen.frozen import NamedTuple
from icdgen.icd.buses import BUSES
from icdgen.protocol import sections
from icdgen.protocol.declared import FactKind, ProtocolFact

MOST_SIGNED = 0x7FFF_FFFF
TYPES: dict[type, str] = {
    sections.Settings: "icd_client_settings_t", sections.Framing: "icd_framing_t",
    sections.Crc: "icd_crc_form_t",
    sections.Checksum: "icd_checksum_form_t", sections.Can: "icd_can_form_t", sections.Extended: "icd_can_extended_t",
    sections.LogMask: "icd_log_mask_form_t", sections.LogFile: "icd_log_file_form_t",
    sections.LogMessage: "icd_log_message_form_t", sections.Index: "icd_index_form_t",
}  # fmt: skip


class TableRow(NamedTuple):
    """Row of a table: a value with a comment, subject to a condition of the
    preprocessor if there is one.
    """

    value: str
    text: str = ""
    condition: str = ""

    def __str__(self) -> str:
        row = f"{self.value}, /* {self.text} */" if self.text else f"{self.value},"
        return (
            f"#if {self.condition}\n{STEP * 2}{row}\n#endif" if self.condition else row
        )


def has_presence_flag(fact: ProtocolFact) -> bool:
    """Return whether a separate member states if an optional fact is given, because
    neither -1 nor 0 can mean that it is not.
    """
    return fact.is_optional and fact.least == 0 and fact.holds > MOST_SIGNED


def boolean(value: bool) -> str:
    return "true" if value else "false"


def or_none(value: int | None) -> str:
    """Return the value, or -1 for None."""
    return "-1" if value is None else str(value)


def fact_value(fact: ProtocolFact, value: Any) -> str:
    """Return the value of a fact, after its presence flag if it `has_presence_flag`."""
    if has_presence_flag(fact):
        return f"{boolean(value is not None)}, {_fact_literal(fact, value or 0)}"
    if fact.is_optional and fact.least == 0:
        return or_none(value)
    # If the smallest value of an optional fact is above 0, a 0 means that it is not
    # given.
    return _fact_literal(fact, value or 0)


def _fact_literal(fact: ProtocolFact, value: Any) -> str:
    if fact.kind is FactKind.FLAG:
        return boolean(value)
    if fact.kind is FactKind.BUSES:
        # Buses are a mask: bit n is bus n in the order of `BUSES`.
        return f"{sum(1 << BUSES.index(bus) for bus in value or ())}u"
    if fact.kind is FactKind.SPAN:
        return f"{{{value[0]}u, {value[1]}u}}"
    if fact.kind is FactKind.OCTET:
        return f"{value:#04x}u"
    return f"{value:#x}u" if fact.kind is FactKind.CODE else f"{value}u"
