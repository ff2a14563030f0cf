"""Messages, enumerations and lists of a node become a tree with the keys of an ICD."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer import profile
from icdgen.importer.descriptions import Described
from icdgen.importer.document import Document, PageBox, SourceTable
from icdgen.importer.icd_trees import head, tree
from icdgen.importer.model import (
    Extent,
    Listed,
    NodeParts,
    ReadEnum,
    ReadField,
    ReadLog,
    ReadLogBit,
    ReadMember,
    ReadMessage,
    ReadStruct,
)

DOCUMENT = Document("C:\\manuals\\pump.pdf")
WORDS = profile.load()
SPOT = SourcePlace(line=5)


def field(name="Rate", at=0, bits=8, type="uint", **keys) -> ReadField:
    facts = keys.pop("facts", {})
    count = keys.pop("count", 0)
    enum = keys.pop("enum", "")
    described = Described(**keys)
    return ReadField(name, at, bits, type, described, SPOT, count, enum, facts)


def message(*fields: ReadField, name="State", kind="telemetry", **keys) -> ReadMessage:
    keys.setdefault("id", 3)
    keys.setdefault("length", 1)
    table = keys.pop("table", SourceTable(number=4))
    return ReadMessage(name, kind, table, fields=list(fields), **keys)


def of_node(*messages, prose=False, **parts) -> dict:
    node = NodeParts("pump", "", messages=list(messages), **parts)
    return tree(node, DOCUMENT, WORDS, prose, [])


def field_of(item: ReadField, prose=False) -> dict:
    (entry,) = of_node(message(item), prose=prose)["messages"][0]["fields"]
    return entry


def test_a_node_without_contents_has_only_its_head():
    assert of_node() == {
        "icdgen": 1,
        "node": {
            "name": "pump",
            "title": "pump",
            "byte_order": "little",
            "bit_order": "lsb0",
            "source": {"document": "pump.pdf"},
        },
    }


@pytest.mark.parametrize(
    ("file", "title", "name"),
    [
        ("/home/x/pump.pdf", "", "pump.pdf"),
        ("pump.pdf", "", "pump.pdf"),
        ("pump.pdf", "Pump Manual", "Pump Manual"),
    ],
)
def test_a_document_is_cited_by_its_title_or_its_file_name(file, title, name):
    node = NodeParts("pump", "Pump")
    section = head(node, Document(file, title=title), WORDS)
    assert section["source"] == {"document": name}
    assert section["title"] == "Pump"


def test_keys_of_a_node_in_a_profile_precede_those_for_all_nodes():
    words = profile.NodeWords(
        "pump", [], None, None, {"title": "P", "byte_order": "big"}, []
    )
    section = head(NodeParts("pump", "Pump", words=words), DOCUMENT, WORDS)
    assert (section["title"], section["byte_order"]) == ("P", "big")
    assert section["bit_order"] == "lsb0"


def test_a_field_has_the_keys_that_it_needs():
    assert field_of(field()) == {"at": 0, "bits": 8, "name": "Rate", "type": "uint"}
    keys = {
        "unit": "deg",
        "formula": "raw*2",
        "formula_for": "raw",
        "const": "0x00",
        "count": 4,
        "enum": "Mode",
        "facts": {"min": 0},
    }
    assert field_of(field(at=8, **keys)) == {
        "at": 8,
        "bits": 8,
        "name": "Rate",
        "type": "uint",
        "min": 0,
        "count": 4,
        "enum": "Mode",
        "unit": "deg",
        "formula": "raw*2",
        "formula_for": "raw",
        # A constant of 0 is one, too.
        "const": 0,
    }


def test_a_field_with_a_size_has_no_bits_and_one_of_structs_no_type():
    sized = field_of(field(facts={"size": 12}))
    assert sized == {"at": 0, "name": "Rate", "type": "uint", "size": 12}
    structs = field_of(field(facts={"struct": "Point", "count": 3}))
    assert structs == {"at": 0, "name": "Rate", "struct": "Point", "count": 3}


@pytest.mark.parametrize(
    ("text", "wanted", "summary"),
    [
        ("Speed of the wheel", True, {"summary": "Speed of the wheel"}),
        ("Speed of the wheel", False, {}),
        ("", True, {}),
        ("RATE.", True, {}),
    ],
)
def test_a_summary_says_more_than_the_name(text, wanted, summary):
    entry = field_of(field(prose=text), prose=wanted)
    assert {key: entry[key] for key in entry if key == "summary"} == summary


def test_a_message_has_its_ids_its_length_and_its_source():
    table = SourceTable(4, label=4000012, boxes=[PageBox(7, 0, 0, 1, 1)])
    item = message(
        field(),
        name="Rate",
        kind="configuration",
        table=table,
        id=None,
        set_id=0,
        get_id=128,
        length=3,
        group="Power",
        listed={"length": 4},
        summary="Sets the rate.",
        reserved=[Extent(8, 24, "lsb0")],
    )
    assert of_node(item, prose=True)["messages"] == [
        {
            "name": "Rate",
            "set_id": 0,
            "get_id": 128,
            "kind": "configuration",
            "length": 3,
            "reserved": 2,
            "group": "Power",
            # Only a number of digits is a table of an ICD.
            "source": {"page": 7},
            "summary": "Sets the rate.",
            "listed": {"length": 4},
            "fields": [{"at": 0, "bits": 8, "name": "Rate", "type": "uint"}],
        }
    ]
    empty = message(length=0, table=SourceTable(4, label=12))
    assert of_node(empty)["messages"] == [
        {"name": "State", "id": 3, "kind": "telemetry", "length": 0}
        | {"source": {"table": 12}}
    ]


def test_enumerations_have_members_and_all_their_sources():
    members = [ReadMember(0, "Off", "off"), ReadMember(1, "On", "Runs.")]
    tables = [SourceTable(label=n) for n in (5, None, 6)]
    enum = ReadEnum("Mode", members, tables[0], also=tables[1:])
    assert of_node(enums=[enum], prose=True)["enums"] == [
        {
            "name": "Mode",
            "source": {"table": 5},
            "also": [{"table": 6}],
            "members": [
                {"value": 0, "name": "Off"},
                {"value": 1, "name": "On", "summary": "Runs."},
            ],
        }
    ]


def test_structs_bits_of_logs_and_included_nodes_are_listed():
    struct = ReadStruct("Point", 2, [field("X"), field("Y", 8)])
    log = ReadLog([ReadLogBit(0, 3, "State"), ReadLogBit(1, 0, "")])
    result = of_node(message(structs=[struct]), logs=[log], include=["common.yaml"])
    assert result["include"] == ["common.yaml"]
    assert result["structs"] == [
        {
            "name": "Point",
            "length": 2,
            "fields": [
                {"at": 0, "bits": 8, "name": "X", "type": "uint"},
                {"at": 8, "bits": 8, "name": "Y", "type": "uint"},
            ],
        }
    ]
    assert result["loggable"] == [
        {"bit": 0, "id": 3, "name": "State"},
        {"bit": 1, "id": 0},
    ]
    assert list(result) == "icdgen node include structs messages loggable".split()


def scaled(word: str = "raw", formula: str = "raw*2") -> ReadField:
    return field(formula=formula, formula_for=word)


@pytest.mark.parametrize(
    ("fields", "shared"),
    [
        ([scaled(), scaled()], {"telemetry": "raw"}),
        ([scaled(), scaled(), field()], {"telemetry": "raw"}),
        ([scaled()], {}),
        ([scaled(), scaled("physical")], {}),
        ([scaled(), scaled("")], {}),
        ([field(), field()], {}),
    ],
)
def test_words_of_all_formulas_of_a_kind_are_stated_once(fields, shared):
    other = message(scaled("physical"), kind="telecommand")
    first, rest = message(*fields[:1]), message(*fields[1:])
    result = of_node(first, other, rest)
    assert result.get("formula_for", {}) == shared
    own = [
        f.get("formula_for", "")
        for m in result["messages"]
        for f in m.get("fields", ())
    ]
    words = [item.described.formula_for for item in fields]
    expected = [""] * len(words) if shared else words
    assert own == [expected[0], "physical", *expected[1:]]


def test_units_that_are_not_built_in_are_declared_and_reported_once():
    findings: list = []
    item = message(field("A", unit="blip"), field("B", unit="V"), field("C", unit="°C"))
    struct = ReadStruct("S", 1, [field("D", unit="blip"), field("E", unit="blop")])
    item.structs = [struct]
    node = NodeParts("pump", "Pump", messages=[item])
    units = tree(node, DOCUMENT, WORDS, False, findings)["units"]
    assert [unit["symbol"] for unit in units] == ["blip", "blop"]
    assert [(f.code, f.severity, f.message, f.spot) for f in findings] == [
        (
            "IMP042",
            "note",
            f"table 4, field `{name}`: the unit `{symbol}` is not built in",
            SPOT,
        )
        for name, symbol in (("A", "blip"), ("E", "blop"))
    ]


def listed(kind="telemetry", table=None, **ids) -> Listed:
    given = {"id": None, "set_id": None, "get_id": None} | ids
    spot = SourcePlace(table=table)
    return Listed(kind, "Lost", 4, **given, group="", spot=spot)


@pytest.mark.parametrize(
    ("row", "id", "why"),
    [
        (listed(id=0), 0, "A list names it"),
        (listed(id=9, get_id=8, table=3), 9, "Table 3 lists it"),
        (listed(get_id=8, table=4000012), 8, "Table 4-12 lists it"),
        (listed(set_id=8), None, ""),
        (listed(kind="", id=8), None, ""),
    ],
)
def test_a_row_of_a_list_without_a_table_is_missing(row, id, why):
    why = f"{why}, no table describes it."
    entry = {"kind": "telemetry", "id": id, "name": "Lost", "why": why}
    expected = [] if id is None else [entry]
    assert of_node(missing=[row]).get("missing", []) == expected
