"""The shipped ICDs are complete and clean with their errata, and the rules report them
without.
"""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path

import pytest

from icdgen.loading import load
from tests.conftest import ROOT

ICDS = ROOT / "icd"

# node: telecommands, telemetry, configuration messages, fields
COUNTS = {
    "common": (14, 15, 12, 86),
    "bootloader": (5, 3, 0, 23),
    "cubeacp": (16, 73, 26, 1121),
    "cubemag": (0, 4, 0, 17),
    "cubewheel": (0, 3, 0, 4),
}


@pytest.fixture(scope="module")
def icd():
    return load([ICDS]).icd


@pytest.fixture
def as_printed(tmp_path) -> Path:
    """Return the vendor layer without the errata."""
    for path in ICDS.glob("*.yaml"):
        shutil.copy(path, tmp_path)
    return tmp_path


def test_nothing_is_missing(icd):
    counts = {}
    for node in icd.nodes:
        kinds = Counter(message.kind for message in node.messages)
        fields = sum(len(message.fields) for message in node.messages)
        counts[node.name] = (
            kinds["telecommand"],
            kinds["telemetry"],
            kinds["configuration"],
            fields,
        )
    assert counts == COUNTS
    messages = [message for node in icd.nodes for message in node.messages]
    fields = [field for message in messages for field in message.fields]
    enums = [enum for node in icd.nodes for enum in node.enums]
    assert (len(messages), sum(len(m.ids) for m in messages)) == (171, 209)
    assert (
        len(fields),
        sum(f.scale is not None for f in fields),
        sum(f.unit is not None for f in fields),
    ) == (
        1251,
        346,
        324,
    )
    assert (len(enums), sum(len(e.members) for e in enums)) == (37, 233)
    assert len(icd.node("cubeacp").loggable) == 63
    assert [(m.kind, m.id) for m in icd.node("cubewheel").missing] == [
        ("telemetry", 186)
    ]


def test_every_erratum_has_place_reason_and_confidence(icd):
    entries = [entry for node in icd.nodes for entry in node.errata]
    assert all(entry.title and entry.why and entry.evidence for entry in entries)
    assert len({entry.id for entry in entries}) == len(entries)


def test_an_entry_without_change_and_acceptance_is_a_note(icd):
    entries = [
        entry for node in icd.nodes for entry in node.errata if not entry.is_note
    ]
    notes = [entry for node in icd.nodes for entry in node.errata if entry.is_note]
    assert all(entry.confidence for entry in entries)
    assert not [entry.id for entry in notes if entry.held or entry.changes]
    assert (len(entries), len(notes)) == (35, 325)


@pytest.mark.parametrize(
    ("code", "where", "count"),
    [
        (
            "ICD024",
            "SRAM Latchup counters",
            5,
        ),  # frames longer than what the manual describes
        ("ICD042", "meter", 27),  # units spelt in several ways
        (
            "ICD045",
            "CubeSense1 Current Measurements",
            2,
        ),  # loggable frames of 4 bytes in slots of 6
        (
            "ICD047",
            "Moment of Inertia Matrix",
            7,
        ),  # composite frames that differ from their parts
        ("ICD054", "Not Used", 1),  # two members of one name
        (
            "ICD062",
            "154 fields altogether",
            1,
        ),  # formulas announced the wrong way round
        ("ICD090", "", 2),  # an I2C address printed in three forms that disagree
    ],
)
def test_without_the_errata_the_rules_report_the_detectable_errors(
    as_printed, code, where, count
):
    findings = [
        finding for finding in load([as_printed]).findings if finding.code == code
    ]
    assert len(findings) == count
    assert any(where in finding.message for finding in findings)


def test_a_changed_manual_makes_the_erratum_stale(tmp_path):
    shutil.copytree(ICDS, tmp_path / "icd")
    path = tmp_path / "icd" / "common.yaml"
    line = next(
        line
        for line in path.read_text().splitlines()
        if "name: Interface version" in line
    )
    path.write_text(
        path.read_text().replace(line, line.replace("const: 1", "const: 2"))
    )
    (finding,) = [f for f in load([path]).findings if f.code == "ICD080"]
    assert "const: 1" in finding.message and "const: 2" in finding.message
    assert finding.place.file.endswith("errata/common.yaml")
