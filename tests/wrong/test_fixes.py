"""Writing the corrected lines of a report into the file removes the finding."""

from __future__ import annotations

import shutil
from contextlib import chdir
from pathlib import Path

import pytest

from icdgen.diagnostics import Finding
from icdgen.loading import load
from tests.wrong.cases import CASES, FOLDER, name

MISTAKES = {  # line with a mistake -> the corrected line
    "bits: 1, name: A, type: unit": "bits: 1, name: A, type: uint",
    "bits: 1, nmae: A, type: uint": "bits: 1, name: A, type: uint",
    "bits: 1, name: A, type: enum, enum: Mod": "bits: 1, name: A, type: enum, enum: Mode",
    "bits: 1, name: A, type: uint, unit: degC": "bits: 1, name: A, type: uint, unit: C",
    "bits: 1, name: A, type: uint, view: yes": "bits: 1, name: A, type: uint, view: true",
    "bits: 1, name: No, type: uint": 'bits: 1, name: "No", type: uint',
    'bits: "1", name: A, type: uint': "bits: 1, name: A, type: uint",
    "bits: 1, name: A, type: uint, const: 0X1": "bits: 1, name: A, type: uint, const: 0x1",
    "bits: 1, name: @home, type: uint": 'bits: 1, name: "@home", type: uint',
    "bits: 1, name: Time: of day, type: uint": 'bits: 1, name: "Time: of day", type: uint',
    "bits: 8, name: A, type: bool": "bits: 1, name: A, type: bool",
    "bits: 16, name: A, type: uint16": "bits: 16, name: A, type: uint",
}
ICD = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
enums: [{{name: Mode, members: [{{value: 0, name: Safe}}]}}]
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 2
    fields:
      - {{at: 0, {}}}
      - {{at: 8, bits: 8, name: State, type: enum, enum: Mode}}
"""


@pytest.mark.parametrize("wrong", MISTAKES)
def test_a_common_mistake_is_reported_with_the_corrected_line(wrong, tmp_path):
    path = tmp_path / "demo.yaml"
    path.write_text(ICD.format(wrong))
    corrections = [
        finding.fix for finding in load([path]).findings if finding.fix is not None
    ]
    assert corrections
    line = path.read_text().splitlines()[9]
    place, text = corrections[0]
    line = line[: place.column - 1] + text + line[place.column - 1 + place.length :]
    assert line == f"      - {{at: 0, {MISTAKES[wrong]}}}"


def _findings(case: Path) -> list[Finding]:
    with chdir(case.parent):
        return load([Path(case.name)]).findings


# By theme, since most cases have no corrected line, and only their findings tell which.
@pytest.mark.parametrize("theme", sorted({case.parent.name for case in CASES}))
def test_corrected_lines_end_their_findings(theme, tmp_path):
    folder = shutil.copytree(FOLDER / theme, tmp_path / theme)
    for case in CASES:
        if case.parent.name == theme:
            _check_corrected_lines(folder / case.name)


def _check_corrected_lines(case: Path) -> None:
    """Apply each correction alone, and check that its finding is gone."""
    before = _findings(case)
    for finding in before:
        if finding.fix is None:
            continue
        place, text = finding.fix
        path = case.parent / place.file
        original = path.read_bytes().decode()
        lines = original.splitlines(keepends=True)
        line = lines[place.line - 1]
        lines[place.line - 1] = (
            line[: place.column - 1] + text + line[place.column - 1 + place.length :]
        )
        path.write_text("".join(lines))
        after = _findings(case)
        path.write_bytes(original.encode())
        assert (finding.code, finding.message, finding.place) not in {
            (finding.code, finding.message, finding.place) for finding in after
        }, f"{name(case)}: {finding.message}"


def test_values_that_span_lines_have_no_corrected_line(tmp_path):
    """Their place is the first character, so a correction would leave the remaining
    lines.
    """
    path = tmp_path / "demo.yaml"
    path.write_text(
        ICD.format("bits: 1, name: A, type: enum, enum: Mo\n          de X")
        + "    # Mode\n"
    )
    assert [
        finding.fix for finding in load([path]).findings if finding.code == "ICD040"
    ] == [None]
