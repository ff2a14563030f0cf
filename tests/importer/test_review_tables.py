"""`icdgen --lang xlsx` and `--lang csv` write tables for reviews; the shipped profile
`tables` reads the same layouts back.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import time
from pathlib import Path

import pytest

from icdgen.icd.lines import lines
from icdgen.icd.model import Node
from icdgen.importer import profile, run
from icdgen.loading import load
from tests.conftest import ROOT

openpyxl = pytest.importorskip("openpyxl", reason="pip install 'icdgen[import]'")
LANGUAGES = ("csv", "xlsx")


def generate(language: str, out: Path, *more: object) -> subprocess.CompletedProcess:
    command = [
        sys.executable,
        "-m",
        "icdgen",
        "--lang",
        language,
        "--out",
        str(out),
        *map(str, more),
    ]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT)


def layouts(node: Node) -> dict:
    """Return each message of the tables with the positions and values of its fields."""
    layouts_by_name = {}
    for message in node.messages:
        if message.node != node.name:
            continue
        fields = [
            (line.name, line.at, line.bits, line.own_count, line.type, line.unit_symbol, line.scale, line.curve and line.formula,
             line.const, line.enum and (line.enum.name, [(m.value, m.name) for m in line.enum.members]))
            for line in lines(message.layout) if not line.is_read_only and not line.is_count
        ]  # fmt: skip
        ids = message.id, message.set_id, message.get_id
        layouts_by_name[message.name] = (
            message.kind,
            ids,
            message.length,
            sorted(fields, key=lambda field: field[1]),
        )
    return layouts_by_name


def layouts_after_import(table: Path, rules: Path | None, folder: Path) -> dict:
    """Return the layouts of the ICD that an import of a table gives."""
    from icdgen.icd.fmt import emit

    result, trees = run.run(
        table, profile.load(rules or profile.find("tables")), jobs=1
    )
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    folder.mkdir()
    (name,) = trees
    (folder / f"{name}.yaml").write_text(
        emit.canonical_yaml(trees[name]), encoding="utf-8"
    )
    return layouts(load([folder / f"{name}.yaml"], check=False).icd.nodes[0])


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_shipped_icds_come_back_from_their_tables(language, tmp_path):
    assert generate(language, tmp_path / "tables", "icd").returncode == 0
    wanted = {node.name: layouts(node) for node in load([ROOT / "icd"]).icd.nodes}
    tables = {path.stem: path for path in (tmp_path / "tables").glob(f"*.{language}")}
    assert set(tables) == {name for name, messages in wanted.items() if messages}
    for name, path in tables.items():
        got = layouts_after_import(path, None, tmp_path / f"back-{name}")
        assert list(got) == list(wanted[name])
        assert {m: got[m] for m in got if got[m] != wanted[name][m]} == {}


DEVICE = """icdgen: 1
node: {name: device, title: Device, byte_order: big, bit_order: msb0}
enums:
  - {name: Modes, members: [{value: 0, name: Idle}, {value: 3, name: "Runs, slowly"}]}
structs:
  - name: Satellite
    length: 3
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 16, name: Level, type: int, unit: dB, formula: raw*0.1}
messages:
  - name: State
    id: 33
    kind: telemetry
    length: 29
    fields:
      - {at: 0, bits: 3, name: Mode, type: enum, enum: Modes}
      - {at: 8, bits: 16, name: Rates, type: uint, count: 3, formula: raw*0.5 - 40, unit: C}
      - {at: 56, bits: 64, name: Serial, type: bytes}
      - {at: 120, bits: 64, name: Time, type: float, unit: s}
      - {at: 184, struct: Satellite, name: Satellites, count: 2}
  - {name: Stop, id: 34, kind: telecommand, length: 0}
  - name: "=Check"
    set_id: 3
    get_id: 131
    kind: configuration
    length: 1
    fields: [{at: 0, bits: 8, name: Key, type: uint, const: 0x5A}]
"""


@pytest.mark.parametrize("language", LANGUAGES)
def test_arrays_structs_constants_and_messages_without_fields_come_back(
    language, tmp_path
):
    (tmp_path / "device.yaml").write_text(DEVICE, encoding="utf-8")
    run_ = generate(language, tmp_path / "tables", tmp_path / "device.yaml")
    assert run_.returncode == 0, run_.stderr
    shipped = (ROOT / "icd" / "profiles" / "tables.yaml").read_text(encoding="utf-8")
    orders = shipped.replace(
        "byte_order: little, bit_order: lsb0", "byte_order: big, bit_order: msb0"
    )
    (tmp_path / "rules.yaml").write_text(orders, encoding="utf-8")
    (node,) = load([tmp_path / "device.yaml"]).icd.nodes
    assert layouts_after_import(
        tmp_path / "tables" / f"device.{language}",
        tmp_path / "rules.yaml",
        tmp_path / "back",
    ) == layouts(node)


def test_a_workbook_has_the_same_bytes_at_any_time_so_that_check_can_compare_it(
    tmp_path,
):
    assert generate("xlsx", tmp_path, "icd/cubewheel.yaml").returncode == 0
    before = (tmp_path / "cubewheel.xlsx").read_bytes()
    time.sleep(2.1)  # times in ZIP archives have steps of two seconds
    assert generate("xlsx", tmp_path, "--check", "icd/cubewheel.yaml").returncode == 0
    assert generate("xlsx", tmp_path / "again", "icd/cubewheel.yaml").returncode == 0
    assert (tmp_path / "again" / "cubewheel.xlsx").read_bytes() == before


def test_both_formats_have_the_same_cells_and_a_text_is_no_formula(tmp_path):
    (tmp_path / "device.yaml").write_text(DEVICE, encoding="utf-8")
    for language in LANGUAGES:
        assert generate(language, tmp_path, tmp_path / "device.yaml").returncode == 0
    with open(tmp_path / "device.csv", encoding="utf-8", newline="") as file:
        table = list(csv.reader(file))
    sheet = openpyxl.load_workbook(tmp_path / "device.xlsx").active
    title, *rows = [
        ["" if cell is None else str(cell) for cell in row]
        for row in sheet.iter_rows(values_only=True)
    ]
    assert title[0] == "Device (device): big-endian, msb0"
    assert rows == table
    assert next(cell for cell in sheet["A"] if cell.value == "=Check").data_type == "s"
