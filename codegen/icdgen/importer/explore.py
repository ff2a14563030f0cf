"""What a new manual's tables look like: each kind with its headings, how often and where, and a profile proposed from them."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field

from icdgen.icd.rules.wording import count
from icdgen.importer import labels
from icdgen.importer.document import Table
from icdgen.importer.profile import Profile
from icdgen.importer.propose import Column, proposal
from icdgen.importer.run import Result
from icdgen.importer.understand import grids
from icdgen.importer.understand.model import ReadMessage
from icdgen.importer.understand.survey import UNKNOWN
from icdgen.importer.words import folded, plain, squeezed

MOST_PAGES = 8  # named for a kind
_CAPTION = re.compile(r"(?P<word>[A-Z][A-Za-z]{2,14})\s+(?P<number>[0-9]+)\s*[:.–—-]\s+\S")


_OTHERS = ("Section", "Chapter", "Figure", "Page")  # words before numbers that begin no caption of a table


@dataclass
class Kind:
    """Tables with the same headings. ``what`` is what they are taken for."""

    titles: list[str]
    what: str
    tables: list[Table] = field(default_factory=list)

    @property
    def where(self) -> str:
        """``page 3, 5 to 7``, or lines of a text."""
        name, places = "page", sorted({t.page for t in self.tables if t.page is not None})
        if not places:
            name, places = "line", sorted({t.line for t in self.tables if t.line is not None})
        shown = ", ".join(str(place) for place in places[:MOST_PAGES])
        return f"{name} {shown}" + (" ..." if len(places) > MOST_PAGES else "")

    def columns(self) -> list[Column]:
        """The columns with what stands in them, over all tables of the kind."""
        made = [Column(title) for title in self.titles]
        for table in self.tables:
            for row in _body(table):
                for column, cell in zip(made, row, strict=False):
                    column.cells.append(plain(cell))
        return made


def kinds(result: Result) -> list[Kind]:
    """The kinds of tables, the most frequent first."""
    made: dict[tuple[str, ...], Kind] = {}
    for one in result.survey.found:
        titles = _titles(one.table)
        if len([title for title in titles if title]) < 2:
            continue
        key = (one.what, *(squeezed(title) for title in titles))
        made.setdefault(key, Kind(titles, one.what)).tables.append(one.table)
    return sorted(made.values(), key=lambda k: -len(k.tables))


def _titles(table: Table) -> list[str]:
    if table.header is not None:
        return table.header.titles
    if grid := next((row for row in table.head if grids.is_heading(row)), None):
        return grid.cells
    return max(table.head[:4], key=_words, default=None).cells if table.head else []  # type: ignore[union-attr]


def _words(row: object) -> int:
    """How much a row looks like headings: cells of words without figures."""
    cells = [cell for cell in getattr(row, "cells", []) if cell]
    return sum(1 for cell in cells if not any(c.isdigit() for c in cell)) if len(cells) > 1 else 0


def _body(table: Table) -> list[list[str]]:
    rows = [row.cells for row in table.rows]
    if table.header is None:
        titles = _titles(table)
        index = next((i for i, row in enumerate(table.head) if row.cells is titles), -1)
        rows = [row.cells for row in table.head[index + 1 :]]
    return rows


def caption_words(result: Result, profile: Profile) -> list[str]:
    """Words that begin captions in this manual and not in the profile: ``Listing 3: ...``, three times or more."""
    known = {word.casefold().rstrip(".") for word in profile.data["captions"]}
    seen: Counter[str] = Counter()
    for block in result.document.blocks:
        match = _CAPTION.match(getattr(block, "text", ""))
        if match and match["word"].casefold() not in known and match["word"] not in _OTHERS:
            seen[match["word"]] += 1
    return [word for word, count in seen.items() if count >= 3]


def unknown_labels(result: Result, profile: Profile) -> Counter[str]:
    """Labels before numbers in lines and rows above tables that the profile does not know: ``Opcode 21``."""
    seen: Counter[str] = Counter()
    texts = [getattr(block, "text", "") for block in result.document.blocks]
    texts += [" ".join(row.cells) for table in result.document.tables for row in table.head[:3]]
    for text in texts:
        if not text or len(text) > 60:
            continue
        for one in labels.parse(text, profile):
            if not one.what and one.value and one.label and len(one.label.split()) <= 3 and one.label[:1].isalpha():
                seen[one.label] += 1
    return Counter({label: count for label, count in seen.items() if count >= 2})


def report(result: Result, profile: Profile) -> str:
    """The kinds of tables as comments, and below them the proposed profile: together a file for ``--profile``."""
    found = kinds(result)
    lines = [
        f"# {result.document.file}: {count(len(found), 'kind')} of tables. Lines with ? are guesses: correct them, then"
    ]
    lines += ["# icdgen import MANUAL --profile THIS-FILE --pages 1-20 --report report.html", "#"]
    for one in found:
        lines.append(f"# {count(len(one.tables), 'time')} ({one.what}), {one.where}:")
        lines.append(f"#   {' | '.join(_shown(title) for title in one.titles)}")
        if one.what == UNKNOWN and (rows := _body(one.tables[0])):
            lines.append(f"#   {' | '.join(_shown(cell) for cell in rows[0])}")
    lines += ["", "profile: 1", ""]
    unread = [one.columns() for one in found if one.what == UNKNOWN]
    partly = [one.columns() for one in found if one.what != UNKNOWN]
    kindless = sum(not message.kind for _, message in result.survey.of(ReadMessage))
    captions, labelled = caption_words(result, profile), unknown_labels(result, profile)
    lines += proposal(unread, partly, captions, labelled, kindless, profile)
    return "\n".join(line.rstrip() for line in lines).rstrip() + "\n"


def as_json(result: Result) -> str:
    """The kinds of tables for programs."""
    found = [
        {"is": one.what, "headings": one.titles, "count": len(one.tables), "pages": sorted({t.page for t in one.tables if t.page}),
         "lines": sorted({t.line for t in one.tables if t.line})}
        for one in kinds(result)
    ]  # fmt: skip
    return json.dumps({"manual": result.document.file, "kinds": found}, indent=2, ensure_ascii=False)


def _shown(cell: str) -> str:
    return " ".join(cell.split())[:30] if folded(cell) or cell else ""
