"""Scripts and texts of the site with all objects: search, sidebar, `llms.txt`, facts."""

from __future__ import annotations

import json

import pytest

from icdgen.backends.html import llms, search, sidebar
from icdgen.backends.html.all_facts import (
    FactRow,
    _field_text,
    _packet_text,
    as_text,
    title_of,
    value_text,
)
from icdgen.backends.html.all_facts import _row_of_entry as row_of_entry
from icdgen.backends.html.relations import Relations
from icdgen.protocol.declared import FactKind, ProtocolFact
from tests.icd.files import loaded

ICD = """\
enums:
  - name: Op_Mode [x]
    identifier: Mode
    source: {table: 7}
    members:
      - {value: 1, to: 3, name: Idle}
messages:
  - {name: Set Mode, group: Setup, set_id: 10, get_id: 200, kind: configuration,
     length: 1, summary: "Sets *it*", fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: "Op_Mode [x]"}]}
  - {name: Reset, id: 3, kind: telecommand, length: 0, source: {table: 9}}
  - {name: Temperatures, identifier: Temp, group: Setup, id: 3, kind: telemetry,
     length: 2, fields: [
      {at: 0, bits: 16, name: Board Temp, identifier: Board, type: int, unit: mV,
       summary: Of the board, aliases: [heat]}]}
"""


@pytest.fixture
def relations(tmp_path):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    return Relations(result.icd)


def test_the_language_model_text_lists_each_message_and_enumeration(relations):
    lines = llms.text(relations, compared=True).splitlines()
    start = lines.index("## Demo")
    assert lines[start : start + 8] == [
        "## Demo",
        "",
        "- [Overview](demo/index.html)",
        "- [Set Mode](demo/set_mode.html): configuration 10/200, 1 byte. Sets \\*it\\*",
        "- [Reset](demo/reset.html): telecommand 3, 0 bytes.",
        "- [Temperatures](demo/temp.html): telemetry 3, 2 bytes.",
        "- [Op\\_Mode \\[x\\]](demo/enum-mode.html): enumeration",
        "",
    ]
    assert [line for line in lines if "What changed" in line]
    assert "What changed" not in llms.text(relations, compared=False)


def test_the_sidebar_groups_messages_and_lists_enumerations_last(relations):
    (node,) = relations.icd.nodes
    text = sidebar.script(relations, node)
    data = text.split("globalThis.icdgenContents = ")[1].removesuffix(";\n")
    names = [[name for name, _ in group] for group in json.loads(data)]
    assert names == [["Set Mode", "Temperatures"], ["Reset"], ["Op_Mode [x]"]]
    titles = [group.title for group in sidebar._groups(relations, node)]
    assert titles == ["Setup", "Other messages", "Enumerations"]
    assert sidebar._within("demo/reset.html", node) == "reset.html"
    assert sidebar._within("radio/reset.html", node) == "../radio/reset.html"


def entry(relations, kind, title):
    (match,) = (
        each
        for each in search.entries(relations)
        if (each.kind, each.title) == (kind, title)
    )
    return match


def test_messages_are_found_by_each_notation_of_their_ids(relations):
    reset = entry(relations, "message", "Reset")
    assert reset.phrases == ("3", "0x03", "03h", "id 3", "telecommand 3", "table 9")
    assert reset.context == "telecommand 3 (0x03) · Demo"
    mode = entry(relations, "message", "Set Mode")
    assert mode.context == "configuration 10 (0x0A)/200 (0xC8) · Demo"
    assert {"0xc8", "id 200", "set 10", "get 200", "telemetry 200"} <= {*mode.phrases}
    assert "telecommand 10" in mode.phrases and "telecommand 200" not in mode.phrases


def test_entries_have_the_words_of_identifiers_that_differ_from_names(relations):
    field = entry(relations, "field", "Board Temp")
    assert field.context == "Temperatures · Demo" and field.own == "board"
    assert field.about.startswith("demo temp mV ")
    assert field.about.endswith(" Of the board") and field.aliases == ("heat",)
    assert entry(relations, "message", "Temperatures").own == "temp"
    assert entry(relations, "message", "Set Mode").own == ""
    enum = entry(relations, "enumeration", "Op_Mode [x]")
    assert (enum.own, enum.phrases) == ("mode", ("table 7",))
    member = entry(relations, "member", "Idle")
    assert member.context == "Op_Mode [x] = 1 to 3 · Demo"
    assert member.phrases == ()  # it is no error code


def test_texts_of_the_index_are_clipped_but_links_are_not(relations, monkeypatch):
    long = "x" * 301
    values = ("field", long, "", "", "y" * 300, ("a", "b"), "u" * 400, ("heat",))
    rows = [search.SearchEntry(*values)]
    monkeypatch.setattr(search, "entries", lambda relations: rows)
    text = search.script(relations)
    (row,) = json.loads(text.split("= ")[1].removesuffix(";\n"))
    clipped = f"{'x' * 299}…"
    assert row == ["field", clipped, "", "", "y" * 300, "a|b", "u" * 400, "heat"]


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        (FactKind.TIME, 1500, "1,500 ms"),
        (FactKind.OCTET, 5, "0x05"),
        (FactKind.CODE, 0x1021, "0x1021"),
        (FactKind.NUMBER, 12000, "12,000"),
        (FactKind.FLAG, False, "no"),
        (FactKind.SPAN, (3, 2), "bytes 3 to 4"),
        (FactKind.SPAN, None, ""),
        (FactKind.BUSES, ("uart", "can"), "uart, can"),
    ],
)
def test_a_fact_is_shown_as_its_kind(kind, value, text):
    assert value_text(ProtocolFact("rate", kind, "rate", "rate"), value) == text


def test_content_of_the_protocol_section_is_shown_in_words():
    assert as_text({"a": [1, True], "assumptions": 5, "b": None}) == "a 1, yes, b "
    row = {"role": "constant", "value": 119, "bits": 8}
    named = {"role": "reason", "name": "Status", "bits": 8, "enum": "Result"}
    assert _field_text(row) == "constant 119 of 8 bits"
    assert _field_text(named) == "Status of 8 bits (Result)"
    packet = {"sent_from": "device", "summary": "-", "header": [row, named]}
    assert _packet_text(packet) == (
        "sent from device; header: constant 119 of 8 bits, Status of 8 bits (Result)"
    )
    assert row_of_entry({"name": "Erase", "id": 4}) == FactRow("Erase", "id 4")
    assert title_of("link.buses.can") == "can"
    assert title_of("log_mask.index") == "log mask: index"
