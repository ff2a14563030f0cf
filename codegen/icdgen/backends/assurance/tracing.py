"""Reports of the traceability: a page per node, a table of all elements, and a table of
all single changes.

Input are the elements of `trace` and the names that the backends declare; output are
rows of cells for `paper`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from icdgen import backends
from icdgen.backends.assurance.paper import Cell, Files, ReportPage, RowGroup
from icdgen.backends.assurance.trace import DetectedLines, Element
from icdgen.frozen import NamedTuple
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Icd, Message, Node

_SHOWN = (
    "id", "set_id", "get_id", "length", "node_type", "interface_version", "at", "bits", "type", "enum", "value", "unit", "formula",
    "points", "outside", "const", "min", "max", "above", "below", "byte_order", "bit_order",
)  # fmt: skip
"""Keys of values that a manual prints in a row, in display order."""
_SAYS = (
    "Each row is a line of the ICD: its row in the manual's table, its content, its names in the generated code of each "
    "language, and the golden vectors that detect a change of it, by their lines in the files of vectors.",
    "Each number, type and formula of the line was changed, one at a time: an offset by one bit and by eight, a width, an id, a "
    "length or a value by one, each number of a formula in its last digit and by a factor of ten, a type to every other possible "
    "type. Changes counts the changes, Unnoticed the changes that no vector detects. Vectors lists the vectors that detect any of "
    "them; changes.csv lists the vectors of each single change.",
    "Vectors do not cover names, units, summaries and remarks: another unit or name gives other symbols. The protocol section of a "
    "node is not traced here; it has vectors of its own.",
)
TRACE = (
    "kind", "node", "part of", "name", "row", "table", "page", "file", "line", "says", "errata", "changes", "unnoticed", "vectors",
)  # fmt: skip
CHANGES = (
    "kind",
    "node",
    "part of",
    "name",
    "key",
    "file",
    "line",
    "column",
    "says",
    "changed to",
    "vectors",
)


class Symbol(NamedTuple):
    """Generated name and its scope, for example "members of demo_estimated_roll_t"."""

    scope: str
    name: str

    def __str__(self) -> str:
        return f"{self.name} ({self.scope})"


class SymbolsByLine:
    """Names that backends declare for each line of an ICD: built-in languages and
    installed plug-ins.

    Raises `UserError` for an unusable plug-in.
    """

    def __init__(self, icd: Icd) -> None:
        self.languages = (*backends.TITLES, *backends.plug_ins())
        self._symbols: dict[str, dict[int, list[Symbol]]] = {}
        for language in self.languages:
            by_source = self._symbols[language] = {}
            for identifier in backends.get(language).identifiers(icd):
                # Names of the support layer have no line in the ICD.
                if identifier.source is not None:
                    by_source.setdefault(id(identifier.source), []).append(
                        Symbol(identifier.scope, identifier.text)
                    )

    def names_of_line(self, language: str, source: Map) -> list[Symbol]:
        """Return the names of a line in a language, without duplicates, in the order of
        the backend.
        """
        return list(dict.fromkeys(self._symbols[language].get(id(source), ())))


@dataclass(frozen=True, slots=True)
class Tracing:
    """Tables of the traceability."""

    files: Files
    symbols: SymbolsByLine

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the table of all elements, one for each language included."""
        return (
            *TRACE,
            *(language_title(language) for language in self.symbols.languages),
        )

    def rows(self, elements: Sequence[Element]) -> Iterator[list[Cell]]:
        """Yield the rows of the table of all elements."""
        for element in elements:
            place = element.source.place
            yield [
                element.kind,
                element.node.name,
                element.part_of,
                element.name,
                _optional_text(element.row),
                _optional_text(element.table),
                _optional_text(element.page),
                self.files.relative_name(place.file),
                str(place.line),
                printed_numbers(element),
                [erratum.id for erratum in element.errata],
                str(len(element.changes)),
                str(_undetected_count(element)),
                vector_lines(element.detected),
                *(
                    [
                        str(name)
                        for name in self.symbols.names_of_line(
                            language, element.model.source
                        )
                    ]
                    for language in self.symbols.languages
                ),
            ]

    def changes(self, elements: Sequence[Element]) -> Iterator[list[Cell]]:
        """Yield a row for each single change, with file, line and column of the changed
        value.
        """
        for element in elements:
            for traced in element.changes:
                change = traced.change
                place = change.source.at(change.key)
                yield [
                    change.kind,
                    element.node.name,
                    element.part_of,
                    element.name,
                    change.key,
                    self.files.relative_name(place.file),
                    str(place.line),
                    str(place.column),
                    str(change.old),
                    str(change.now),
                    vector_lines(traced.detected),
                ]

    def page(
        self,
        node: Node,
        elements: Sequence[Element],
        facts: tuple[tuple[str, str], ...],
    ) -> ReportPage:
        """Return the page of a node, grouped by message."""
        groups: list[RowGroup] = []
        for element in elements:
            if element.owner is None:
                rows: list[Sequence[Cell]] = []
                heading = (
                    element.model.title
                    if isinstance(element.model, Node)
                    else element.name
                )
                # Messages, enumerations and structs start a group; their parts follow.
                groups.append(RowGroup(rows, heading, _notes(element)))
            groups[-1].rows.append(self._shown(element))
        languages = (language_title(language) for language in self.symbols.languages)
        columns = (
            "Row",
            "Name",
            "Says",
            "Line",
            *languages,
            "Changes",
            "Unnoticed",
            "Vectors",
        )
        file = f"trace-{node.name}.html"
        return ReportPage(
            file,
            f"Trace: {node.title}",
            _SAYS,
            columns,
            groups,
            facts,
            ("trace.csv", "changes.csv"),
        )

    def _shown(self, element: Element) -> list[Cell]:
        errata = [f"{erratum.label} {erratum.id}" for erratum in element.errata]
        return [
            _optional_text(element.row),
            [element.name, *errata],
            printed_numbers(element),
            self.files.line(element.source.place),
            *(self._names(language, element) for language in self.symbols.languages),
            str(len(element.changes)) if element.changes else "",
            str(_undetected_count(element)) if element.changes else "",
            vector_lines(element.detected),
        ]

    def _names(self, language: str, element: Element) -> list[str]:
        return list(
            dict.fromkeys(
                symbol.name
                for symbol in self.symbols.names_of_line(language, element.model.source)
            )
        )


def language_title(language: str) -> str:
    """Return the name of a language; for a plug-in, its value of ``--lang``."""
    return backends.TITLES.get(language, language)


def printed_numbers(element: Element) -> str:
    """Return the printed values of the line, as in the ICD."""
    return ", ".join(
        f"{key} {element.source[key]}" for key in _SHOWN if key in element.source
    )


def _notes(element: Element) -> tuple[str, ...]:
    words = [element.model.kind if isinstance(element.model, Message) else element.kind]
    if element.table is not None:
        words.append(f"Table {element.table} of the manual")
    if element.page is not None:
        words.append(f"page {element.page}")
    return (", ".join(words),) if isinstance(element.model, Message | Enum) else ()


def _undetected_count(element: Element) -> int:
    return sum(not traced.detected for traced in element.changes)


def _optional_text(value: int | None) -> str:
    return "" if value is None else str(value)


def vector_lines(detected: DetectedLines) -> list[str]:
    """Return vector files with line numbers: ``demo.json 31-38 40``."""
    return [f"{node}.json {_ranges(numbers)}" for node, numbers in detected.items()]


def _ranges(numbers: Iterable[int]) -> str:
    """Return ascending numbers as ranges: ``31-38 40``."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " ".join(
        f"{first}-{last}" if last > first else str(first) for first, last in runs
    )
