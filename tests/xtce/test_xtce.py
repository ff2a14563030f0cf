"""Files of `icdgen --lang xtce` conform to the standard, have the meaning of the ICD,
and are decoded accordingly by another program.

`python -m tests.xtce` compares more ICDs.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import pytest
from space_packet_parser.xtce.validation import validate_xtce

from icdgen.loading import load
from tests.conftest import ROOT
from tests.xtce.decoding import differences
from tests.xtce.readback import SPACE, Comparison, compare, write
from tests.xtce.sets import sets

FURTHER_SETS = ("devices", "links", "fine", "odd", "hostile")
SHIPPED = sorted((ROOT / "icd").glob("*.yaml"))


@pytest.fixture(scope="module")
def further_icds(tmp_path_factory):
    icds_by_set = sets(tmp_path_factory.mktemp("icds"))
    return [
        paths
        for name, paths in icds_by_set.items()
        if name in FURTHER_SETS or "derived:" in paths[0].read_text("utf-8")
    ]


@pytest.fixture(scope="module")
def shipped():
    return load(SHIPPED, check=False).icd


def test_shipped_messages_are_the_same_after_export_and_import(tmp_path):
    comparison = Comparison()
    compare(SHIPPED, tmp_path, comparison)
    assert (comparison.nodes, comparison.differences, comparison.notes) == (5, [], [])
    assert (
        comparison.messages > 171 and comparison.fields > 1251
    )  # messages of included nodes are in each file


def test_further_messages_are_the_same_except_for_the_parts_in_the_notes(
    further_icds, tmp_path
):
    comparison = Comparison()
    for number, icds in enumerate(further_icds):
        (out := tmp_path / f"{number}").mkdir()
        compare(icds, out, comparison)
    assert comparison.differences == [] and comparison.nodes > 25
    assert any("has no fixed size" in note for note in comparison.notes)
    assert any("no word for the order of its bits" in note for note in comparison.notes)
    assert any(
        "`Longitude` is left out: it is derived by `Lon + Lon HP`" in note
        for note in comparison.notes
    )


def test_files_conform_to_the_schema_of_the_standard(shipped, further_icds, tmp_path):
    write(shipped, tmp_path)
    for number, icds in enumerate(further_icds):
        (out := tmp_path / f"{number}").mkdir()
        write(load(icds, check=False).icd, out)
    for file in tmp_path.rglob("*.xml"):
        result = validate_xtce(
            file, level="schema", raise_on_error=False, print_results=False
        )
        assert result.valid, (file, [error.message for error in result.errors][:3])


def test_another_program_decodes_frames_as_the_reference_does(shipped, tmp_path):
    values = 0
    for name, file in write(shipped, tmp_path).items():
        for count, unlike in differences(
            shipped, shipped.node(name), file, frames=2, seed=1
        ):
            assert not unlike
            values += count
    assert values > 2000


def test_a_wrong_byte_order_in_the_file_is_detected(shipped, tmp_path):
    file = write(shipped, tmp_path)["cubemag"]
    text = file.read_text("utf-8")
    wrong = re.sub(
        r'(?<=byteOrder=")least(?=SignificantByteFirst")', "most", text, count=1
    )
    assert wrong != text
    file.write_text(wrong, "utf-8")
    assert any(
        unlike
        for _, unlike in differences(
            shipped, shipped.node("cubemag"), file, frames=4, seed=1
        )
    )


def test_markup_in_texts_of_an_icd_is_escaped(tmp_path):
    name = 'a "b" <c/> & {{ 7*7 }} ]]> --> \\x07 é'
    field = f'{{at: 0, bits: 8, name: "{name}", identifier: f, type: uint, summary: "{name}"}}'.replace(
        '"b"', '\\"b\\"'
    )
    (tmp_path / "odd.yaml").write_text(
        "icdgen: 1\nnode: {name: odd, title: '<&>', byte_order: little, bit_order: lsb0}\nmessages:\n"
        f"  - {{name: M, id: 1, kind: telemetry, length: 1, fields: [{field}]}}\n"
    )
    loaded = load([tmp_path / "odd.yaml"], check=False)
    root = ElementTree.parse(write(loaded.icd, tmp_path)["odd"]).getroot()
    aliases = [element.get("alias") for element in root.iter(f"{SPACE}Alias")]
    printable = 'a "b" <c/> & {{ 7*7 }} ]]> --> é'
    assert aliases == ["<&>", printable] and [
        element.text for element in root.iter(f"{SPACE}LongDescription")
    ] == [printable]


def test_a_telecommand_that_xtce_cannot_represent_is_left_out_with_a_note(tmp_path):
    (tmp_path / "radio.yaml").write_text(
        "icdgen: 1\nnode: {name: radio, title: Radio, byte_order: little, bit_order: lsb0}\nmessages:\n"
        "  - {name: Write, id: 1, kind: telecommand, length: 0, fields: ["
        "{at: 0, name: Data, type: bytes, size: rest, up_to: 9}]}\n"
        "  - {name: Reset, id: 2, kind: telecommand, length: 0, hazard: It restarts.}\n"
    )
    loaded = load([tmp_path / "radio.yaml"])
    assert loaded.ok
    root = ElementTree.parse(write(loaded.icd, tmp_path)["radio"]).getroot()
    assert [element.get("name") for element in root.iter(f"{SPACE}MetaCommand")] == [
        "TelecommandFrame",
        "Reset",
    ]
    assert [element.text for element in root.iter(f"{SPACE}Note")] == [
        "telecommand `Write`: `Data`, which has no fixed size, is left out",
        "telecommand `Write` is left out",
    ]
    (hazard,) = root.iter(f"{SPACE}DefaultSignificance")
    assert hazard.attrib == {
        "consequenceLevel": "critical",
        "reasonForWarning": "It restarts.",
    }
