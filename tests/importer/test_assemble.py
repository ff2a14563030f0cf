"""Results of tables are assigned to nodes without a loss: enumerations of one name, and
captions that spell the name of a node in two ways.
"""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer import profile
from icdgen.importer.assemble import assemble
from icdgen.importer.descriptions import Described
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import (
    ReadEnum,
    ReadField,
    ReadList,
    ReadMember,
    ReadMessage,
    Survey,
    TableResult,
)
from tests.importer.conftest import imported
from tests.importer.test_text import ENUM, LISTED, MESSAGE, PUMP, read


def enumeration(number: int, *members: str) -> str:
    rows = "".join(f"{value}\t{name}\t\n" for value, name in enumerate(members))
    return (
        f"\nTable {number}: PumpMode Enumeration Values\n\n"
        f"Numeric Value\tName\tDescription\n{rows}"
    )


def test_an_enumeration_that_is_printed_again_is_merged_also_with_a_variant(tmp_path):
    tables = [("Off", "Running"), ("Off", "On"), ("Off", "On")]
    text = "".join(enumeration(8 + i, *members) for i, members in enumerate(tables))
    result, tree = read(tmp_path, MESSAGE + text)
    assert [
        (enum["name"], [member["name"] for member in enum["members"]])
        for enum in tree["enums"]
    ] == [("PumpMode", ["Off", "Running"]), ("PumpMode 2", ["Off", "On"])]
    assert [f.code for f in result.import_findings].count("IMP052") == 1


def test_captions_that_spell_a_node_in_two_ways_name_one_node(tmp_path):
    def listing(number: int, node: str, id: int, name: str) -> str:
        return (
            f"\nTable {number}: List of {node} Telemetry Frames\n\n"
            f"ID\tName\tDescription\tLength (bytes)\n{id}\t{name}\t\t4\n"
        )

    path = tmp_path / "motor.txt"
    path.write_text(
        listing(1, "Motor A", 140, "Pump State")
        + MESSAGE
        + listing(9, "Motor-A", 141, "Pump Speed")
        + MESSAGE.replace("Pump State", "Pump Speed").replace("\t140\t", "\t141\t")
        + ENUM
    )
    rules = tmp_path / "rules.yaml"
    rules.write_text(PUMP.read_text().replace("phrases:", f"{LISTED}phrases:"))
    _, trees = imported(path, rules)
    (tree,) = trees.values()
    assert [m["name"] for m in tree["messages"]] == ["Pump State", "Pump Speed"]
    assert [enum["name"] for enum in tree["enums"]] == ["PumpMode"]


WORDS = profile.load()


def enum(name: str, *members: str, label: int = 1, number: int = 1) -> ReadEnum:
    table = SourceTable(number=number, label=label)
    return ReadEnum(name, [ReadMember(n, m) for n, m in enumerate(members)], table)


def assembled(*contents, words=WORDS, file="/x/My-Pump 2 manual old.pdf"):
    """Return the trees and the findings of contents of tables."""
    survey = Survey([TableResult(c.table, "", c) for c in contents])
    return assemble(Document(file), survey, words), survey.import_findings


def with_nodes(*nodes: dict) -> profile.Profile:
    """Return the profile of icdgen with an entry of `nodes` for each argument."""
    return profile.Profile({**WORDS.data, "nodes": list(nodes)}, {}, [])


@pytest.mark.parametrize(
    ("file", "name", "title"),
    [
        ("/x/My-Pump 2 manual old.pdf", "mypump2", "My Pump 2"),
        ("3 wheels.txt", "node3wheels", "3 wheels"),
        ("---.txt", "device", "device"),
        (f"{'a' * 50}.txt", "a" * 40, "a" * 50),
        (f"1{'a' * 50}.txt", f"node1{'a' * 35}", f"1{'a' * 50}"),
    ],
)
def test_a_node_without_a_name_is_called_by_three_words_of_the_file(file, name, title):
    trees, _ = assembled(enum("Mode", "Off"), file=file)
    assert [(key, tree["node"]["title"]) for key, tree in trees.items()] == [
        (name, title)
    ]


def test_tables_without_contents_give_no_node():
    survey = Survey([TableResult(SourceTable(), "", None)])
    assert assemble(Document("a.txt"), survey, WORDS) == {}


def nodes_of(*contents, words) -> dict[str, list[str]]:
    trees, _ = assembled(*contents, words=words)
    return {name: [e["name"] for e in tree["enums"]] for name, tree in trees.items()}


def test_tables_belong_to_nodes_by_their_numbers_or_groups():
    words = with_nodes(
        {"name": "a", "tables": (3, 4)},
        {"name": "b", "group": 2},
        {"name": "c", "tables": (1, 1), "group": 1},
        {"name": "d", "tables": (4, 9)},
    )
    tables = [enum(f"E{n}", "x", label=n, number=n) for n in range(1, 6)]
    grouped = enum("G", "x", label=1, number=6)
    grouped.table.run = 2
    # A table that no node states belongs to the node of the table before.
    assert nodes_of(*tables, grouped, words=words) == {
        "c": ["E1", "E2"],
        "a": ["E3", "E4"],
        "d": ["E5"],
        "b": ["G"],
    }


def test_a_table_of_the_same_name_is_in_the_node_of_the_later_one():
    words = with_nodes({"name": "a", "tables": (3, 3)}, {"name": "b", "tables": (4, 4)})
    early = enum("Mode 4", "x", label=1, number=1)
    tables = [enum("A", "x", label=3, number=3), enum("mode-4", "y", label=4, number=4)]
    assert nodes_of(early, *tables, words=words) == {
        "b": ["Mode 4", "mode-4"],
        "a": ["A"],
    }


def test_other_nodes_include_the_shared_ones():
    words = with_nodes(
        {"name": "a", "tables": (1, 1), "title": "A", "include": ["common.yaml"]},
        {"name": "common", "tables": (2, 2)},
        {"name": "c", "tables": (3, 3)},
    )
    tables = [enum(f"E{n}", "x", label=n, number=n) for n in (1, 2, 3)]
    trees, _ = assembled(*tables, words=words)
    assert {name: tree.get("include") for name, tree in trees.items()} == {
        "a": ["common.yaml"],
        "common": None,
        "c": ["common.yaml"],
    }
    assert trees["a"]["node"]["title"] == "A"
    # A single node is shared with none.
    (tree,) = assembled(tables[1], words=words)[0].values()
    assert "include" not in tree


def test_enumerations_that_have_only_the_name_in_common_are_numbered():
    tables = [
        enum("Mode", "Off", "On", label=3, number=1),
        enum("Mode", "Off", label=4, number=2),
        enum("Mode", "Off", "On", label=5, number=3),
        enum("Mode", "Off", "Run", label=6, number=4),
    ]
    (tree,), findings = (lambda t, f: (t.values(), f))(*assembled(*tables))
    assert [(e["name"], e["source"], e.get("also")) for e in tree["enums"]] == [
        ("Mode", {"table": 3}, [{"table": 5}]),
        ("Mode 2", {"table": 4}, None),
        ("Mode 3", {"table": 6}, None),
    ]
    text = "{}: table 3 has an enumeration of this name with other members"
    assert [(f.code, f.severity, f.message, f.help) for f in findings] == [
        (
            "IMP052",
            "error",
            text.format(f"table {number}"),
            f"held as `{name}`: see which one the fields mean",
        )
        for number, name in ((2, "Mode 2"), (4, "Mode 3"))
    ]


@pytest.mark.parametrize(
    ("run", "label", "source", "also"),
    [(1, 5, 5, 3), (1, 3, 3, 5), (1, 9, 3, 5), (2, 5, 3, 5)],
)
def test_the_table_to_which_a_field_refers_is_the_source(run, label, source, also):
    field = ReadField("F", 0, 8, "enum", Described(enum_table=label), SourcePlace())
    table = SourceTable(number=3, run=run)
    message = ReadMessage("State", "telemetry", table, id=1, length=1, fields=[field])
    tables = [enum("Mode", "Off", label=n, number=n) for n in (3, 5)]
    (tree,) = assembled(*tables, message)[0].values()
    assert [(e["source"], e["also"]) for e in tree["enums"]] == [
        ({"table": source}, [{"table": also}])
    ]


def test_a_list_names_the_node_of_the_tables_behind_it():
    words = with_nodes(
        {"name": "a", "match": ["Motor A"]}, {"name": "b", "match": ["B"]}
    )
    lists = [ReadList("", name, []) for name in ("The MOTOR-A frames", "Wheel", "B")]
    enums = [enum(f"E{n}", "x", number=n) for n in range(4)]
    contents = [enums[0], lists[0], enums[1], lists[1], enums[2], lists[2], enums[3]]
    tables = [getattr(c, "table", SourceTable(caption="x")) for c in contents]
    survey = Survey(
        [TableResult(t, "", c) for t, c in zip(tables, contents, strict=True)]
    )
    trees = assemble(Document("x.txt"), survey, words)
    assert {name: [e["name"] for e in t["enums"]] for name, t in trees.items()} == {
        "a": ["E0", "E1"],
        "wheel": ["E2"],
        "b": ["E3"],
    }
