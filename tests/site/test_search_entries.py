"""Entries of the search and of the sidebar, with nodes that include others."""

from __future__ import annotations

import json

import pytest

from icdgen import backends
from icdgen.backends.html import guide, llms, search, sidebar
from icdgen.backends.html.guide import GuidePage, GuideSection
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.loading import load
from icdgen.render import Renderer
from tests.conformance.icds import LINKS

BASE = """\
icdgen: 1
node: {name: base, title: Base, summary: Of all, byte_order: little, bit_order: lsb0}
messages:
  - {name: Reset, id: 0, kind: telecommand, length: 0, aliases: [Restart]}
  - {name: Heat, group: Power, id: 31, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Level, type: uint, unit: C}]}
"""
USER = """\
icdgen: 1
node:
  name: user
  title: User <1>
  byte_order: little
  bit_order: lsb0
  source: {document: Manual, version: "7", section: "2"}
include: [base.yaml]
protocol: {log_mask: {bytes: 1, frame_bytes: 2}}
enums: [{name: Mode, aliases: [Phase], summary: Of work, members: [{value: 0, name: Idle, summary: Rests}]}]
messages:
  - {name: Stop, id: 1, kind: telecommand, length: 0}
  - {name: Power, group: Power, id: 32, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Level, type: uint}, {at: 8, bits: 8, name: Mode, type: enum, enum: Mode}]}
loggable: [{bit: 0, id: 32}]
"""
ERRATA = """\
errata: 1
node: user
notes:
  - {id: USE-001, title: Unclear, where: {message: Stop}, tables: [3, 4], what: Not stated., evidence: E., confidence: certain}
"""


@pytest.fixture
def relations(tmp_path, monkeypatch):
    (tmp_path / "errata").mkdir()
    files = {"base.yaml": BASE, "user.yaml": USER, "errata/user.yaml": ERRATA}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    result = load([tmp_path])
    assert result.ok, [finding.message for finding in result.findings]
    sections = [
        GuideSection("Scales", "scales", 1, "Of fields"),
        GuideSection("Tables", "tables", 2, "Of points"),
    ]
    pages = (
        GuidePage("README", "", [GuideSection("Manual", "manual", 1), *sections[1:]]),
        GuidePage("guides/scales", "", sections, ("linear",)),
    )
    monkeypatch.setattr(guide, "pages", lambda: pages)
    return Relations(result.icd)


def test_the_index_has_each_object_once_in_order(relations):
    rows = [(each.kind, each.title, each.url) for each in search.entries(relations)]
    assert [row for row in rows if row[0] != "protocol"] == [
        ("node", "Base", "base/index.html"),
        ("node", "User <1>", "user/index.html"),
        ("unit", "C", "units.html#unit-c"),
        ("message", "Reset", "base/reset.html"),
        ("message", "Heat", "base/heat.html"),
        ("field", "Level", "base/heat.html#field-level"),
        ("message", "Stop", "user/stop.html"),
        ("message", "Power", "user/power.html"),
        ("field", "Level", "user/power.html#field-level"),
        ("field", "Mode", "user/power.html#field-mode"),
        ("enumeration", "Mode", "user/enum-mode.html"),
        ("member", "Idle", "user/enum-mode.html#member-idle"),
        ("note", "USE-001 Unclear", "errata.html#USE-001"),
        ("guide", "Manual", "icdgen-docs/index.html"),
        ("guide", "Scales", "icdgen-docs/guides/scales.html"),
        ("guide", "Tables", "icdgen-docs/guides/scales.html#tables"),
    ]
    # Only the node with a protocol has its entries.
    protocol_urls = {
        url.partition("#")[0] for kind, _, url in rows if kind == "protocol"
    }
    assert protocol_urls <= {"user/index.html", "user/protocol.html"}
    assert ("protocol", "Log mask", "user/index.html#log-mask") in rows


def test_entries_have_the_words_by_which_people_look_for_them(relations):
    entries = {(each.kind, each.title): each for each in search.entries(relations)}
    assert entries["node", "Base"][2:6] == ("Of all", "base", "", ("base",))
    unit = entries["unit", "C"]
    assert unit.phrases == ("C", "c")
    assert unit.about.startswith("unit c")
    reset = entries["message", "Reset"]
    # A message is also found by the nodes that include it.
    assert reset.about.split()[:2] == ["base", "user"]
    assert (reset.context, reset.aliases) == (
        "telecommand 0 (0x00) · Base",
        ("Restart",),
    )
    assert entries["message", "Power"].about.split() == ["user", "Power"]
    note = entries["note", "USE-001 Unclear"]
    assert (note.context, note.about) == ("User <1>", "table 3 table 4 Not stated.")
    assert note.phrases == ("USE-001",)
    enum, member = entries["enumeration", "Mode"], entries["member", "Idle"]
    assert (enum.about, enum.aliases) == ("enum user Of work", ("Phase",))
    assert (member.context, member.about) == ("Mode = 0 · User <1>", "user mode Rests")
    guides = [each for each in entries.values() if each.kind == "guide"]
    assert [(each.context, each.aliases) for each in guides] == [
        ("guide", ()),
        ("guide", ("linear",)),
        ("guide · Scales", ()),
    ]


def test_members_that_are_reasons_of_a_refusal_are_found_as_error_codes(monkeypatch):
    monkeypatch.setattr(guide, "pages", tuple)
    relations = Relations(load([LINKS / "battery.yaml"]).icd)
    phrases = {
        each.title: each.phrases
        for each in search.entries(relations)
        if each.kind == "member" and each.context.startswith("Error = ")
    }
    assert phrases["None"] == ("error 0", "error code 0")
    assert phrases["Checksum"] == ("error 4", "error code 4")


def test_the_sidebar_lists_own_groups_then_those_of_included_nodes(relations):
    base, user = relations.icd.nodes
    groups = {
        group.title: (group.links, group.all)
        for group in sidebar._groups(relations, user)
    }
    assert list(groups.items()) == [
        ("Other messages", ([PageLink("Stop", "stop.html")], "index.html#messages")),
        ("Power", ([PageLink("Power", "power.html")], "index.html#messages")),
        (
            "Enumerations",
            ([PageLink("Mode", "enum-mode.html")], "index.html#enumerations"),
        ),
        (
            "Base",
            (
                [
                    PageLink("Reset", "../base/reset.html"),
                    PageLink("Heat", "../base/heat.html"),
                ],
                "../base/index.html",
            ),
        ),
    ]
    assert [group.title for group in sidebar._groups(relations, base)] == [
        "Other messages",
        "Power",
    ]
    assert sidebar.contents(user) == "user/contents.js"
    text = sidebar.script(relations, user)
    start = '"use strict";\nglobalThis.icdgenContents = '
    assert text.startswith(start) and text.endswith(";\n")
    assert json.loads(text.removeprefix(start).removesuffix(";\n"))[3] == [
        ["Reset", "../base/reset.html"],
        ["Heat", "../base/heat.html"],
    ]


def test_only_the_group_of_a_page_is_unfolded_with_the_page_marked(relations):
    user = relations.icd.node("user")
    of_page = sidebar.of_node(
        relations, user, Renderer.of_backend(backends.get("html"))
    )
    message, enum, other = (
        str(of_page(f"user/{name}.html")) for name in ("power", "enum-mode", "protocol")
    )
    assert message.count('<a aria-current="page" href="power.html">Power</a>') == 1
    assert message.count("aria-current") == enum.count("aria-current") == 1
    assert "stop.html" not in message and "enum-mode.html" not in message
    assert '<a aria-current="page" href="enum-mode.html">' in enum
    assert "power.html" not in enum
    assert message.count("<details open") == enum.count("<details open") == 1
    assert "<details open" not in other and message.count("<details") == 4
    assert "contents.js" in message and "User &lt;1&gt;" in message
    # A folded group has only the link to the page that lists it.
    assert other.count("All on one page") == other.partition("<details")[2].count(
        "<li><a"
    )


def test_a_language_model_gets_summary_manual_and_included_nodes(relations):
    lines = llms.text(relations, compared=False).splitlines()
    assert lines[:3] == [
        "# Interface control documents",
        "",
        r"> Base, User \<1\>: telecommands, telemetry and enumerations, bit by bit.",
    ]
    base, user = lines.index("## Base"), lines.index(r"## User \<1\>")
    assert lines[base : base + 6] == [
        "## Base",
        "",
        "Of all",
        "",
        "- [Overview](base/index.html)",
        "- [Reset](base/reset.html): telecommand 0, 0 bytes.",
    ]
    assert lines[user + 2 : user + 5] == [
        "Manual 7, section 2.",
        "",
        "- [Overview](user/index.html)",
    ]
    assert lines[-5:] == [
        "## Further",
        "",
        "- [Errata](errata.html)",
        "- [Units and types](units.html)",
        "- [Everything as JSON](icd.json)",
    ]
    assert llms._line("a\n b\\`*_[]<>" + "x" * 400).startswith(r"a b\\\`\*\_\[\]\<\>x")
    assert llms._line("x" * 401) == "x" * 399 + "…"
