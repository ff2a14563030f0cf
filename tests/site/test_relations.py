"""Relations of nodes, messages, enumerations, units and errata of a set of ICDs."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html.relations import (
    Contained,
    PageLink,
    Relations,
    document,
    manual,
)
from icdgen.backends.html.usage import type_names
from icdgen.backends.packages import Packages
from icdgen.describe import describe
from icdgen.loading import load
from tests.conformance.icds import LINKS
from tests.icd.files import loaded

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Run}]}
messages:
  - {name: Level, id: 5, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: Mode},
      {at: 8, bits: 8, name: Heat, type: uint, unit: C}]}
  - {name: Other, id: 5, kind: telemetry, shares_id: true, length: 1, fields: [
      {at: 0, bits: 8, name: Heat, type: uint, unit: V}]}
  - {name: Reset, id: 5, kind: telecommand, length: 0}
"""
USER = """\
icdgen: 1
node: {name: user, title: User, byte_order: little, bit_order: lsb0}
include: [base.yaml]
protocol: {log_mask: {bytes: 1, frame_bytes: 2}}
enums:
  - {name: Fault, members: [{value: 0, name: None}]}
messages:
  - name: State
    id: 6
    kind: telemetry
    length: 5
    contains: [{message: Level, at: 8}, {message: Level, at: 24}, {message: Missing, at: 0}]
    fields:
      - {at: 0, bits: 8, name: Fault, type: enum, enum: Fault}
      - {at: 8, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 16, bits: 8, name: Heat, type: uint, unit: C}
      - {at: 24, bits: 8, name: Mode 2, type: enum, enum: Mode}
      - {at: 32, bits: 8, name: Heat 2, type: uint, unit: C}
loggable: [{bit: 3, id: 5}, {bit: 0, id: 6}, {bit: 7, id: 99}]
"""
ERRATA = """\
errata: 1
node: user
notes:
  - {id: USE-001, title: Four places, what: W., evidence: E., confidence: certain, where: [
      {message: State}, {message: State, field: Heat 2}, {enum: Fault},
      {enum: Fault, member: 0}, {loggable: 3}]}
"""
STATE = PageLink("State", "user/state.html")
LEVEL = PageLink("Level", "base/level.html")


def relations_of(folder, packages: Packages | None = None) -> Relations:
    (folder / "errata").mkdir()
    files = {"base.yaml": BASE, "user.yaml": USER, "errata/user.yaml": ERRATA}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    result = load([folder], check=False)
    assert result.icd.nodes, [finding.message for finding in result.findings]
    return Relations(result.icd, packages)


def test_a_node_is_used_by_itself_and_the_nodes_that_include_it(tmp_path):
    relations = relations_of(tmp_path)
    names = {
        owner: [node.name for node in nodes]
        for owner, nodes in relations.speakers.items()
    }
    assert names == {"base": ["base", "user"], "user": ["user"]}


def test_uses_of_enumerations_and_units_are_collected_from_all_nodes(tmp_path):
    relations = relations_of(tmp_path)
    assert dict(relations.uses) == {
        ("base", "Mode"): [
            PageLink("Level: Mode", "base/level.html#field-mode"),
            PageLink("State: Mode", "user/state.html#field-mode"),
            PageLink("State: Mode 2", "user/state.html#field-mode_2"),
        ],
        ("user", "Fault"): [
            PageLink("State: Fault", "user/state.html#field-fault"),
        ],
    }
    units = {
        unit.symbol: [place.text for place in places]
        for unit, places in relations.units.values()
    }
    assert units == {
        "C": ["Level: Heat", "State: Heat", "State: Heat 2"],
        "V": ["Other: Heat"],
    }


def test_containment_is_known_from_both_sides_with_place_and_length(tmp_path):
    """A message that does not exist is ignored."""
    relations = relations_of(tmp_path)
    assert dict(relations.contains) == {
        ("user", "State"): [Contained(LEVEL, 8, 2), Contained(LEVEL, 24, 2)]
    }
    assert dict(relations.contained_in) == {
        ("base", "Level"): [Contained(STATE, 8, 5), Contained(STATE, 24, 5)]
    }


def test_errata_have_the_places_of_their_objects(tmp_path):
    (places,) = relations_of(tmp_path).places.values()
    assert places == [
        STATE,
        PageLink("State: Heat 2", "user/state.html#field-heat_2"),
        PageLink("Fault", "user/enum-fault.html"),
        PageLink("Fault: None", "user/enum-fault.html#member-none"),
        PageLink("Log mask bit 3", "user/index.html#log-mask"),
    ]


def test_the_first_message_of_a_logged_id_has_the_bit_of_the_mask(tmp_path):
    """The message can be one of an included node. Telecommands are not logged."""
    relations = relations_of(tmp_path)
    bits = {
        owner: [(node.name, row.bit) for node, row in rows]
        for owner, rows in relations.logged.items()
    }
    assert bits == {("base", "Level"): [("user", 3)], ("user", "State"): [("user", 0)]}


@pytest.mark.parametrize("prefix", ["", "mission"])
def test_only_names_in_c_have_the_prefix_of_the_project(tmp_path, prefix):
    relations = relations_of(tmp_path, Packages(c=prefix))
    (message,) = (
        message
        for message in relations.icd.node("user").messages
        if message.name == "State"
    )
    described = describe(relations.icd).message(message)
    start = "mission_" if prefix else ""
    assert type_names(described, relations.in_c(message)) == [
        ("C", f"{start}user_state_t"),
        ("Python", "State"),
        ("Rust", "State"),
    ]
    assert [id.value for id in relations.ids(message)] == [6]


def test_the_checksums_of_all_users_of_a_message_are_those_of_its_transmission():
    relations = Relations(load([LINKS / "battery.yaml"]).icd)
    (node,) = relations.icd.nodes
    wire = relations.wire(node.messages[0])
    assert [speaker.facts.node for speaker in wire.checked] == [node]
    assert wire.facts.node is node
    assert wire is not relations.wire(node.messages[0])
    assert relations.wire(node.messages[0]).facts is wire.facts


def test_an_enumeration_without_fields_has_no_uses(tmp_path):
    text = "enums: [{name: Mode, members: [{value: 0, name: Idle}]}]\n"
    relations = Relations(loaded(tmp_path, text).icd)
    assert not relations.uses and not relations.units and not relations.logged


@pytest.mark.parametrize(
    ("source", "name", "place"),
    [
        ({}, "", ""),
        ({"document": "ICD"}, "ICD", ""),
        ({"document": "ICD", "version": "7"}, "ICD 7", ""),
        ({"document": "ICD", "date": "2020-11-03"}, "ICD (2020-11-03)", ""),
        (
            {"document": "ICD", "version": "7", "date": "2020", "section": "6.3"},
            "ICD 7 (2020)",
            ", section 6.3",
        ),
        ({"document": "ICD", "section": "Annex A"}, "ICD", ", Annex A"),
    ],
)
def test_a_manual_is_named_with_version_date_and_section(source, name, place):
    node = SimpleNamespace(document=tuple(source.items()))
    assert (manual(node), document(node)) == (name, name + place)


def test_names_of_manuals_are_clipped():
    node = SimpleNamespace(document=(("document", "x" * 201), ("section", "y" * 400)))
    assert manual(node) == "x" * 199 + "…"
    assert document(node) == "x" * 199 + "…, " + "y" * 197 + "…"
