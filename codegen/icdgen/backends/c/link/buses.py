"""Tables about the buses and the checksums."""

from __future__ import annotations

from icdgen.backends.c.link.base import BUSES, Tables
from icdgen.backends.c.link.rows import boolean, lines, row_of
from icdgen.protocol.facts import Crc, Step
from icdgen.protocol.sections import CAN_KINDS

_CAN_BYTES = 8
_MOST_PACKETS = 256


class BusTables(Tables):
    """UART, I2C, CAN and checksums; each gives the expression that leads to its table."""

    def framing(self) -> str:
        one = self.known.framing
        if one is None:
            return "NULL"
        rows = [
            row_of(f"{one.escape:#04x}u", "escape"),
            row_of(f"{one.start:#04x}u", "start"),
            row_of(f"{one.end:#04x}u", "end"),
            row_of(f"{one.escaped:#04x}u", "the escape byte as data"),
            row_of(boolean(one.escapes_id), "the id is escaped"),
            row_of(boolean(one.ignores_other), "an escape byte before any other byte is skipped"),
        ]
        return self.add("framing", "icd_framing_t", rows, self.section_notes("uart.framing"))

    def acknowledge(self) -> str:
        one = self.known.acknowledge
        if one is None:
            return "NULL"
        rows = [row_of(f"{one.length}u", "length"), row_of(f"{one.id_at}u", "id"), row_of(f"{one.error_at}u", "error")]
        return self.add("acknowledge", "icd_acknowledge_t", rows, self.section_notes("uart.acknowledge"))

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
            row_of(f"{one.node_address}u", "address of the node"),
            row_of(f"{one.data_bytes}u", "bytes of a packet"),
            row_of(f"{{{next(types)}}}", "types"),
            row_of(f"{{{next(types)}}}", "types of messages of several packets"),
        ]
        if form:
            rows += [
                row_of("true, " + f"{form.data_bytes}u", "bytes of each of their packets"),
                row_of(f"{form.left_at}u, {form.left_in_last}u", "the count of packets left, and in the last one"),
                row_of(f"{form.fill:#04x}u", "fill"),
                row_of(f"{form.bytes}u", "most bytes"),
                row_of(f"{form.packet_timeout}u", "time-out"),
            ]
        else:
            rows.append(row_of("false, 0u, 0u, 0u, 0u, 0u, 0u", "no messages of several packets"))
        return self.add("can", "icd_can_form_t", rows, self.section_notes("can.extended"))

    def too_wide(self) -> bool:
        form = self.known.can and self.known.can.extended
        assert form
        packets = -(-self.known.longest_data // form.data_bytes)
        return form.left_at >= _CAN_BYTES or form.data_bytes > form.left_at or packets > _MOST_PACKETS

    def crc(self, name: str, one: Crc) -> str:
        table = "NULL"
        if 8 <= one.width <= 16:
            entries = [f"{value:#0{2 + -(-one.width // 4)}x}u," for value in _table(one)]
            self.add(f"{name}_table[]", "uint16_t", lines(entries), "")
            table = f"{name}_table"
        flags = (one.reflect_in, one.reflect_out, one.empty is not None)
        numbers = (one.polynomial, one.init, one.xor_out, one.empty or 0)
        return ", ".join([f"{one.width}u", *map(boolean, flags), *(f"{number:#x}u" for number in numbers), table])

    def checksum(self) -> str:
        one = self.known.checksum
        if one is None:
            return "NULL"
        buses = (sum(1 << BUSES.index(bus) for bus in b) for b in (one.telecommand_buses, one.telemetry_buses))
        rows = [
            row_of(f"{{{self.crc('crc8', one.crc)}}}", "CRC"),
            row_of(boolean(one.covers_id), "covers the id"),
            row_of(f"{next(buses)}u, {next(buses)}u", "buses of telecommands and of telemetry"),
            row_of(f"{one.bytes}u", "bytes"),
        ]
        return self.add("checksum", "icd_checksum_form_t", rows, self.section_notes("crc8"))

    def crc16(self) -> str:
        one = self.known.crc16
        return "NULL" if one is None else self.add("crc16", "icd_crc_form_t", [self.crc("crc16", one)])


def _table(one: Crc) -> list[int]:
    """What each byte, first bit on top, makes of a register of zeros."""
    top, mask = 1 << one.width - 1, (1 << one.width) - 1
    table = []
    for byte in range(256):
        register = byte << one.width - 8
        for _ in range(8):
            register = register << 1 & mask ^ (one.polynomial if register & top else 0)
        table.append(register)
    return table
