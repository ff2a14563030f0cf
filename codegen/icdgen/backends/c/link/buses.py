"""Tables about the buses and the checksums."""

from __future__ import annotations

from icdgen.backends.c.link.facts import TYPES, FactTables
from icdgen.backends.c.link.rows import lines, row_of
from icdgen.protocol.sections import CAN_KINDS, Crc, Step

_CAN_BYTES = 8
_MOST_PACKETS = 256


class BusTables(FactTables):
    """UART, I2C, CAN and checksums; each gives the expression that leads to its table."""

    def polled(self) -> str:
        one = self.known.polled
        if one is None:
            return "NULL"
        fields = {"id": one.id, "processed": one.processed, "error": one.error, "parameter": one.parameter}
        return self.add("polled", "icd_step_t", [self.step("polled", Step(one.message, fields), braces=False)])

    def can(self) -> str:
        one = self.known.can
        form = one and one.extended
        if one is None or one.data_bytes > _CAN_BYTES or (form and self.too_wide()):
            return "NULL"
        types = (", ".join(str(t.get(kind, -1)) for kind in CAN_KINDS) for t in (one.types, one.extended_types))
        rows = [
            row_of(f"{{{one.parts[role].bits}u, {one.parts[role].shift}u}}", f"{role}: bits, shift")
            for role in ("type", "channel", "source", "destination")
        ]
        rows += [
            row_of(f"{{{next(types)}}}", "types"),
            row_of(f"{{{next(types)}}}", "types of messages of several packets"),
            row_of(self.part("can_extended", form, "can.extended"), "messages of several packets"),
        ]
        return self.part("can", one, "can", *rows)

    def too_wide(self) -> bool:
        form = self.known.can and self.known.can.extended
        assert form
        packets = -(-self.known.longest_data // form.data_bytes)
        return form.left_at >= _CAN_BYTES or form.data_bytes > form.left_at or packets > _MOST_PACKETS

    def crc(self, name: str, one: Crc) -> str:
        """The initialiser of a CRC without its braces; the table for whole bytes is one of its own."""
        table = "NULL"
        if one.width <= 16:
            entries = [f"{value:#0{2 + -(-one.width // 4)}x}u," for value in crc_table(one)]
            table = self.add(f"{name}_table[]", "uint16_t", lines(entries))
        facts = (row.partition(", /*")[0] for row in self.facts(name, one))
        return ", ".join([*facts, table])

    def checksum(self) -> str:
        one = self.known.checksum
        return self.part("checksum", one, "crc8", row_of(f"{{{self.crc('crc8', one.crc)}}}", "CRC") if one else "")

    def crc16(self) -> str:
        one = self.known.crc16
        return "NULL" if one is None else self.add("crc16", TYPES[Crc], [self.crc("crc16", one)])


def crc_table(one: Crc) -> list[int]:
    """What each byte, first bit on top, makes of a register of zeros."""
    top, mask = 1 << one.width - 1, (1 << one.width) - 1
    table = []
    for byte in range(256):
        register = 0
        for position in reversed(range(8)):
            out = bool(register & top) != bool(byte >> position & 1)
            register = register << 1 & mask ^ (one.polynomial if out else 0)
        table.append(register)
    return table
