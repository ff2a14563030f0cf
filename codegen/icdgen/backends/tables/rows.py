"""Rows of the table of a node: one per field, with its message.

Columns are those of `HEADINGS`. Keys of a field without a column are collected in the
last one, so that an import of the table gives the same ICD.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from icdgen.icd.lines import Line, lines
from icdgen.icd.located import Map, plain
from icdgen.icd.model import Message, Node

Cell = int | str
Row = list[Cell]
HEADINGS = ["Message", "ID", "Set ID", "Get ID", "Kind", "Group", "Length", "Message description", "Byte", "Bit", "Bits", "Name",
            "Type", "Count", "Repeated group", "Counter", "Up to", "Unit", "Formula", "Min", "Max", "Enumeration", "Members",
            "Constant", "Description", "Further"]  # fmt: skip
_SHOWN = frozenset({
    "at", "bits", "name", "type", "count", "size", "up_to", "struct", "enum", "unit", "formula", "min", "max", "const",
    "summary",
})  # fmt: skip


def of_node(node: Node) -> list[Row]:
    """Return the rows of the messages that the node declares itself, in their order."""
    own = (message for message in node.messages if message.node == node.name)
    return [row for message in own for row in _rows_of_message(message)]


def _rows_of_message(message: Message) -> Iterator[Row]:
    fields = list(_cells_of_fields(message))
    own = {
        "Message": message.name, "ID": message.id, "Set ID": message.set_id, "Get ID": message.get_id, "Kind": message.kind,
        "Group": message.group, "Message description": message.summary,
        # a length that varies follows from the fields
        "Length": None if message.layout.sequence else message.length,
    }  # fmt: skip
    for cells in fields or [{}]:
        cells_of_row = own | cells
        yield [_cell(cells_of_row.get(heading)) for heading in HEADINGS]


def _cell(value: object) -> Cell:
    if value is None:
        return ""
    return int(value) if isinstance(value, int) else str(value)


def _cells_of_fields(message: Message) -> Iterator[dict[str, object]]:
    for line in lines(message.layout):
        if line.is_read_only or line.is_count:
            continue  # no bits of its own
        outer = line.levels[0]
        if not line.is_of_struct:
            yield _field_cells(line, line.at, line.name)
            continue
        group = (
            {"Repeated group": outer.node.name} | _repeat_cells(outer.node.source)
            if outer.count or "count" in outer.node.source
            else {}
        )
        name = ".".join(
            level.node.name for level in (line.levels[1:] if group else line.levels)
        )
        # Elements of a repeated struct have one row each, so that positions are
        # explicit.
        starts = line.starts(first_only=True)
        for index, at in enumerate(starts, 1):
            yield (
                _field_cells(
                    line,
                    at,
                    f"{name} {index}" if len(starts) > 1 else name,
                    is_element=True,
                )
                | group
            )


def _repeat_cells(source: Map) -> dict[str, object]:
    """Return the cells for the repetition of an array or group."""
    count = source.get("count", source.get("size", ""))
    if isinstance(count, int):
        return {"Count": count}
    return {"Counter": count, "Up to": source.get("up_to")} if count else {}


def _field_cells(
    line: Line, at: int, name: str, is_element: bool = False
) -> dict[str, object]:
    source = line.node.source
    repeats = {} if is_element else _repeat_cells(source)
    members = line.enum.members if line.enum else ()
    is_open = "Counter" in repeats and line.is_bytes
    return {
        "Byte": at // 8, "Bit": at % 8, "Bits": 8 if is_open else line.bits, "Name": name,
        "Type": f"{line.type}{line.bits}" if line.type in ("uint", "int", "float") else line.type,
        "Unit": line.unit_symbol, "Formula": line.formula, "Min": source.get("min"), "Max": source.get("max"),
        "Enumeration": line.enum.name if line.enum else "",
        "Members": "; ".join(f"{member.value}: {member.name}" for member in members),
        "Constant": line.const, "Description": line.summary, "Further": _further(source),
    } | ({} if line.is_bytes and "Count" in repeats else repeats)  # fmt: skip


def _further(source: Map) -> str:
    """Return the keys of a field without a column, as the ICD writes them."""
    texts = ((key, plain(value)) for key, value in source.items() if key not in _SHOWN)
    return "; ".join(
        f"{key}: {value if isinstance(value, str) else json.dumps(value)}"
        for key, value in texts
    )
