"""Tables as files: written by `icdgen import FILE --tables DIR`, corrected by hand,
read by `icdgen import DIR`.

One YAML file a table, ``012.table.yaml``, so that a correction is one line of a diff. A
row is a list of cells: texts, or mappings with a text and its spans. An entry ``{page:
4}`` among the rows says that the rows below it stand on that page.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings
from icdgen.icd import schema, source
from icdgen.icd.located import Map
from icdgen.importer.document import (
    Document,
    PageBox,
    SourceCell,
    SourceRow,
    SourceTable,
)
from icdgen.importer.source_tables import name_of
from icdgen.importer.words import table_name, table_number

SUFFIX = ".table.yaml"
CODE = "IMP006"


def is_folder_of_tables(path: Path) -> bool:
    """Return whether the path is a folder that contains table files."""
    return path.is_dir() and next(path.glob(f"*{SUFFIX}"), None) is not None


def write_tables(
    tables: list[SourceTable], folder: Path, document: Document
) -> list[Path]:
    """Write a file for each table and return the paths.

    Raises `UserError` if one cannot be written.

    Table files in the folder that no table has any more are removed: a folder holds one
    document.
    """
    from icdgen.errors import UserError
    from icdgen.generation.write import replace

    same: dict[tuple[str, ...], list[int]] = {}
    for table in tables:
        same.setdefault(table.kind, []).append(table.number)
    digits = max(3, len(str(len(tables))))
    paths = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for table in tables:
            path = folder / f"{table.number:0{digits}}{SUFFIX}"
            replace(path, text_of(table, document, same[table.kind]).encode("utf-8"))
            paths.append(path)
        for old in set(folder.glob(f"*{SUFFIX}")) - set(paths):
            old.unlink()
    except OSError as error:
        raise UserError(
            f"cannot write {folder}: {error.strerror}",
            "choose another folder with --tables",
        ) from None
    return paths


def text_of(table: SourceTable, document: Document, same: list[int]) -> str:
    """Return the text of a table file; ``same`` are the numbers of the tables with the
    same headings.
    """
    numbers = [str(number) for number in same if number != table.number]
    shown = ", ".join(numbers[:8]) + (" ..." if len(numbers) > 8 else "")
    lines = [f"# {name_of(table)}".replace("\n", " ").rstrip()]
    lines += [f"# same headings as table {shown}"] if numbers else []
    lines += [f"table: {table.number}", f"document: {_quoted(document.file)}"]
    lines += [f"title: {_quoted(document.title)}"] if document.title else []
    lines += [f"sheet: {_quoted(table.sheet)}"] if table.sheet else []
    lines += (
        [f"label: {_quoted(table_name(table.label))}"]
        if table.label is not None
        else []
    )
    lines += [f"caption: {_quoted(table.caption)}"] if table.caption else []
    for key, texts in (
        ("headings", table.headings),
        ("before", table.before),
        ("after", table.after),
    ):
        lines += (
            [f"{key}:", *(f"  - {_quoted(text)}" for text in texts)] if texts else []
        )
    if table.boxes:
        lines.append("boxes:  # page, then left, top, right and bottom in points")
        lines += [
            f"  - [{', '.join(f'{value:g}' for value in box)}]" for box in table.boxes
        ]
    lines.append("rows:")
    page, line = table.page, None
    for row in table.rows:
        if row.page is not None and row.page != page:
            lines.append(f"  - {{page: {row.page}}}")
            page = row.page
        if row.line is not None and row.line != line:
            lines.append(f"  - {{line: {row.line}}}")
        line = row.line + 1 if row.line is not None else None
        lines.append(f"  - [{', '.join(_cell(cell) for cell in row.cells)}]")
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _cell(cell: SourceCell) -> str:
    spans = [
        f"{key}: {n}"
        for key, n in (("columns", cell.columns), ("rows", cell.rows))
        if n > 1
    ]
    return (
        f"{{text: {_quoted(cell.text)}, {', '.join(spans)}}}"
        if spans
        else _quoted(cell.text)
    )


def read_tables(folder: Path) -> list[SourceTable]:
    """Return the tables of a folder in the order of their numbers.

    Raises `Findings` for files that are no tables.
    """
    findings: list[Finding] = []
    tables: dict[int, SourceTable] = {}
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        try:
            tree = source.read(path)
        except Findings as error:
            findings += [finding._replace(code=CODE) for finding in error.findings]
            continue
        wrong, _ = schema.check(tree, "source_table")
        wrong += [] if wrong else _wrong_spans(tree)
        findings += [finding._replace(code=CODE) for finding in wrong]
        if wrong:
            continue
        if tree["table"] in tables:
            help = "give each table a number of its own"
            findings.append(
                Finding(
                    CODE,
                    f"two files have the number {tree['table']}",
                    tree.at("table"),
                    help,
                )
            )
        tables[tree["table"]] = _table(tree)
    if findings:
        raise Findings(findings)
    return [tables[number] for number in sorted(tables)]


def _wrong_spans(tree: Map) -> list[Finding]:
    """Cells that another cell covers in part, or that span rows below the last one."""
    table = _table(tree)
    covered = Counter(id(slot.cell) for slots in table.grid() for slot in slots)
    places = [
        tree["rows"].item_at(index)
        for index, row in enumerate(tree["rows"])
        if isinstance(row, list)
    ]
    wrong = []
    for row, place in zip(table.rows, places, strict=True):
        for cell in row.cells:
            if covered[id(cell)] < cell.columns * cell.rows:
                message = f"the cell `{cell.text[:40]}` lies below another cell, or spans more rows than there are"
                wrong.append(
                    Finding(
                        CODE,
                        message,
                        place,
                        "correct `rows:` and `columns:` of the cells here and below",
                    )
                )
    return wrong


def _table(tree: Map) -> SourceTable:
    boxes = [
        PageBox(int(box[0]), *(float(value) for value in box[1:]))
        for box in tree.get("boxes", ())
    ]
    page: int | None = boxes[0].page if boxes else None
    line: int | None = None
    rows: list[SourceRow] = []
    for entry in tree["rows"]:
        if isinstance(entry, Map):
            page, line = entry.get("page", page), entry.get("line", line)
            continue
        rows.append(SourceRow([_cell_of(cell) for cell in entry], page, line))
        line = line + 1 if line is not None else None
    label = table_number(tree["label"]) if "label" in tree else None
    return SourceTable(
        tree["table"],
        rows,
        tree.get("caption", ""),
        label,
        list(tree.get("headings", ())),
        list(tree.get("before", ())),
        list(tree.get("after", ())),
        boxes,
        tree.get("sheet", ""),
    )


def _cell_of(value: Any) -> SourceCell:
    if isinstance(value, Map):
        return SourceCell(value["text"], value.get("columns", 1), value.get("rows", 1))
    return SourceCell(value)


def document_of(folder: Path) -> Document:
    """Return the document that the tables of a folder come from, without its text.

    Raises `Findings`.
    """
    first = source.read(min(folder.glob(f"*{SUFFIX}")))
    return Document(
        str(first.get("document", folder.name)), title=str(first.get("title", ""))
    )
