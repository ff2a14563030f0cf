"""Loading any modified ICD or overlay gives findings and never an exception."""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen import reports
from icdgen.loading import load

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0, node_type: 10}
vocabulary: [CubeSense]
units:
  - {symbol: ticks, identifier: ticks, quantity: time}
protocol:
  link:
    ids:
      direction_bit: 7
      telecommand: {direction: 0, first: 0, last: 127}
      telemetry: {direction: 1, first: 128, last: 255}
    buses:
      i2c: {write: {address_8bit: 0xAE, address_7bit: 0x57, binary: "0b1010 1110"}, read: {address_8bit: 0xAF}}
    checksums:
      crc: {kind: crc, width: 16, polynomial: 0x1021, init: 0, reflect_in: false, reflect_out: false, xor_out: 0, check: 0x31C3}
    packets:
      command:
        from: host
        buses: [i2c]
        trailer: [{bits: 16, role: checksum, checksum: crc, covers: {from: id, to: data}, optional: true}]
  log_mask: {bytes: 10, frame_bytes: 4, set_by: [Set Mode]}
enums:
  - name: Mode
    members:
      - {value: 0, name: Idle}
      - {value: 1, name: Run, identifier: Running}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 4
    source: {table: 7}
    listed: {length: 4}
    fields:
      - {at: 0, bits: 12, name: Angle, type: int, unit: deg, formula: raw*0.01, min: -10.5, below: 10}
      - {at: 12, bits: 4, name: Mode, type: enum, enum: Mode}
      - {at: 16, bits: 8, name: Parts, type: uint, const: 5}
      - {at: 24, bits: 8, name: Token, type: bytes}
  - name: All
    id: 131
    kind: telemetry
    length: 4
    contains: [{message: Status, at: 0}]
    fields:
      - {at: 0, bits: 12, name: Angle, type: int, unit: deg, formula: raw*0.01}
      - {at: 12, bits: 4, name: Mode, type: enum, enum: Mode}
      - {at: 16, bits: 8, name: Parts, type: uint, special: [{value: 0, meaning: none}]}
      - {at: 24, bits: 8, name: Token, type: bytes}
  - name: Set Mode
    set_id: 2
    get_id: 132
    kind: configuration
    length: 1
    fields:
      - {at: 0, bits: 8, name: Halves, type: uint, bitfields: [{at: 0, bits: 4, name: Low}, {at: 4, bits: 4, name: High, unit: s}]}
loggable:
  - {bit: 0, id: 130, name: Status}
missing:
  - {kind: telemetry, id: 186, name: Torque, why: The manual only names it.}
"""
OVERLAY = """\
errata: 1
node: demo
entries:
  - id: DEMO-001
    title: Angle
    where: [{message: Status, field: Angle}, {message: All, fields: [Angle, Mode]}, {enum: Mode, member: 1}]
    tables: [7]
    printed: {at: 0}
    held: {at: 0, summary: Of the sun.}
    accept: [ICD024]
    why: It is printed wrongly.
    evidence: Table 7.
    confidence: likely
  - id: DEMO-002
    title: Everywhere
    where: {message: "*", field: "*"}
    places: 2
    printed: {enum: Mode}
    held: {enum: Mode, bits: 4}
    why: It is printed wrongly.
    evidence: Table 7.
    confidence: open
notes:
  - id: DEMO-003
    title: Addresses
    where: [{section: protocol.link.buses.i2c.write}, {section: messages.0}, {loggable: 0}]
    printed: {id: 130}
    what: Nothing is known.
    evidence: Table 7.
"""
PIECES = st.sampled_from(
    [
        *(
            "0",
            "-1",
            "7",
            "65536",
            "99999999999999999999999",
            "1.5",
            "true",
            "null",
            "text",
            "Status",
            "Mode",
            "ICD024",
        ),
        *("''", '"*"', "[]", "{}", "[[1]]", "{a: 1}", "[text]", "{name: x}"),
        *(
            "",
            "\n",
            " ",
            "  ",
            ":",
            "- ",
            ", ",
            "}",
            "{",
            "]",
            "[",
            "'",
            '"',
            "#",
            "\t",
            "\x00",
            "é",
            "?",
        ),
    ]
)
WORDS = st.sampled_from(
    sorted({w.strip("{}[],:\"'") for w in (ICD + OVERLAY).split()} - {""})
)


@st.composite
def spoilt(draw, text: str) -> str:
    """Draw the text with up to three stretches replaced."""
    for _ in range(draw(st.integers(1, 3))):
        words = [
            i
            for i in range(1, len(text))
            if text[i - 1] in " {[," and text[i] not in " \n"
        ]
        start = (
            draw(st.sampled_from(words))
            if words and draw(st.booleans())
            else draw(st.integers(0, len(text)))
        )
        end = start
        while end < len(text) and text[end] not in ",}]\n":
            end += 1
        if draw(st.integers(0, 3)) == 0:
            end = min(len(text), start + draw(st.integers(0, 30)))
        text = text[:start] + draw(PIECES | WORDS) + text[end:]
    return text


def findings_of(icd: str, overlay: str) -> list:
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder)
        (top / "errata").mkdir()
        (top / "demo.yaml").write_text(icd, encoding="utf-8")
        (top / "errata" / "demo.yaml").write_text(overlay, encoding="utf-8")
        loaded = load([top])
    for form in reports.FORMATS:
        assert reports.get(form)(loaded.findings, loaded.texts) or not loaded.findings
    return loaded.findings


def test_the_unmodified_icd_and_overlay_have_few_findings():
    assert {f.code for f in findings_of(ICD, OVERLAY)} == {"ICD080", "ICD084"}


def paths(tree: object, path: tuple = ()) -> Iterator[tuple]:
    """Yield the path to every value of a tree."""
    items: Iterable[tuple] = ()
    if isinstance(tree, dict):
        items = tree.items()
    elif isinstance(tree, list):
        items = enumerate(tree)
    for key, value in items:
        yield (*path, key)
        yield from paths(value, (*path, key))


def replaced(tree: object, path: tuple, value: object) -> str:
    """Return the tree with one value replaced, as JSON, which is valid YAML."""
    tree = owner = copy.deepcopy(tree)
    for step in path[:-1]:
        owner = owner[step]
    owner[path[-1]] = value
    return json.dumps(tree)


@pytest.mark.parametrize("value", [{}, [], -1], ids=["mapping", "list", "number"])
def test_an_icd_with_any_value_replaced_gives_findings(value):
    icd, overlay = yaml.safe_load(ICD), yaml.safe_load(OVERLAY)
    for path in paths(icd):
        assert isinstance(findings_of(replaced(icd, path, value), OVERLAY), list)
    for path in paths(overlay):
        assert isinstance(findings_of(ICD, replaced(overlay, path, value)), list)


@settings(max_examples=150, deadline=None)
@given(spoilt(ICD))
def test_a_damaged_icd_gives_findings(icd):
    assert isinstance(findings_of(icd, OVERLAY), list)


@settings(max_examples=150, deadline=None)
@given(spoilt(OVERLAY))
def test_a_damaged_overlay_gives_findings(overlay):
    assert isinstance(findings_of(ICD, overlay), list)
