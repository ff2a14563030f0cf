"""Networks become trees with unique names, and findings have file, line and help."""

from __future__ import annotations

import pytest

from icdgen.definitions.model import (
    Definitions,
    Network,
    NotSupported,
    replace_keys,
    unreadable,
)
from icdgen.diagnostics import Finding, Findings, Place
from icdgen.icd.fmt.emit import Spelled


def message(name, id=1, kind="telemetry", **more):
    ids = {"id": id} if kind != "configuration" else {"set_id": id, "get_id": id}
    return {"name": name, "kind": kind, **ids, **more}


def network(*messages, **more):
    return Network("bus", "Bus", {"byte_order": "big"}, list(messages), **more)


def rows(definitions):
    return [
        (
            finding.code,
            finding.severity,
            finding.spot.place,
            finding.message,
            finding.help,
        )
        for finding in definitions.import_findings
    ]


@pytest.mark.parametrize(
    ("messages", "names"),
    [
        (
            [message("A", 1, group="X"), message("A", 2, group="Y"), message("B", 3)],
            ["X A", "Y A", "B"],
        ),
        ([message("A", 1, group="X"), message("A", 2)], ["X A", "A"]),
        (
            [message("A", 1, group="X"), message("A", 2, "telecommand", group="Y")],
            ["X A", "Y A"],
        ),
        (
            [message("A", 1, group="X"), message("A", 2, "telecommand", group="X")],
            ["telemetry A", "telecommand A"],
        ),
        ([message("A", 1), message("A", Spelled("0x1F"))], ["A 1", "A 0x1F"]),
        (
            [message("A", 7, "configuration"), message("A", 8, "configuration")],
            ["A 7", "A 8"],
        ),
    ],
)
def test_messages_of_one_name_get_group_kind_or_id(messages, names):
    definitions, bus = Definitions("a.dbc"), network(*messages)
    bus.name_messages_apart(definitions)
    assert [each["name"] for each in bus.messages] == names
    changed = ", ".join(f"`{name}`" for name in names if name != "B")
    text = f"2 messages have the name `A`: they are imported as {changed}"
    help = "rename them in the ICD if you want other names"
    assert rows(definitions) == [("IMP092", "note", "", text, help)]


def test_only_used_enumerations_are_declared():
    bus = network(
        message("A", fields=[{"enum": "Mode"}, {"name": "Speed"}]),
        structs=[{"fields": [{"enum": "State"}]}],
    )
    bus.declare([{"name": name} for name in ("State", "Other", "Mode")])
    assert bus.enums == [{"name": "State"}, {"name": "Mode"}]


def test_a_tree_has_its_sections_in_order_and_no_empty_ones():
    bus = network(
        message("A", fields=[{"unit": "widget"}, {"unit": "V"}]), enums=[{"name": "E"}]
    )
    tree = bus.tree()
    assert list(tree) == ["icdgen", "node", "units", "enums", "messages"]
    assert tree["icdgen"] == 1
    assert tree["node"] == {"name": "bus", "title": "Bus", "byte_order": "big"}
    (unit,) = tree["units"]
    assert "widget" in unit.values()
    bus = network(message("A"), protocol={"link": 1}, structs=[{"name": "S"}])
    assert list(bus.tree()) == ["icdgen", "node", "protocol", "structs", "messages"]


def test_messages_share_an_id_within_a_direction_only():
    bus = network(
        message("A", 1),
        message("B", 1),
        message("C", 1, "telecommand"),
        message("D", 2, shares_id=True),
        message("E", 3, "configuration"),
        message("F", 3, "telecommand"),
        message("G", 4, "configuration"),
    )
    sharing = [each["name"] for each in bus.tree()["messages"] if "shares_id" in each]
    assert sharing == ["A", "B", "E", "F"]


def test_findings_state_what_is_left_out_and_another_file():
    definitions = Definitions("a.xml")
    definitions.left_out("A", NotSupported("it is odd", "mend it"), 3, "b.xml")
    definitions.left_out("B", "it is odd", 4, "a.xml")
    definitions.without_field("C", "Speed", "it is odd", 5)
    definitions.warn("IMP099", "odd", file="b.xml", line=6)
    assert rows(definitions) == [
        ("IMP070", "error", "b.xml, line 3", "message `A` is not imported: it is odd", "mend it"),
        ("IMP070", "error", "line 4", "message `B` is not imported: it is odd", ""),
        ("IMP091", "error", "line 5", "message `C`, `Speed` is left out: it is odd",
         "the message is imported without it: its bits are reserved"),
        ("IMP099", "warning", "b.xml, line 6", "odd", ""),
    ]  # fmt: skip


def test_a_refused_file_has_a_line_from_the_second_on():
    definitions = Definitions("a.xml")
    faults = [
        Finding("IMP005", f"line {line}", Place("a.xml", line), "help")
        for line in (1, 2)
    ]
    definitions.refuse(Findings(faults))
    assert rows(definitions) == [
        ("IMP005", "error", "", "line 1", "help"),
        ("IMP005", "error", "line 2", "line 2", "help"),
    ]


def test_findings_of_another_file_keep_its_name():
    part = Definitions("b.xml")
    part.warn("IMP099", "own")
    part.warn("IMP099", "third", file="c.xml", line=2)
    both, same = Definitions("a.xml"), Definitions("b.xml")
    for definitions in (both, same):
        definitions.take(part)
    assert [row[2] for row in rows(both)] == ["b.xml", "c.xml, line 2"]
    assert [row[2] for row in rows(same)] == ["", "c.xml, line 2"]


def test_further_files_are_counted():
    names = [Definitions("a.xml", more=more).files for more in (0, 1, 2)]
    assert names == ["a.xml", "a.xml and 1 more file", "a.xml and 2 more files"]


def test_a_replaced_mapping_stays_the_same_object():
    item = {"a": 1}
    assert replace_keys(item, {"b": 2}) is item and item == {"b": 2}
    (finding,) = unreadable("a.xml", "odd", "mend it", 7).findings
    assert finding == Finding("IMP005", "odd", Place("a.xml", 7), "mend it")
