"""Tables about logs, packed time and the index file."""

from __future__ import annotations

from icdgen.backends.c.link.base import Tables
from icdgen.backends.c.link.rows import boolean, or_none, row_of
from icdgen.backends.c.text import plain

_DATE = ("year", "month", "day", "hour", "minute", "second")
_INDEX = ("type", "counter", "checksum", "size", "time", "meta")


class LogTables(Tables):
    """Logs, packed time, index file; each gives the expression that leads to its table."""

    def log_mask(self) -> str:
        one = self.known.mask
        if one is None:
            return "NULL"
        rows = []
        for bit in range(one.size * 8):
            row = one.bits.get(bit)
            text = f"bit {bit}" + (f": {plain(row.name)}" if row and row.name else "")
            id, length = (row.id, row.length) if row else (None, one.slot_bytes)
            rows.append(f"{{{or_none(id)}, {length}u}}, /* {text} */")
        bits = self.add("log_bits[]", "icd_log_bit_t", rows)
        parts = [
            row_of(f"{one.size}u", "bytes"),
            row_of(boolean(one.msb0), "bit 0 of a byte is the most significant one"),
            row_of(f"{one.fill:#04x}u", "fill"),
            row_of(f"{one.slot_bytes}u", "bytes of a slot"),
            bits,
        ]
        return self.add("log_mask", "icd_log_mask_form_t", parts, self.section_notes("log_mask"))

    def log_file(self) -> str:
        one = self.known.log_file
        if one is None:
            return "NULL"
        rows = [
            row_of(f"{one.mask_at}u, {one.header_bytes}u", "the mask, and the bytes of the header"),
            row_of(f"{{{one.seconds[0]}u, {one.seconds[1]}u}}", "seconds"),
            row_of(f"{{{one.milliseconds[0]}u, {one.milliseconds[1]}u}}", "milliseconds"),
            row_of(f"{one.frames_at}u", "frames"),
        ]
        return self.add("log_file", "icd_log_file_form_t", rows, self.section_notes("telemetry_log"))

    def log_message(self) -> str:
        one = self.known.log_message
        if one is None or self.known.mask is None:
            return "NULL"
        rows = [row_of(f"{one.id}u", "id"), row_of(f"{one.mask_at}u, {one.frames_at}u", "mask and frames")]
        return self.add("log_message", "icd_log_message_form_t", rows, self.section_notes("unsolicited_log"))

    def time(self) -> str:
        form = self.known.time
        if not all(name in form for name in _DATE):
            return "NULL"
        rows = []
        for name in _DATE:
            one = form[name]
            rows.append(row_of(f"{{{one.at}u, {one.bits}u, {one.factor}u, {one.offset}u}}", name))
        return self.add("packed_time", "icd_time_form_t", rows)

    def index(self) -> str:
        form = self.known.index
        if form is None or not all(name in form.fields for name in _INDEX):
            return "NULL"
        rows = [row_of(f"{form.entry_bytes}u", "bytes of an entry")]
        rows += [row_of(f"{{{form.fields[n].at}u, {form.fields[n].bytes}u}}", n) for n in _INDEX]
        return self.add("index_entry", "icd_index_form_t", rows)
