"""What a log holds, for people."""

from __future__ import annotations

from icdgen.logfile.rows import time_text
from icdgen.logfile.source import Source
from icdgen.tables import Column, clean, render

_COLUMNS = [
    Column("bit", right=True),
    Column("id", right=True),
    Column("frame"),
    Column("bytes", right=True),
    Column("fields", right=True),
]


def to_text(source: Source, width: int | None) -> str:
    """Size, time, mask and frames."""
    plan, entries = source.plan, source.entries
    lines = [f"{source.path}: log of {plan.node.name}, {source.size:,} bytes"]
    span = f"{entries:,} entr{'y' if entries == 1 else 'ies'} of {plan.entry_bytes} bytes"
    if entries:
        times = [time_text(source.time(source.entry(number))) for number in (0, entries - 1)]
        span += f", {times[0]}" + (f" to {times[1]}" if entries > 1 else "")
    lines += [span, f"mask {source.mask.hex(' ')}"]
    rows = []
    for slot in plan.slots:
        fields = sum(c.field is not None for c in plan.columns if c.frame == slot.name)
        id = "" if slot.id is None else str(slot.id)
        rows.append((str(slot.bit), id, slot.name or "(not assigned)", str(slot.length), str(fields)))
    text = "".join(clean(line) + "\n" for line in lines)
    text += "\n" + render(_COLUMNS, rows, width) if rows else "\nThe mask selects no frame.\n"
    notes = source.doubts()
    if source.truncated:
        notes.append(f"the last {source.truncated} bytes belong to no whole entry")
    return text + "".join(f"\nnote: {note}\n" for note in notes)
