"""Values of the home page and of the page of a node."""

from __future__ import annotations

import pytest

from icdgen.backends.html import nodes
from icdgen.backends.html.examples import example_frames
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.loading import load
from tests.conformance.icds import LINKS
from tests.icd.files import loaded, status

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0}
messages:
  - {name: Reset, group: Setup, id: 0, kind: telecommand, length: 0}
  - {name: Raw, id: 0x1F, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: A, type: uint}]}
"""
USER = """\
icdgen: 1
node:
  name: user
  title: User
  byte_order: little
  bit_order: lsb0
  node_type: 0
  interface_version: 3
  source: {document: Manual, version: "7.2", date: "2020-11-03", section: "6.3"}
include: [base.yaml]
protocol:
  log_mask: {bytes: 1, frame_bytes: 2}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
messages:
  - {name: Scaled, group: Power, id: 255, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: Mode},
      {at: 8, bits: 8, name: Rate, type: uint, formula: raw*0.2}]}
  - {name: Limits, group: Power, set_id: 10, get_id: 200, kind: configuration, length: 1, fields: [
      {at: 0, bits: 8, name: Limit, type: uint}]}
  - {name: Words, id: 7, kind: telecommand, length: 1, fields: [
      {at: 0, bits: 8, name: Limit, type: uint}]}
loggable:
  - {bit: 3, id: 255, name: Scaled}
# errata/user.yaml
"""
ERRATA = """\
errata: 1
node: user
entries:
  - id: USE-001
    title: Wrong scale
    where: {message: Scaled, field: Rate}
    printed: {formula: raw*0.2}
    held: {formula: raw*0.5}
    why: Measured.
    evidence: Table 4.
    confidence: likely
notes:
  - id: USE-002
    title: Unclear
    where: {message: Scaled}
    what: Not stated.
    evidence: Table 5.
    confidence: certain
"""


@pytest.fixture
def relations(tmp_path):
    (tmp_path / "errata").mkdir()
    files = {"base.yaml": BASE, "user.yaml": USER, "errata/user.yaml": ERRATA}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    result = load([tmp_path])
    assert result.ok, [finding.message for finding in result.findings]
    return Relations(result.icd)


def test_the_home_page_counts_everything(relations):
    home = nodes.home(relations)
    assert home["totals"] == [
        ("2", "nodes"),
        ("5", "messages"),
        ("5", "fields"),
        ("1", "enumerations"),
        ("1", "known errata"),
        ("1", "notes"),
    ]
    assert home["confidence"] == [("certain", 0), ("likely", 1), ("open", 0)]
    assert home["documents"] == ["Manual 7.2 (2020-11-03)"]


def test_the_example_of_the_home_page_is_telemetry_with_a_scale(relations):
    home = nodes.home(relations)
    assert home["example"] == PageLink("Scaled", "user/scaled.html")


def test_the_card_of_a_node_has_its_facts_and_counts(relations):
    base, user = nodes.home(relations)["cards"]
    assert base["facts"] == []
    assert user["facts"] == [
        ("Node type", "0"),
        ("Interface version", "3"),
        ("Firmware", "7.2"),
    ]
    assert user["counts"] == [
        (1, "telecommands"),
        (1, "telemetry"),
        (1, "configuration"),
    ]
    assert (user["name"], user["title"], user["url"]) == (
        "user",
        "User",
        "user/index.html",
    )
    assert (user["includes"], base["includes"]) == (["Base"], [])
    assert (user["errata"], user["notes"]) == (1, 1)
    assert user["document"] == "Manual 7.2 (2020-11-03), section 6.3"


def test_own_messages_come_before_those_of_included_nodes(relations):
    values = nodes.values(relations, relations.icd.node("user"))
    rows = values["rows"]
    assert [(row["message"].name, row["of"]) for row in rows] == [
        ("Scaled", ""),
        ("Limits", ""),
        ("Words", ""),
        ("Reset", "Base"),
        ("Raw", "Base"),
    ]
    assert [row["anchors"] for row in rows] == [
        ["telemetry-255"],
        ["telecommand-10", "telemetry-200"],
        ["telecommand-7"],
        ["telecommand-0"],
        ["telemetry-31"],
    ]
    assert [row["bytes"] for row in rows] == [2, 1, 1, 0, 1]
    assert [row["mask"] for row in rows] == [[3], [], [], [], []]
    assert [row["errata"] for row in rows] == [2, 0, 0, 0, 0]
    assert values["kinds"] == [
        ("telecommand", "Telecommands", 2),
        ("telemetry", "Telemetry", 2),
        ("configuration", "Configuration", 1),
    ]
    assert values["groups"] == ["Power", "Setup"]
    assert values["own"] == 3
    assert [(row.bit, link) for row, link in values["loggable"]] == [
        (3, PageLink("Scaled", "user/scaled.html"))
    ]


@pytest.mark.parametrize(
    ("name", "order", "bit"), [("base", "big", "most"), ("user", "little", "least")]
)
def test_the_page_of_a_node_names_its_orders(relations, name, order, bit):
    facts = nodes.values(relations, relations.icd.node(name))["facts"]
    assert facts[-2:] == [
        ("Byte order", f"{order}-endian"),
        ("Bit numbering", f"bit 0 is the {bit} significant"),
    ]


def test_nodes_are_linked_to_those_that_use_their_messages(relations):
    base = nodes.values(relations, relations.icd.node("base"))
    user = nodes.values(relations, relations.icd.node("user"))
    assert base["speakers"] == [PageLink("User", "user/index.html")]
    assert user["speakers"] == []
    assert user["included"] == [PageLink("Base", "base/index.html")]
    assert base["included"] == []


def test_the_page_of_a_node_lists_its_enumerations_and_pages(relations):
    values = nodes.values(relations, relations.icd.node("user"))
    assert values["enums"] == [(PageLink("Mode", "user/enum-mode.html"), 1, "")]
    assert (values["printed"], values["protocol"]) == ("user/all-messages.html", True)
    assert (values["own"], values["fields_count"], values["has_hex"]) == (3, 4, True)
    assert (values["errata"], values["notes"]) == (1, 1)
    base = nodes.values(relations, relations.icd.node("base"))
    assert (base["enums"], base["protocol"]) == ([], False)


def test_wide_ids_and_lengths_of_frames_are_shown(tmp_path):
    fields = "at: 0, bits: 16, name: Words, type: uint, count: rest, up_to: 3"
    text = (
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little,"
        " bit_order: lsb0, id_bits: 16}\n"
    ) + status(fields, length=0)
    relations = Relations(loaded(tmp_path, text).icd)
    values = nodes.values(relations, relations.icd.nodes[0])
    assert values["facts"][0] == ("Ids", "16 bits")
    assert [row["bytes"] for row in values["rows"]] == ["0\u20136"]
    assert nodes.home(relations)["example"] is None
    assert nodes.home(relations)["paste_example"] == ""


def test_the_first_message_of_a_shared_id_is_the_one_of_the_log(tmp_path):
    first = "  - {name: First, id: 2, kind: telemetry, length: 1, fields: [%s]}\n"
    text = (
        "protocol:\n  log_mask: {bytes: 1, frame_bytes: 1}\nmessages:\n"
        + first % "{at: 0, bits: 8, name: Kind, type: uint, const: 1}"
        + (first % "{at: 0, bits: 8, name: Kind, type: uint}").replace("First", "Last")
        + "loggable:\n  - {bit: 0, id: 2, name: First}\n"
    )
    relations = Relations(loaded(tmp_path, text).icd)
    values = nodes.values(relations, relations.icd.nodes[0])
    assert [link.text for _, link in values["loggable"]] == ["First"]


@pytest.mark.parametrize(("length", "end"), [(80, "a"), (81, "…")])
def test_the_title_of_a_node_has_80_characters_at_most(tmp_path, length, end):
    text = (
        f"icdgen: 1\nnode: {{name: demo, title: {'a' * length}, byte_order: little,"
        " bit_order: lsb0}\nmessages: []\n"
    )
    relations = Relations(loaded(tmp_path, text).icd)
    assert nodes.brief(relations, relations.icd.nodes[0]) == {
        "name": "demo",
        "title": "a" * 79 + end,
        "url": "demo/index.html",
    }


def test_the_example_to_paste_is_the_first_frame_with_its_framing():
    relations = Relations(load([LINKS / "battery.yaml"]).icd)
    home = nodes.home(relations)
    assert home["example"].text == "Cell Voltages"
    message = relations.icd.nodes[0].messages[2]
    data = example_frames(message, relations.icd.nodes[0])[0].frame
    words = home["paste_example"].split()
    # Escape, start and id, then data and checksum, then escape and end
    assert words[:3] == ["1F", "7F", "82"] and words[-2:] == ["1F", "FF"]
    assert bytes.fromhex("".join(words[3:19])) == data and len(words) == 23
