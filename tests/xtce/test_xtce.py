"""`icdgen --lang xtce`: files that keep to the standard, mean what the ICD means, and
are decoded so by another program.

`python -m tests.xtce` compares more of them.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import pytest
from space_packet_parser.xtce.validation import validate_xtce

from icdgen.loading import load
from tests.conftest import ROOT
from tests.xtce.decoding import differences
from tests.xtce.readback import SPACE, Compared, compare, write
from tests.xtce.sets import sets

OTHERS = ("devices", "links", "fine", "odd", "hostile")
SHIPPED = sorted((ROOT / "icd").glob("*.yaml"))


@pytest.fixture(scope="module")
def others(tmp_path_factory):
    found = sets(tmp_path_factory.mktemp("icds"))
    return [
        paths
        for name, paths in found.items()
        if name in OTHERS or "derived:" in paths[0].read_text("utf-8")
    ]


@pytest.fixture(scope="module")
def shipped():
    return load(SHIPPED, check=False).icd


def test_all_shipped_messages_come_back_as_they_are(tmp_path):
    found = Compared()
    compare(SHIPPED, tmp_path, found)
    assert (found.nodes, found.differences, found.notes) == (5, [], [])
    assert (
        found.messages > 171 and found.fields > 1251
    )  # those of included nodes are in each file


def test_everything_else_comes_back_but_for_what_has_a_name(others, tmp_path):
    found = Compared()
    for number, icds in enumerate(others):
        (out := tmp_path / f"{number}").mkdir()
        compare(icds, out, found)
    assert found.differences == [] and found.nodes > 25
    assert any("has no fixed size" in note for note in found.notes)
    assert any("no word for the order of its bits" in note for note in found.notes)
    assert any(
        "`Longitude` is left out: it is derived by `Lon + Lon HP`" in note
        for note in found.notes
    )


def test_files_are_those_of_the_standard(shipped, others, tmp_path):
    write(shipped, tmp_path)
    for number, icds in enumerate(others):
        (out := tmp_path / f"{number}").mkdir()
        write(load(icds, check=False).icd, out)
    for file in tmp_path.rglob("*.xml"):
        found = validate_xtce(
            file, level="schema", raise_on_error=False, print_results=False
        )
        assert found.valid, (file, [one.message for one in found.errors][:3])


def test_another_program_decodes_frames_as_the_reference_does(shipped, tmp_path):
    values = 0
    for name, file in write(shipped, tmp_path).items():
        for count, unlike in differences(
            shipped, shipped.node(name), file, frames=2, seed=1
        ):
            assert not unlike
            values += count
    assert values > 2000


def test_a_wrong_place_is_noticed_by_both(shipped, tmp_path):
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


def test_texts_of_an_icd_are_only_texts(tmp_path):
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
    aliases = [one.get("alias") for one in root.iter(f"{SPACE}Alias")]
    said = 'a "b" <c/> & {{ 7*7 }} ]]> --> é'
    assert aliases == ["<&>", said] and [
        one.text for one in root.iter(f"{SPACE}LongDescription")
    ] == [said]


def test_what_a_command_lacks_keeps_it_out_and_is_said(tmp_path):
    (tmp_path / "radio.yaml").write_text(
        "icdgen: 1\nnode: {name: radio, title: Radio, byte_order: little, bit_order: lsb0}\nmessages:\n"
        "  - {name: Write, id: 1, kind: telecommand, length: 0, fields: ["
        "{at: 0, name: Data, type: bytes, size: rest, up_to: 9}]}\n"
        "  - {name: Reset, id: 2, kind: telecommand, length: 0, hazard: It restarts.}\n"
    )
    loaded = load([tmp_path / "radio.yaml"])
    assert loaded.ok
    root = ElementTree.parse(write(loaded.icd, tmp_path)["radio"]).getroot()
    assert [one.get("name") for one in root.iter(f"{SPACE}MetaCommand")] == [
        "TelecommandFrame",
        "Reset",
    ]
    assert [one.text for one in root.iter(f"{SPACE}Note")] == [
        "telecommand `Write`: `Data`, which has no fixed size, is left out",
        "telecommand `Write` is left out",
    ]
    (hazard,) = root.iter(f"{SPACE}DefaultSignificance")
    assert hazard.attrib == {
        "consequenceLevel": "critical",
        "reasonForWarning": "It restarts.",
    }
