"""What the tables of all parts of a link share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from icdgen import codec
from icdgen.backends.c.link.rows import aligned, lines, or_none
from icdgen.backends.c.text import comment, plain
from icdgen.backends.lines import STEP
from icdgen.describe.fresh import fresh_values
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import CAN, I2C, UART, Step

BUSES = (UART, I2C, CAN)
_ROLES = frozenset(
    "type counter offset length ready error checksum ignore_hole_map destination block_size busy number bytes all size "
    "time node_type interface_version id processed parameter program".split()
)


class Table(NamedTuple):
    """A constant of the link."""

    comment: str
    type: str
    name: str
    rows: list[str]


class Tables:
    """The tables declared so far, for one node."""

    def __init__(self, known: Facts) -> None:
        self.known = known
        self.tables: list[Table] = []
        self.why = {(a.section, a.key): a.why for a in known.assumptions}
        self.told: set[str] = set()  # sections whose assumptions stand above a table

    def add(self, name: str, type: str, rows: Sequence[str], about: str = "") -> str:
        """Declares a table; the expression that leads to it."""
        array = name.endswith("]")
        self.tables.append(Table(comment([about], STEP) if about else "", type, name, aligned(rows)))
        return name.removesuffix("[]") if array else f"&{name}"

    def section_notes(self, section: str) -> str:
        """What is assumed in a section, and why."""
        self.told.add(section)
        found = [f"{key}: {why}" for (where, key), why in self.why.items() if where == section]
        return " ".join(f"Assumed {plain(text)}" for text in found)

    def other_notes(self) -> str:
        """What is assumed in sections of which no table was told, but for messages."""
        others = dict.fromkeys(where for where, _ in self.why if where not in self.told and " " not in where)
        return " ".join(filter(None, map(self.section_notes, others)))

    def step(self, name: str, step: Step, braces: bool = True) -> str:
        """The initialiser of a step; its places and its fresh frame are tables of their own."""
        message, rows = step.message, []
        fields = {field.name: field for field in message.fields}
        for role, field in step.fields.items():
            if role in _ROLES:
                one = fields[field]
                text = f"{{ICD_ROLE_{role.upper()}, {one.at}u, {one.bits}u}},"
                rows.append(f"{text} /* {plain(one.name)} */")
        stem = name.replace(".", "_")
        places = self.add(f"{stem}_places[]", "icd_place_t", rows) if rows else "NULL"
        fresh = "NULL"
        if any(field.const for field in message.fields):
            data = codec.encode(self.known.node, message, fresh_values(message))
            fresh = self.add(f"{stem}_fresh[]", "uint8_t", lines([f"{byte:#04x}u," for byte in data]))
        ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
        text = f"{ids}, {message.length}u, {len(rows)}u, {places}, {fresh}"
        return f"{{{text}}}" if braces else text
