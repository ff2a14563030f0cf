"""The report of an import of definitions has all findings, numbers and renamed
identifiers, as text and as JSON.
"""

from __future__ import annotations

import json
from pathlib import Path

from icdgen.definitions.console import as_json, report
from icdgen.definitions.model import Definitions
from icdgen.definitions.run import ReadDefinitions
from icdgen.diagnostics import Finding, Place
from icdgen.import_results.targets import Target


def read(file="a.dbc", messages=2, total=3, more=0, identifiers=(), trees=None):
    tree = {"messages": [{"name": f"M{number}"} for number in range(messages)]}
    definitions = Definitions(file, total=total, more=more)
    trees = {"demo": tree} if trees is None else trees
    return ReadDefinitions(definitions, "a CAN database", trees, list(identifiers))


def nothing(file):
    """Return the result of a file without messages."""
    return read(file, total=0, trees={})


def with_findings():
    result = read()
    result.definitions.warn("IMP070", "no \x1b[31m red", "help\x07", "error", 7)
    result.definitions.warn("IMP071", "two", line=2, file="b.dbc")
    result.definitions.warn("IMP085", "three", severity="note", line=9)
    return result


def test_a_report_has_findings_followed_by_the_numbers():
    assert report([with_findings()]) == "\n".join(
        [
            r"error[IMP070]: no \x1b[31m red",
            "  --> a.dbc:7",
            r"  = help: help\x07",
            "",
            "warning[IMP071]: two",
            "  --> b.dbc:2",
            "",
            "note[IMP085] line 9: three",
            "",
            "a.dbc: a CAN database, 2 of 3 messages imported",
            "findings: 1 error, 1 warning, 1 note",
        ]
    )


def test_severities_have_colours_only_if_wanted():
    assert "\x1b" not in report([with_findings()])
    assert report([with_findings()], colour=True).startswith(
        "\x1b[31;1merror[IMP070]\x1b[0m: no"
    )


def test_a_file_that_cannot_be_printed_is_escaped():
    assert report([read("\x1b.dbc", more=2)]).startswith(r"\x1b.dbc and 2 more files: ")


def names(count):
    return [f"value `{number}`: `value {number}`" for number in range(count)]


def tail_of(count):
    """Return the lines of a report with this number of renamed identifiers."""
    return report([read(identifiers=names(count))]).split("\n")[2:]


def test_renamed_identifiers_are_listed_up_to_twenty():
    assert tail_of(0) == []
    assert tail_of(1) == [
        "1 name that is not a valid identifier got one:",
        "  value `0`: `value 0`",
    ]
    listed = [f"  {name}" for name in names(20)]
    head = "{} names that are not valid identifiers got one:"
    assert tail_of(2) == [head.format(2), *listed[:2]]
    assert tail_of(20) == [head.format(20), *listed]
    assert tail_of(21) == [head.format(21), *listed, "  and 1 more"]


def test_several_definitions_are_blocks_and_those_without_messages_one_line():
    noted = nothing("noted.xml")
    noted.definitions.warn("IMP076", "twice")
    lost = read("lost.xml", total=1, trees={})
    text = report([nothing("a\x07.xml"), read(), noted, nothing("b.xml"), lost])
    blocks = text.split("\n\n")
    assert (
        blocks[0] == "a.dbc: a CAN database, 2 of 3 messages imported\nfindings: none"
    )
    assert blocks[1:3] == [
        "warning[IMP076]: twice\n  --> noted.xml",
        "noted.xml: a CAN database, 0 of 0 messages imported\nfindings: 1 warning",
    ]
    assert blocks[3].startswith("lost.xml: a CAN database, 0 of 1 messages")
    assert blocks[4:] == [r"without messages of their own: a\x07.xml, b.xml"]


def test_a_single_definition_without_messages_has_its_numbers():
    assert report([nothing("a.xml")]) == (
        "a.xml: a CAN database, 0 of 0 messages imported\nfindings: none"
    )


def unshown(count):
    files = [nothing(f"{number}.xml") for number in range(count)]
    return report([read(), *files]).rpartition("\n\n")[2]


def test_files_without_messages_are_listed_up_to_twenty():
    assert unshown(1) == "without messages of its own: 0.xml"
    listed = ", ".join(f"{number}.xml" for number in range(20))
    assert unshown(20) == f"without messages of their own: {listed}"
    assert unshown(22) == f"without messages of their own: {listed} and 2 more"


TARGET = Target(Path("icd/demo.yaml"), "", {}, ["+ message `Ä`"])
CHECKED = Finding("ICD001", "odd", Place("icd/demo.yaml", 4), "fix it", "warning")


def test_the_json_of_a_definition_has_all_findings_and_identifiers():
    result = with_findings()
    result.identifiers = names(21)
    text = as_json([result], [TARGET], [CHECKED])
    assert text.startswith('{\n  "definition"') and "Ä" in text
    assert json.loads(text) == {
        "definition": "a.dbc",
        "kind": "a CAN database",
        "messages": 3,
        "held": 2,
        "findings": [
            {
                "code": "IMP070",
                "severity": "error",
                "message": "no \x1b[31m red",
                "help": "help\x07",
                "line": 7,
            },
            {
                "code": "IMP071",
                "severity": "warning",
                "message": "two",
                "help": "",
                "file": "b.dbc",
                "line": 2,
            },
            {
                "code": "IMP085",
                "severity": "note",
                "message": "three",
                "help": "",
                "line": 9,
            },
        ],
        "identifiers": names(21),
        "files": [{"file": "icd/demo.yaml", "changes": ["+ message `Ä`"]}],
        "check": [
            {
                "code": "ICD001",
                "severity": "warning",
                "message": "odd",
                "help": "fix it",
                "file": "icd/demo.yaml",
                "line": 4,
            }
        ],
    }


def test_the_json_of_several_definitions_is_a_list_of_all():
    tree = json.loads(as_json([read(), nothing("b.xml")], [], []))
    assert [item["definition"] for item in tree.pop("definitions")] == [
        "a.dbc",
        "b.xml",
    ]
    assert tree == {"files": [], "check": []}
