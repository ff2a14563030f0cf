"""Tables about logs, packed time and the index file."""

from __future__ import annotations

from icdgen.backends.c.link.facts import FactTables
from icdgen.backends.c.link.rows import or_none, row_of
from icdgen.backends.c.text import plain

_DATE = ("year", "month", "day", "hour", "minute", "second")
_INDEX = ("type", "counter", "checksum", "size", "time", "meta")


class LogTables(FactTables):
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
        return self.part("log_mask", one, "log_mask", f"{bits},")

    def log_message(self) -> str:
        return self.part("log_message", self.known.mask and self.known.log_message, "unsolicited_log")

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
        rows = [row_of(f"{{{form.fields[n].at}u, {form.fields[n].bytes}u}}", n) for n in _INDEX]
        return self.part("index_entry", form, "index_file", *rows)
