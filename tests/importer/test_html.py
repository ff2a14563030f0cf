"""Report of an import as a web page: its parts, their order, links and escapes."""

from __future__ import annotations

import re

import pytest

from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer import html
from icdgen.importer.document import PageBox, SourceTable
from icdgen.importer.model import UNKNOWN
from tests.importer.results import result_of
from tests.importer.rules.small import table


def numbered(number: int, *rows: str, **keys) -> SourceTable:
    result = table(*rows, **keys)
    result.number = number
    return result


def finding(severity: str, message: str, order: int | None, **keys) -> ImportFinding:
    line = keys.pop("line", None)
    spot = SourcePlace(line=line, order=order)
    return ImportFinding("IMP010", message, spot, severity=severity, **keys)


def body(page: str) -> str:
    """Return the page without its head and its style."""
    return page.split("<body>\n")[1]


def test_the_complete_page_of_a_small_import():
    first = numbered(1, "a<b>2|c", "dv2", caption="Q & A")
    second = numbered(2, "x|y")
    findings = [
        finding("error", "no <role>", 0, line=3, help="give & take"),
        finding("note", "drops", 1, line=9),
        finding("warning", "of the document", None),
        finding("warning", "unusual", 0),
    ]
    result = result_of(
        (second, "list"), (first, "message"), findings=findings, file="a&b.txt"
    )
    page = html.report(result)
    assert "<title>Import of a&amp;b.txt</title>" in page.split("<body>")[0]
    error = (
        '<li class="error"><b>error</b> IMP010 (line 3){}: no &lt;role&gt;'
        " <i>give &amp; take.</i></li>"
    )
    link = ' <a href="#table-0">table</a>'
    plain_error = error.format("")
    warning = '<li class="warning"><b>warning</b> IMP010: unusual</li>'
    assert body(page) == "\n".join(
        [
            "<h1>Import of a&amp;b.txt</h1>",
            "<p>2 tables: 1 message, 1 list</p>",
            "<p>read: 1 certain, 1 doubtful</p>",
            "<p>findings: 1 error, 2 warnings, 1 note</p>",
            "<h2>To do first: what is missing from the ICD, or may be wrong in it</h2>",
            f"<ul>{error.format(link)}</ul>",
            "<h2>About the document</h2>",
            '<ul><li class="warning"><b>warning</b> IMP010: of the document</li></ul>',
            '<h2 id="table-0">Table 1 (`Q &amp; A`) '
            '<span class="sure">message, doubtful</span></h2>',
            f"<ul>{warning}",
            f"{plain_error}</ul>",
            '<div><table><tr><td colspan="2">a&lt;b</td><td>c</td></tr>',
            '<tr><td rowspan="2">d</td></tr></table></div>',
            "<h2>Notes about tables that were read without doubt</h2>",
            '<ul><li class="note"><b>note</b> IMP010 (line 9): drops</li></ul>',
            "</body></html>",
            "",
        ]
    )


def test_a_page_without_findings_has_no_further_headings():
    page = html.report(result_of((numbered(1, "x|y"), "message")))
    assert "<h2" not in body(page)
    assert body(page).endswith("<p>findings: none</p>\n</body></html>\n")


def test_tables_with_most_errors_then_most_warnings_come_first():
    severities = {
        1: ["warning"],
        2: ["error", "warning", "warning"],
        3: [],
        4: ["error", "error"],
        5: ["warning", "warning"],
        6: ["error"],
    }
    findings = [
        finding(severity, f"{number}", number - 1)
        for number, several in severities.items()
        for severity in several
    ]
    entries = [(numbered(n, "x|y"), UNKNOWN) for n in severities]
    page = html.report(result_of(*entries, findings=findings))
    orders = re.findall('<h2 id="table-([0-9])">', page)
    assert orders == ["3", "1", "5", "4", "0", "2"]


def test_a_finding_with_several_places_is_listed_once_at_each_table():
    also = (SourcePlace(order=0), SourcePlace(order=1), SourcePlace(order=1))
    findings = [finding("warning", "the same", 0, also=also)]
    entries = [(numbered(n, "x|y"), "message") for n in (1, 2, 3)]
    sections = body(html.report(result_of(*entries, findings=findings))).split("<h2")
    assert [section.count("the same") for section in sections] == [0, 1, 1]


@pytest.mark.parametrize(
    ("box", "margins"),
    [
        # left, below, right, above
        ((100, 200, 300, 250), (94, 524, 294, 174)),
        # The margin ends at the edges of the page.
        ((3, 10, 598, 790), (0, 0, 0, 0)), ((6, 26, 594, 774), (0, 0, 0, 0)),
        ((7, 27, 593, 773), (1, 1, 1, 1)),
        # Less than 2 points of the page remain.
        ((604, 200, 700, 250), (598, 524, 0, 174)), ((604.1, 200, 700, 250), None),
        ((100, 824, 300, 900), (94, 0, 294, 798)), ((100, 824.1, 300, 900), None),
        ((-50, 200, -4, 250), (0, 524, 598, 174)), ((-50, 200, -4.1, 250), None),
    ],
)  # fmt: skip
def test_a_picture_shows_the_table_its_margin_and_its_caption(box, margins):
    assert html._crop(PageBox(1, *box), 600, 800) == margins
