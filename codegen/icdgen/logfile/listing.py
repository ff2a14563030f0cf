"""Listing of the contents of a log or a recording, as `icdgen log` prints it.

`to_text` lists the frames that the mask of a device's log selects, with its size and
its first and last time. `recording_text` lists the messages of a recording with their
numbers. Both return text with notes about damage or errors at the end. The methods
`listing` in ``log`` call them.
"""

from __future__ import annotations

from icdgen.describe.numbers import byte_count
from icdgen.logfile.recording import Recording, Tally
from icdgen.logfile.source import LogSource, time_text
from icdgen.tables import Column, printable_text, render_table
from icdgen.wording import count

_NAMES = ("frame", "message")
_COLUMNS = [
    Column(title, right=title not in _NAMES)
    for title in ("bit", "id", "frame", "bytes", "fields")
]
_MESSAGES = [
    Column(title, right=title not in _NAMES)
    for title in ("id", "message", "times", "bytes", "fields")
]


def recording_text(recording: Recording, tally: Tally, width: int | None) -> str:
    """List the received messages with their numbers, and the errors of the recording."""
    is_telemetry = recording.direction == "telemetry"
    rows = []
    for name, message in recording.messages.items():
        if not tally.messages[name]:
            continue
        fields = recording.icd.longest_frame(message)
        rows.append(
            (
                str(message.telemetry_id if is_telemetry else message.telecommand_id),
                message.name,
                f"{tally.messages[name]:,}",
                f"{tally.sizes[name]:,}",
                str(sum(field.role != "count" for field in fields)),
            )
        )
    owner, size = recording.node.name, byte_count(recording.size)
    times = sum(tally.messages.values())
    messages = count(times, "message")
    head = f"{recording.path}: {recording.direction} of {owner}, {size}, {messages}"
    text = printable_text(head) + "\n"
    if rows:
        text += "\n" + render_table(_MESSAGES, rows, width)
    return text + "".join(f"\nnote: {note}\n" for note in tally.notes())


def to_text(source: LogSource, width: int | None) -> str:
    """List size, times, mask and frames of a log."""
    plan, entries = source.plan, source.entries
    lines = [f"{source.path}: log of {plan.node.name}, {source.size:,} bytes"]
    span = (
        f"{entries:,} entr{'y' if entries == 1 else 'ies'} of {plan.entry_bytes} bytes"
    )
    if times := source.first_and_last():
        span += f", {time_text(times[0])}"
        if entries > 1:
            span += f" to {time_text(times[1])}"
    lines += [span, f"mask {source.mask.hex(' ')}"]
    rows = []
    for slot in plan.slots:
        fields = sum(c.field is not None for c in plan.columns if c.frame == slot.name)
        id = "" if slot.id is None else str(slot.id)
        rows.append(
            (
                str(slot.bit),
                id,
                slot.name or "(not assigned)",
                str(slot.length),
                str(fields),
            )
        )
    text = "".join(printable_text(line) + "\n" for line in lines)
    text += "\n"
    text += (
        render_table(_COLUMNS, rows, width) if rows else "The mask selects no frame.\n"
    )
    return text + "".join(
        f"\nnote: {note}\n" for note in source.notes(source.integrity)
    )
