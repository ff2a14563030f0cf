"""Text form of a decoded frame."""

from __future__ import annotations

from icdgen.describe.numbers import byte_count
from icdgen.tables import Column, printable_text, render_table
from icdgen.values.find import kind_and_ids
from icdgen.values.frame import DecodedFrame, FieldValue

_COLUMNS = [
    Column("field"),
    Column("raw", right=True),
    Column("value", right=True),
    Column("unit"),
    Column("remarks"),
]


def to_text(frame: DecodedFrame, width: int | None = None) -> str:
    """Return message, bytes and a table of the fields.

    ``width`` is the width of the terminal, None for a pipe.
    """
    message = frame.message
    lines = [
        f"{frame.node.name}: {message.name} ({kind_and_ids(message, frame.form)}), {byte_count(len(frame.data))}"
    ]
    if frame.data:
        lines.append(frame.data.hex(" "))
    text = "".join(printable_text(line) + "\n" for line in lines)
    table = render_table(_COLUMNS, [_cells(row) for row in frame.rows], width)
    return (
        text
        + ("\n" + table if table else "")
        + "".join(f"\nnote: {printable_text(remark)}\n" for remark in frame.remarks)
    )


def _cells(row: FieldValue) -> tuple[str, ...]:
    unit = row.field.unit_symbol
    return row.field.name, row.raw_text, row.text, unit, "; ".join(row.remarks)
