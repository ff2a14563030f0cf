"""Fixture: an ICD with every kind of field."""

from __future__ import annotations

import pytest

from icdgen.icd.model import Icd
from icdgen.loading import load

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0}
enums:
  - name: Switch
    members:
      - {value: 0, name: "Off"}
      - {value: 1, name: "On"}
      - {value: 7, name: Auto reset}
      - {value: 9, name: Auto retry}
      - {value: 0x20, to: 0x2F, name: Reserved}
messages:
  - name: Shared State
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 4,  name: Main Switch, type: enum, enum: Switch}
      - {at: 4, bits: 12, name: Level,       type: uint}
"""

TOP = """\
icdgen: 1
node: {name: top, title: Top, byte_order: little, bit_order: lsb0}
include: [base.yaml]
vocabulary: [BDot]
messages:
  - name: Set Speed
    id: 17
    kind: telecommand
    length: 6
    fields:
      - {at: 0,  bits: 16, name: Commanded X speed, type: int, unit: deg/s, formula: raw*0.01}
      - {at: 16, bits: 16, name: Commanded Y speed, type: int, unit: deg/s, formula: raw*0.01}
      - {at: 32, bits: 8,  name: Magic Number,      type: uint, const: 0x5A}
      - {at: 40, bits: 8,  name: Timeout,           type: uint, unit: s, max: 60,
         special: [{value: 0xFF, meaning: no timeout}]}
  - name: Everything
    set_id: 20
    get_id: 150
    kind: configuration
    length: 36
    fields:
      - {at: 0,   bits: 1,  name: Enabled,    type: bool}
      - {at: 1,   bits: 7,  name: Small,      type: int}
      - {at: 8,   bits: 8,  name: Mode,       type: enum, enum: Switch}
      - {at: 16,  bits: 32, name: Ratio,      type: float, unit: "%", above: 0}
      - {at: 48,  bits: 64, name: Precise,    type: float,
         special: [{value: nan, meaning: not known}, {value: -9999, meaning: no data}]}
      - {at: 112, bits: 32, name: Key = Code, type: bytes}
      - {at: 144, bits: 64, name: Wide,       type: uint}
      - {at: 208, bits: 64, name: Wide angle, type: int, unit: rad, formula: (raw - 32)*5/9}
      - {at: 272, bits: 8,  name: BDot gain,  identifier: Derivative gain, type: uint, formula: raw/3}
  - name: Everything Else
    id: 150
    kind: telecommand
    length: 0
  - name: Version
    id: 151
    kind: telemetry
    length: 12
    fields:
      - {at: 0,  bits: 80, name: Software, type: text}
      - {at: 80, bits: 16, name: Hardware, type: text}
  - name: Set Heaters
    id: 22
    kind: telecommand
    length: 9
    fields:
      - {at: 0,  bits: 16, count: 3, name: Temperatures, identifier: temps, type: int, unit: C, formula: raw*0.01, max: 80}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint}
  - name: Seen Twice
    id: 152
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8,  name: Low, type: uint}
      - {at: 8, bits: 8,  name: High, type: uint}
      - {at: 4, bits: 12, name: Most, type: int, view: true, unit: V, formula: raw*0.5}
  - name: "42"
    id: 21
    kind: telecommand
    length: 0
"""


@pytest.fixture(scope="session")
def icd(tmp_path_factory) -> Icd:
    folder = tmp_path_factory.mktemp("values")
    (folder / "base.yaml").write_text(BASE, encoding="utf-8")
    (folder / "top.yaml").write_text(TOP, encoding="utf-8")
    loaded = load([folder / "top.yaml"], check=False)
    assert loaded.findings == []
    return loaded.icd
