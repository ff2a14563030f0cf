"""Report on decisions: errata, notes, assumptions, and messages that the manual does
not describe.

`decision_pages` yields each report as a page and as the rows of its CSV file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from icdgen.backends.assurance.paper import Cell, Files, ReportPage, RowGroup, lines_of
from icdgen.backends.assurance.trace import Element
from icdgen.icd.errata import section
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Icd, Node

ERRATA = (
    "id", "kind", "node", "title", "confidence", "tables", "decided in", "touches", "printed", "held", "why", "evidence",
)  # fmt: skip
ASSUMPTIONS = ("node", "part of", "key", "value", "line", "why")
MISSING = ("node", "kind", "id", "name", "why")
_OF_ERRATA = (
    "Errata are decisions about errors of the manual: the printed value, the value that replaces it, the reason, and the "
    "confidence. Notes change no value. Each names the place of the decision and the affected lines of the ICD.",
)
_OF_ASSUMPTIONS = (
    "Facts that the manual omits and the code needs, each with its reason and the line of the ICD.",
)
_OF_MISSING = (
    "Messages that the manual mentions and does not describe. No code is generated for them.",
)


def decision_pages(
    icd: Icd, elements: Sequence[Element], files: Files
) -> Iterator[tuple[ReportPage, list[list[Cell]], tuple[str, ...]]]:
    """Yield each report with content: its page, the rows of its table, and its columns."""
    errata_rows = list(errata(icd, elements, files))
    if errata_rows:
        groups = [
            RowGroup(
                [_folded(row) for row in errata_rows if row[2] == node.name], node.title
            )
            for node in icd.nodes
            if node.errata
        ]
        columns = (
            "Id",
            "Kind",
            "What",
            "Confidence",
            "Tables",
            "Decided in",
            "Touches",
            "Printed",
            "Held",
            "Evidence",
        )
        yield (
            ReportPage(
                "errata.html",
                "Errata",
                _OF_ERRATA,
                columns,
                groups,
                data=("errata.csv",),
            ),
            errata_rows,
            ERRATA,
        )
    tables = (
        (
            "assumptions",
            "Assumptions",
            _OF_ASSUMPTIONS,
            ASSUMPTIONS,
            list(assumptions(icd, files)),
        ),
        ("missing", "Not described", _OF_MISSING, MISSING, list(missing(icd))),
    )
    for name, title, says, keys, rows in tables:
        if rows:  # page and table have the same columns
            shown = tuple(map(str.capitalize, keys))
            yield (
                ReportPage(
                    f"{name}.html",
                    title,
                    says,
                    shown,
                    [RowGroup([*rows])],
                    data=(f"{name}.csv",),
                ),
                rows,
                keys,
            )


def _folded(row: list[Cell]) -> list[Cell]:
    """Return a row of the page, with the reason below the title."""
    (
        id,
        kind,
        _,
        title,
        confidence,
        tables,
        decided,
        touches,
        printed,
        corrected,
        why,
        evidence,
    ) = row
    return [
        id,
        kind,
        [*lines_of(title), *lines_of(why)],
        confidence,
        tables,
        decided,
        touches,
        printed,
        corrected,
        evidence,
    ]


def errata(icd: Icd, elements: Sequence[Element], files: Files) -> Iterator[list[Cell]]:
    """Yield a row for each erratum, in the order of the overlays."""
    # By identity: equal errata of two nodes are different decisions.
    touched: dict[int, list[str]] = {}
    for element in elements:
        for erratum in element.errata:
            touched.setdefault(id(erratum), []).append(files.line(element.source.place))
    for node in icd.nodes:
        for row in node.loggable:
            for erratum in row.errata:
                touched.setdefault(id(erratum), []).append(files.line(row.source.place))
        for erratum in node.errata:
            lines = [
                *touched.get(id(erratum), ()),
                *(files.line(place.place) for place in _sections(node, erratum)),
            ]
            yield [
                erratum.id, erratum.label, node.name, erratum.title, erratum.confidence, [f"{table}" for table in erratum.tables],
                files.line(erratum.source.place), list(dict.fromkeys(lines)), _pairs(erratum.printed), _pairs(erratum.held),
                erratum.why, erratum.evidence,
            ]  # fmt: skip


def assumptions(icd: Icd, files: Files) -> Iterator[list[Cell]]:
    """Yield a row for each assumed key of a section or message."""
    for node in icd.nodes:
        for path, owner in _parts_with_assumptions(node.source):
            for key, why in owner["assumptions"].items():
                value = owner.get(key)
                shown = "" if isinstance(value, dict | list) else _value_text(value)
                yield [
                    node.name,
                    path,
                    key,
                    shown,
                    files.line(owner["assumptions"].key_at(key)),
                    str(why),
                ]


def missing(icd: Icd) -> Iterator[list[Cell]]:
    """Yield a row for each message that the manual mentions but does not describe."""
    for node in icd.nodes:
        for entry in node.missing:
            yield [node.name, entry.kind, str(entry.id), entry.name, entry.why]


def _sections(node: Node, erratum: Erratum) -> Iterator[Map]:
    """Yield the sections of the ICD that an erratum concerns."""
    # `where` is one place or a list of places.
    where = erratum.source.get("where")
    for place in where if isinstance(where, Seq) else [where]:
        if isinstance(place, Map) and "section" in place:
            yield from section(node.source, str(place["section"]))


def _parts_with_assumptions(tree: object, path: str = "") -> Iterator[tuple[str, Map]]:
    """Yield each section or message with assumptions, with its name or path."""
    if isinstance(tree, Map):
        if isinstance(tree.get("assumptions"), Map):
            yield str(tree.get("name", path)), tree
        for key, value in tree.items():
            if key != "assumptions":
                yield from _parts_with_assumptions(value, f"{path}.{key}".lstrip("."))
    elif isinstance(tree, Seq):
        for index, value in enumerate(tree):
            yield from _parts_with_assumptions(value, f"{path}.{index}")


def _pairs(pairs: tuple[tuple[str, object], ...]) -> list[str]:
    return [f"{key}: {_value_text(value)}" for key, value in pairs]


def _value_text(value: object) -> str:
    if value is None:
        return "(absent)"
    return str(value).lower() if isinstance(value, bool) else str(value)
