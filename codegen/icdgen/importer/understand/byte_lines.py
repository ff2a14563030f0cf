"""Frames that a manual prints as lines, ``Byte0~Byte1: voltage, 10 mV``, made tables."""

from __future__ import annotations

import itertools
import re

from icdgen.importer.document import Block, Document, Header, Row, Table, Text
from icdgen.importer.understand import numbers

_LINE = re.compile(r"(?P<where>(?:bytes?|octets?)\s*\[?[0-9]+[^:=]{0,12}?)\s*[:=]\s*(?P<what>\S.*)\Z", re.I)


def tables(document: Document) -> None:
    """Puts a table in the place of each run of lines that give the bytes of a frame; one with headings where no byte is
    missing between them."""
    made: list[Block] = []
    for is_line, run in itertools.groupby(document.blocks, lambda b: isinstance(b, Text) and _line(b.text) is not None):
        blocks = list(run)
        lines = [block for block in blocks if isinstance(block, Text)] if is_line else []
        made += [_table(lines, _is_frame(lines))] if len(lines) > 1 else blocks
    document.blocks = made


def _line(text: str) -> tuple[str, str] | None:
    match = _LINE.match(text)
    return (match["where"], match["what"]) if match else None


def _is_frame(lines: list[Text]) -> bool:
    """Whether the lines give one byte after another, from the first."""
    at = 0
    for block in lines:
        where, _ = _line(block.text) or ("", "")
        single = numbers.figure(where)
        first, count = numbers.span(where) or ((single.value, 1) if single else (-1, 0))
        if first not in (at, at + 1 if at == 0 else at):
            return False
        at = first + count
    return True


def _table(lines: list[Text], is_frame: bool) -> Table:
    rows = []
    for block in lines:
        where, what = _line(block.text) or ("", "")
        rows.append(Row([re.sub(r"[^0-9]+", "-", where).strip("-"), what], block.page, block.line))
    if not is_frame:
        return Table(head=rows, page=lines[0].page, line=lines[0].line)
    header = Header("fields", ["at_bytes", "name"], ["Byte", "Name"])
    return Table(header=header, rows=rows, page=lines[0].page, line=lines[0].line)
