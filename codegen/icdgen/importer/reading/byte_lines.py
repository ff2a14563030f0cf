"""Tables from lines that describe bytes, such as ``Byte0~Byte1: voltage, 10 mV``.

Some documents print frames in this way instead of as a table.
"""

from __future__ import annotations

import itertools
import re

from icdgen.importer.document import (
    Block,
    Document,
    SourceCell,
    SourceRow,
    SourceTable,
    TextBlock,
)

_LINE = re.compile(
    r"(?P<where>(?:bytes?|octets?)\s*\[?[0-9]+[^:=]{0,12}?)\s*[:=]\s*(?P<what>\S.*)\Z",
    re.I,
)


def make_tables(document: Document) -> None:
    """Replace each run of such lines by a table with the headings `Byte` and `Name`."""
    result: list[Block] = []
    for is_line, run in itertools.groupby(
        document.blocks,
        lambda b: isinstance(b, TextBlock) and bool(_LINE.match(b.text)),
    ):
        blocks = list(run)
        lines = (
            [block for block in blocks if isinstance(block, TextBlock)]
            if is_line
            else []
        )
        result += [_table(lines)] if lines else blocks
    document.blocks = result


def _table(lines: list[TextBlock]) -> SourceTable:
    rows = [
        SourceRow(
            [SourceCell("Byte"), SourceCell("Name")], lines[0].page, lines[0].line
        )
    ]
    for block in lines:
        match = _LINE.match(block.text)
        assert match is not None
        # `Byte0~Byte1` becomes `0-1`.
        positions = re.sub(r"[^0-9]+", "-", match["where"]).strip("-")
        rows.append(
            SourceRow(
                [SourceCell(positions), SourceCell(match["what"])],
                block.page,
                block.line,
            )
        )
    return SourceTable(rows=rows)
