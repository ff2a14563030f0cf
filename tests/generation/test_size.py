"""The size of the generated code depends on the declarations, not on the number of
elements of arrays.
"""

from __future__ import annotations

import pytest

from icdgen import backends
from icdgen.loading import load
from icdgen.render import Renderer

ICD = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: big, bit_order: msb0}}
structs:
  - name: Cell
    length: 10
    fields:
      - {{at: 0, bits: 12, name: Voltage, type: uint}}
      - {{at: 12, bits: 4, name: State, type: uint, const: 3}}
      - {{at: 16, bits: 16, count: 4, name: Words, type: int}}
  - name: Pack
    length: {pack}
    fields: [{{at: 0, name: Cells, struct: Cell, count: {count}}}]
messages:
  - {{name: Words, id: 1, kind: telemetry, length: {two}, fields: [{{at: 0, bits: 16, name: W, type: int, count: {count}}}]}}
  - {{name: Threes, id: 2, kind: telemetry, length: {three}, fields: [{{at: 0, bits: 24, name: T, type: int, count: {count}}}]}}
  - name: Halves
    id: 3
    kind: telecommand
    length: {half}
    fields: [{{at: 0, bits: 12, name: H, type: int, count: {count}, const: -2}}]
  - {{name: Flags, id: 4, kind: telemetry, length: {eighth}, fields: [{{at: 0, bits: 1, name: F, type: bool, count: {count}}}]}}
  - {{name: Octets, id: 7, kind: telecommand, length: {three}, fields: [{{at: 0, bits: 24, name: O, type: text, count: {count}}}]}}
  - {{name: Packs, id: 5, kind: telecommand, length: {packs}, fields: [{{at: 0, name: Packs, struct: Pack, count: {count}}}]}}
  - name: Open
    id: 6
    kind: telecommand
    length: 2
    fields:
      - {{at: 0, bits: 8, name: Number, type: uint}}
      - {{at: 8, bits: 8, name: Others, type: uint}}
      - {{at: 16, name: Cells, struct: Cell, count: Number, up_to: {count}}}
      - {{at: 16, name: Last, struct: Cell, after: Cells, count: Others, up_to: {count}}}
"""


def lines(lang: str, count: int, folder) -> dict[str, int]:
    """Return the lines of each file that is generated from messages with arrays of so
    many elements.
    """
    sizes = {
        "two": 2 * count,
        "three": 3 * count,
        "half": count * 3 // 2,
        "eighth": count // 8,
    }
    text = ICD.format(count=count, pack=10 * count, packs=10 * count * count, **sizes)
    (folder / "demo.yaml").write_text(text, encoding="utf-8")
    loaded = load([folder / "demo.yaml"])
    assert not [finding for finding in loaded.findings if finding.severity == "error"]
    files = backends.get(lang).files(loaded.icd, Renderer(lang))
    return {str(path): text.count("\n") for path, text in files if "demo" in str(path)}


@pytest.mark.parametrize("lang", ["c", "rust", "python"])
def test_an_array_takes_no_more_code_for_having_more_elements(lang, tmp_path):
    assert lines(lang, 24, tmp_path) == lines(lang, 16, tmp_path)
