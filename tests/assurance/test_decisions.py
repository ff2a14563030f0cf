"""Reports on decisions: each row has the line of its own decision and of what it
affects.
"""

from __future__ import annotations

import csv
import io

import pytest

from icdgen import backends
from icdgen.render import Renderer
from tests.icd.files import loaded

DECISIONS = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link:
    buses:
      can:
        segments:
          data_bytes: 8
          packets_left_byte: 7
          fill: 0
          assumptions:
            fill: Not given.
            data_bytes: |
              Measured, because
              the manual has two values.
  log_mask: {bytes: 1, frame_bytes: 2}
messages:
  - name: Reset
    id: 1
    kind: telecommand
    length: 1
    acknowledge: false
    assumptions:
      length: No table.
      acknowledge: Not given.
    fields:
      - {at: 0, bits: 4, name: Level, type: uint, unit: m}
      - {at: 4, bits: 4, name: Kind, type: uint}
  - {name: Status, id: 2, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Mode, type: uint}]}
loggable:
  - {bit: 3, id: 2, name: Status}
missing:
  - {name: Voltage, id: 7, kind: telemetry, why: Its table is empty.}
  - {name: Stop, id: 0x10, kind: telecommand, why: Only a title.}
# errata/demo.yaml
errata: 1
node: demo
entries:
  - id: DEM-001
    title: Wrong unit
    where: {message: Reset, field: Level}
    tables: [3, 12]
    printed: {unit: m}
    held: {unit: km}
    why: Too small.
    evidence: Table 4.
    confidence: certain
  - id: DEM-002
    title: Wrong size
    where: {section: protocol.link.buses.can.segments}
    printed: {data_bytes: 8}
    held: {data_bytes: 7}
    why: Byte 7 counts.
    evidence: Figure 2.
    confidence: likely
  - id: DEM-003
    title: Wrong bit
    where: {loggable: 3}
    printed: {summary: ~}
    why: The bit is used twice.
    evidence: Table 5.
    confidence: open
"""
ROWS = {
    "assumptions.csv": [
        ("node", "part of", "key", "value", "line", "why"),
        ("demo", "protocol.link.buses.can.segments", "fill", "0", "demo.yaml:12", "Not given."),
        (
            "demo", "protocol.link.buses.can.segments", "data_bytes", "7", "demo.yaml:13",
            "Measured, because\nthe manual has two values.\n",
        ),
        ("demo", "Reset", "length", "1", "demo.yaml:24", "No table."),
        ("demo", "Reset", "acknowledge", "false", "demo.yaml:25", "Not given."),
    ],
    "missing.csv": [
        ("node", "kind", "id", "name", "why"),
        ("demo", "telemetry", "7", "Voltage", "Its table is empty."),
        ("demo", "telecommand", "16", "Stop", "Only a title."),
    ],
    "errata.csv": [
        (
            "id", "kind", "node", "title", "confidence", "tables",
            "decided in", "touches", "printed", "held", "why", "evidence",
        ),
        (
            "DEM-001", "Erratum", "demo", "Wrong unit", "certain", "3; 12",
            "errata/demo.yaml:4", "demo.yaml:27", "unit: m", "unit: km", "Too small.", "Table 4.",
        ),
        (
            "DEM-002", "Erratum", "demo", "Wrong size", "likely", "",
            "errata/demo.yaml:13", "demo.yaml:8", "data_bytes: 8", "data_bytes: 7", "Byte 7 counts.", "Figure 2.",
        ),
        (
            "DEM-003", "Erratum", "demo", "Wrong bit", "open", "",
            "errata/demo.yaml:21", "demo.yaml:31", "summary: (absent)", "", "The bit is used twice.", "Table 5.",
        ),
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, str]:
    icd = loaded(tmp_path_factory.mktemp("icd"), DECISIONS).icd
    backend = backends.get("assurance")
    rendered = backend.files(icd, Renderer.of_backend(backend))
    return {str(path): text for path, text in rendered}


@pytest.mark.parametrize("name", ROWS)
def test_each_decision_is_in_the_table_with_its_line_and_reason(files, name):
    rows = csv.reader(io.StringIO(files[name], newline=""))
    assert list(map(tuple, rows)) == ROWS[name]


@pytest.mark.parametrize("name", ROWS)
def test_the_page_of_a_table_has_the_same_lines(files, name):
    page = files[name.replace(".csv", ".html")]
    for row in ROWS[name][1:]:
        assert [cell for cell in row if ".yaml:" in cell and cell not in page] == []


def test_reports_without_content_are_left_out(tmp_path):
    icd = loaded(tmp_path, "messages: []\n").icd
    backend = backends.get("assurance")
    names = {str(path) for path, _ in backend.files(icd, Renderer.of_backend(backend))}
    assert not names & {*ROWS, *(name.replace(".csv", ".html") for name in ROWS)}
