"""Single facts of the shipped ICDs that were once captured wrongly, each with its place
in the manual.
"""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.values.text import to_text
from tests.conftest import ROOT
from tests.values.decoding import decode


@pytest.fixture(scope="module")
def icd():
    return load([ROOT / "icd"]).icd


def field(icd, node: str, message: str, name: str):
    (match,) = (
        f
        for m in icd.node(node).messages
        if m.name == message
        for f in m.fields
        if f.name == name
    )
    return match


def erratum(icd, id: str):
    (match,) = (e for node in icd.nodes for e in node.errata if e.id == id)
    return match


def test_a_position_of_16_bits_is_not_in_metres(icd):
    """Tables 149 and 166: 32.767 km do not reach the orbit."""
    frame = decode(icd, "cubeacp", "219", bytes.fromhex("e80300000000"))
    assert (
        " ".join(to_text(frame).split("\n")[5].split()) == "ECEF Position X 1000 1000"
    )
    assert field(icd, "cubeacp", "ADCS State", "ECEF Position Z").unit is None
    assert (
        field(icd, "cubeacp", "Raw GPS X", "ECEF Position X").unit.symbol == "m"
    )  # 32 bits, Table 136


@pytest.mark.parametrize("message", ["Estimation Parameters", "ADCS Configuration"])
def test_two_sampling_periods_in_a_byte_are_times_and_the_byte_is_not(icd, message):
    """Tables 192 and 200: the lower four bits are Cam1's, the upper four Cam2's."""
    fields = {
        f.name: f
        for m in icd.node("cubeacp").messages
        if m.name == message
        for f in m.fields
    }
    assert "Cam1 and Cam2 Sampling Period" not in {
        name for name, f in fields.items() if f.unit is not None
    }
    assert [
        (fields[f"Cam{n} period"].bits, fields[f"Cam{n} period"].unit.symbol)
        for n in (1, 2)
    ] == [(4, "s")] * 2


@pytest.mark.parametrize(
    ("node", "message", "name", "unit"),
    [
        ("common", "Identification", "Runtime (seconds)", "s"),  # Table 27
        ("common", "Identification", "Runtime (milliseconds)", "ms"),
        (
            "common",
            "Load File Download Block",
            "BlockLength",
            "byte",
        ),  # Table 17, section 7.2.3
        (
            "common",
            "File Information",
            "File Size",
            "byte",
        ),  # Table 43, against Table 215
        ("bootloader", "Program Information", "File Size", "byte"),  # Table 70
        ("cubeacp", "JPG Conversion Progress", "Progress Percentage", "%"),  # Table 99
        (
            "cubeacp",
            "CubeSense Configuration",
            "Nadir Max Deviation Percentage",
            "%",
        ),  # Table 189
        (
            "cubeacp",
            "Set Star Tracker Configuration",
            "Star Tracker Centroid X",
            "pixels",
        ),  # Table 188
    ],
)
def test_a_unit_in_words_is_captured(icd, node, message, name, unit):
    assert field(icd, node, message, name).unit.symbol == unit


def test_flash_sizes_are_numbers(icd):
    """Section 3.1: halves of 512 kB, each with one of seven areas."""
    boot = icd.node("common").protocol["boot"]
    internal = boot["internal_flash"]
    upload = icd.node("common").protocol["procedures"]["upload"]
    assert (
        internal["size_bytes"]
        == internal["bootloader_bytes"] + internal["application_bytes"]
        == 1 << 20
    )
    assert upload["inputs"]["data"]["most"] == internal["application_bytes"]


def test_what_is_assumed_of_boot_attempts_and_reads_on_i2c_says_so(icd):
    assumptions = facts.of(icd, icd.node("common")).assumptions
    places = {(assumption.section, assumption.key) for assumption in assumptions}
    assert ("boot", "attempts") in places  # section 3 counts the attempts in two ways
    # Section 7.2.3 names no id for the reads.
    packets = "File Download Buffer with File Contents"
    assert (f"procedures.download.blocks.missing.{packets}", "requested_on") in places


def test_only_error_flags_are_called_latched(icd):
    """Section 3 lists the SRAM enabled state next to the error flags."""
    (state,) = (
        m for m in icd.node("bootloader").messages if m.name == "Bootloader State"
    )
    assert "error flags stay set" in state.summary
    assert "BOOT-014" not in {e.id for e in icd.node("bootloader").errata}


def test_a_log_may_contain_the_time_of_the_receiver(icd):
    """Table 216: bit 43."""
    assert [
        (row.bit, row.id)
        for row in icd.node("cubeacp").loggable
        if row.name == "Raw GPS Time"
    ] == [(43, 177)]
    assert "Raw GPS Time" in erratum(icd, "ACP-197").why


def test_pages_of_a_copy_are_not_given_as_those_of_the_manual(icd):
    """The manual's contents put section 6.3 on page 40; the captured copy does not."""
    assert not [
        m.name for node in icd.nodes for m in node.messages if m.page is not None
    ]


@pytest.mark.parametrize(
    ("id", "gone", "holds"),
    [
        (
            "COM-017",
            "whether the bootloader shares",
            "whichever of its programs runs",
        ),  # sections 1 and 5.4, BOOT-004
        ("COM-052", "is also read on I2C", "241 is assumed"),  # section 7.2.3
        ("COM-081", "Neither is said", "For the I2C flag"),  # section 5.3.1
        (
            "COM-090",
            "flag and error to the last one processed",
            "Id and Processed flag belong",
        ),  # Table 39
        (
            "WHL-004",
            "Kind, length and type are unknown",
            "telemetry is taken",
        ),  # section 5.1
        ("ACP-198", "is not said", "rules of the UART"),  # section 5.2
    ],
)
def test_a_note_does_not_contradict_the_manual_or_another_note(icd, id, gone, holds):
    assert gone not in erratum(icd, id).why and holds in erratum(icd, id).why


def test_correct_statements_have_no_note(icd):
    """Table 40 and section 5.5 define the effect of an extra byte, Table 47 contains
    all set and get ids, and so on.
    """
    erratum_ids = {e.id for node in icd.nodes for e in node.errata}
    assert not erratum_ids & {
        "ACP-011",
        "COM-094",
        "COM-107",
        "ACP-158",
        "MAG-005",
        "WHL-006",
    }
