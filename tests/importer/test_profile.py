"""Profiles: words over the built-in ones, nodes, orders, phrases and refusals."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.profile import NodeWords, phrase_pattern
from icdgen.importer.rules.language import TypeName

WORDS = profile.load()
RULES = "profile: 1\nrules:\n"
NO_RULES = "profile: 1\nrules: []\n"


@pytest.fixture
def load(tmp_path):
    def loaded(text: str, head: str = NO_RULES) -> profile.Profile:
        path = tmp_path / "rules.yaml"
        path.write_text(head + text, encoding="utf-8")
        return profile.load(path)

    return loaded


def test_own_lists_precede_the_built_in_ones_and_other_values_replace(load):
    words = load(
        "captions: [Tabelle, Table]\n"
        "reserved: [frei]\n"
        "labels: {id: [Kennung, ID]}\n"
        "node: {bit_order: msb0}\n"
    )
    built_in = WORDS.data
    assert words.data["captions"] == ["Tabelle", "Table", "Tab.", "Tbl."]
    assert words.data["reserved"] == ["frei", *built_in["reserved"]]
    assert words.data["labels"]["id"][:3] == ["Kennung", "ID", "Message ID"]
    assert words.data["labels"]["id"].count("ID") == 1
    assert words.data["labels"]["set_id"] == ["Set ID"]
    assert words.data["headings"] == built_in["headings"]
    assert words.data["node"] == {"byte_order": "little", "bit_order": "msb0"}
    assert built_in["captions"] == ["Table", "Tab.", "Tbl."]
    assert (WORDS.own, words.own["reserved"]) == ({}, ["frei"])


NODES = """\
nodes:
  - name: pump
    title: Pump
    byte_order: big
    match: [Pump, Feed Pump]
    tables: [3, 9]
    group: 2
    include: [common]
  - {name: common, byte_order: big}
"""


def test_an_entry_of_nodes_has_its_words_and_the_head_of_its_file(load):
    head = {"name": "pump", "title": "Pump", "byte_order": "big"}
    words = load(NODES)
    assert words.nodes == [
        NodeWords("pump", ["Pump", "Feed Pump"], (3, 9), 2, head, ["common"]),
        NodeWords("common", head={"name": "common", "byte_order": "big"}),
    ]
    assert WORDS.nodes == []


ONE = "{name: a, byte_order: big, bit_order: msb0}"
TWO = "{name: b, byte_order: big}"


@pytest.mark.parametrize(
    ("text", "orders", "stated"),
    [
        ("", ("little", "lsb0"), (False, False)),
        ("node: {byte_order: big}\n", ("big", "lsb0"), (True, False)),
        ("node: {bit_order: msb0}\n", ("little", "msb0"), (False, True)),
        (f"nodes: [{ONE}]\n", ("big", "msb0"), (True, True)),
        (f"node: {{bit_order: msb0}}\nnodes: [{ONE}, {TWO}]\n", ("big", "msb0"), (True, True)),
        (f"nodes: [{TWO}, {TWO}]\n", ("big", "lsb0"), (True, False)),
        # The order of a node precedes that of all nodes.
        (f"node: {{byte_order: little}}\nnodes: [{ONE}]\n", ("big", "msb0"), (True, True)),
        # All nodes have to state it.
        ("nodes: [{name: a, byte_order: little}, {name: b}]\n", ("little", "lsb0"), (False, False)),
        ("nodes: []\n", ("little", "lsb0"), (False, False)),
    ],
)  # fmt: skip
def test_orders_are_those_of_the_first_node_or_of_all(load, text, orders, stated):
    words = load(text)
    assert words.orders == orders
    keys = ("byte_order", "bit_order")
    assert tuple(words.states_order(key) for key in keys) == stated


def test_types_of_a_profile_are_found_without_blanks_and_case(load):
    words = load("types: {My  Word: {type: uint, bits: 12}, Blob: {type: bytes}}\n")
    assert words.types_of_profile == {
        "myword": TypeName("uint", 12),
        "blob": TypeName("bytes", 0),
    }
    assert WORDS.types_of_profile == {}


@pytest.mark.parametrize(
    ("name", "is_reserved"),
    [
        ("Reserved", True), ("RESERVED.", True), ("not  used", True), ("n/a", True),
        ("N/A", True), ("spare 2", True), ("Spare 3", False), ("---", True),
        ("--", False), ("pad12", True), ("the PAD", False), ("Reserved Bits", False),
        ("", False),
    ],
)  # fmt: skip
def test_reserved_names_are_words_or_patterns(load, name, is_reserved):
    words = load('reserved: ["---", "~^pad[0-9]*$", "~^spare 2"]\n')
    assert bool(words.is_reserved(name)) is is_reserved


def test_texts_of_empty_cells_have_no_case(load):
    assert load("empty: [None, N.A.]\n").empty == {"none", "n.a.", "-", "–", "—"}


@pytest.mark.parametrize(
    ("phrase", "text", "groups"),
    [
        ("Unit: {unit}", "the UNIT:  [ m/s ]", {"unit": "m/s", "bare": None}),
        ("Unit: {unit}", "unit: V, raw", {"unit": None, "bare": "V"}),
        ("in {unit}", "in encoder units.", {"unit": None, "bare": "encoder units"}),
        ("Must be {number}", "must  be 90 (0x5A)", {"number": "90 (0x5A)"}),
        ("Must be {number}", "must be 0XfF", {"number": "0XfF"}),
        ("see {table}", "see Tab. 4-12: Modes (1)", {"table": "Tab. 4-12", "title": "Modes "}),
        ("see {table}", "see Table 7.", {"table": "Table 7", "title": None}),
        ("see {title}.", "see Pump Modes. Then", {"title": "Pump Modes"}),
        ("Unit: {unit}", "Unit = V", None), ("a.b {number}", "axb 1", None),
    ],
)  # fmt: skip
def test_placeholders_of_a_phrase_are_groups(phrase, text, groups):
    match = phrase_pattern(phrase).search(text)
    assert (match.groupdict() if match else None) == groups


OWN = (
    RULES
    + """\
  - {rule: pins, what: ignore, tables: {head: Ball | Net}}
  - {rule: state, what: ignore, tables: {head: Name | Offset (bits) | Type}}
  - {rule: balls, what: ignore, tables: {head: Name | Offset (bits) | Ball}}
"""
)


def test_unknown_headings_of_a_rule_are_a_kind_of_their_own(load):
    words = load("", OWN)
    kinds = set(words.headings) - set(WORDS.headings)
    assert kinds == {"rule pins", "rule balls"}
    assert words.headings["rule pins"] == {"Ball": [("ball",)], "Net": [("net",)]}
    assert words.needs["rule pins"] == [("Ball",), ("Net",)]
    assert words.known_headings["rule pins"] == {("ball",), ("net",)}
    assert {"ball", "net"} <= words.heading_words
    assert set(words.needs) == set(words.headings)
