"""Files of the verification package.

`files` is the only entry point: it traces the ICDs, reads the measurements, and renders
all pages and tables.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__, backends
from icdgen.backends.assurance import decisions, measured
from icdgen.backends.assurance.measured import Measurement
from icdgen.backends.assurance.paper import (
    Cell,
    Files,
    ReportPage,
    RowGroup,
    csv_text,
    lines_of,
)
from icdgen.backends.assurance.trace import Element, Trace
from icdgen.backends.assurance.tracing import (
    CHANGES,
    SymbolsByLine,
    Tracing,
    language_title,
)
from icdgen.icd.model import Icd
from icdgen.render import Renderer

if TYPE_CHECKING:
    from collections.abc import Sequence

_HOME = (
    "Evidence for a review of the generated code: the origin of each line of the ICD, its generated names, and the tests that "
    "detect an error in it; decisions and assumptions; and measurements. Each part is a page to print and a table in CSV.",
    "The package is generated from the ICDs and the golden vectors with the reference codec. It shows that the vectors cover "
    "the ICD. It does not show that the ICD agrees with the manual, or the manual with the device.",
)


def files(
    icd: Icd, render: Renderer, folder: Path | None
) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield path and text of each file.

    ``folder``: folder of measurements. Raises `UserError` for a measurement of other
    ICDs or code.
    """
    measurements = (
        measured.read_measurements(
            folder, icd, lambda language: code_now(icd, language)
        )
        if folder is not None
        else []
    )
    digests = tuple((f"{node.title} ({node.name})", node.digest) for node in icd.nodes)
    of_errata = (
        erratum.source.place.file for node in icd.nodes for erratum in node.errata
    )
    # Paths in the package must not depend on the machine, so all files that it names
    # are collected first.
    read = Files(
        file for file in (*(node.file for node in icd.nodes), *of_errata) if file
    )
    # The traceability computes thousands of mutations, so it runs once for all reports.
    traced, tracing = Trace(icd), Tracing(read, SymbolsByLine(icd))
    elements = {node.name: list(traced.elements(node)) for node in icd.nodes}
    # The tables cover all nodes; each page covers one.
    every = [
        element
        for elements_of_node in elements.values()
        for element in elements_of_node
    ]
    foot = {
        "version": __version__,
        "digest": measured.icd_digest(icd),
        "lines_of": lines_of,
    }

    pages = [
        tracing.page(node, elements[node.name], (("Digest of the ICD", node.digest),))
        for node in icd.nodes
    ]
    tables = {
        "trace.csv": csv_text(tracing.columns, tracing.rows(every)),
        "changes.csv": csv_text(CHANGES, tracing.changes(every)),
    }
    for page, rows, columns in decisions.decision_pages(icd, every, tracing.files):
        pages.append(page)
        tables[page.data[0]] = csv_text(columns, rows)
    for measurement in measurements:
        pages.append(_page_of_measurement(measurement))
        tables[f"{measurement.name}.csv"] = csv_text(
            measurement.columns, measurement.rows
        )

    home = ReportPage(
        "index.html",
        "Assurance pack",
        _HOME,
        _COLUMNS,
        [RowGroup(_counts(icd, elements))],
        digests,
        (),
    )
    yield (
        PurePosixPath(home.file),
        render("index.html.j2", page=home, papers=pages, tables=list(tables), **foot),
    )
    for page in pages:
        yield PurePosixPath(page.file), render("paper.html.j2", page=page, **foot)
    for name, text in tables.items():
        yield PurePosixPath(name), text
    yield PurePosixPath("style.css"), render("style.css")


_COLUMNS = (
    "Node",
    "Messages",
    "Fields",
    "Enumerations",
    "Members",
    "Changes tried",
    "Unnoticed by the vectors",
)


def _counts(icd: Icd, elements: dict[str, list[Element]]) -> list[Sequence[Cell]]:
    """Return a row for each node, and one for all nodes."""
    rows: list[tuple[str, list[int]]] = []
    for node in icd.nodes:
        kinds = [element.kind for element in elements[node.name]]
        tried = [
            traced for element in elements[node.name] for traced in element.changes
        ]
        numbers = [
            kinds.count(kind) for kind in ("message", "field", "enumeration", "member")
        ]
        rows.append(
            (
                node.title,
                [*numbers, len(tried), sum(not change.detected for change in tried)],
            )
        )
    # The last row is the total of all nodes.
    total = [
        sum(column) for column in zip(*(numbers for _, numbers in rows), strict=True)
    ]
    return [
        [name, *(f"{number:,}" for number in numbers)]
        for name, numbers in (*rows, ("All", total))
    ]


def _page_of_measurement(measurement: Measurement) -> ReportPage:
    facts = (
        *measurement.facts,
        *(("Measured with", tool) for tool in measurement.made_by),
        *(
            (f"Digest of the generated {language_title(language)}", digest)
            for language, digest in measurement.code.items()
        ),
    )
    rows: list[Sequence[Cell]] = list(measurement.rows)
    return ReportPage(
        f"{measurement.name}.html",
        measurement.title,
        measurement.says,
        measurement.columns,
        [RowGroup(rows)],
        facts,
        (f"{measurement.name}.csv",),
    )


def code_now(icd: Icd, language: str) -> str:
    """Return the digest of the code that icdgen generates now.

    Raises `UserError` for an unknown language.
    """
    backend = backends.get(language)
    return measured.code_digest(backend.files(icd, Renderer.of_backend(backend)))
