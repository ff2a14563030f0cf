"""``icdgen show --format json``: the form that other programs rely on."""

from __future__ import annotations

import json
from fractions import Fraction

import jsonschema_rs
import pytest

import icdgen.shipped
from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.show.machine import SCHEMA, to_json

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0}
enums:
  - {name: Mode, source: {table: 3}, members: [{value: 0, name: Idle}, {value: 1, name: Run, summary: At speed.}]}
"""
TOP = """\
icdgen: 1
node: {name: top, title: Top, node_type: 0, interface_version: 7, byte_order: little, bit_order: lsb0}
include: [base.yaml]
units: [{symbol: stars, identifier: stars, quantity: count}]
protocol: {link: {buses: {uart: {line: {baud_rate: 115200}}}}}
messages:
  - {name: Reset, id: 0, kind: telecommand, length: 1, acknowledge: false,
     fields: [{at: 0, bits: 8, name: Magic, type: uint, const: 0}]}
  - name: Temperature
    set_id: 2
    get_id: 140
    kind: configuration
    length: 4
    source: {table: 98}
    fields:
      - {at: 0, bits: 16, name: Air, type: int, unit: C, formula: (raw - 32)*5/9, min: -40.5, below: 100}
      - {at: 16, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 24, bits: 8, name: Count, type: uint, unit: stars, formula: raw*5, special: [{value: 255, meaning: many}]}
  - {name: Nothing, id: 141, kind: telemetry, length: 0}
loggable: [{bit: 0, id: 141, name: Nothing}, {bit: 5, id: 140}]
missing: [{kind: telemetry, id: 186, name: Torque, why: Not described.}]
"""
OVERLAY = """\
errata: 1
node: top
entries:
  - {id: TOP-001, title: Wrong unit, where: {message: Temperature, field: Air}, printed: {unit: C}, held: {unit: K},
     tables: [98], why: It is., evidence: Table 98., confidence: likely}
notes:
  - {id: TOP-002, title: A section, where: {section: protocol.link.buses.uart}, what: W., evidence: E.}
  - {id: TOP-003, title: Two places, where: [{message: Reset}, {loggable: 5}], what: W., evidence: E.,
     confidence: certain}
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory) -> Icd:
    folder = tmp_path_factory.mktemp("show")
    (folder / "errata").mkdir()
    for name, text in (
        ("base.yaml", BASE),
        ("top.yaml", TOP),
        ("errata/top.yaml", OVERLAY),
    ):
        (folder / name).write_text(text, encoding="utf-8")
    loaded = load([folder / "top.yaml"], check=False)
    assert loaded.findings == []
    return loaded.icd


@pytest.fixture(scope="module")
def shown(icd) -> dict:
    return json.loads(json.dumps(to_json(icd), allow_nan=False))


@pytest.fixture(scope="module")
def shipped() -> dict:
    return to_json(load([icdgen.shipped.icds()], check=False).icd)


@pytest.fixture(scope="module")
def schema():
    return jsonschema_rs.validator_for(json.loads(SCHEMA.read_text(encoding="utf-8")))


def test_the_keys_that_programs_look_for(shown):
    assert list(shown) == ["format", "nodes", "loggable"]
    base, top = shown["nodes"]
    assert (
        top["name"],
        top["node_type"],
        top["interface_version"],
        top["includes"],
    ) == ("top", 0, 7, ["base"])
    assert base["enums"] == [
        {
            "name": "Mode",
            "table": 3,
            "members": [
                {"value": 0, "name": "Idle"},
                {"value": 1, "name": "Run", "summary": "At speed."},
            ],
        }
    ]
    assert "node_type" not in base and base["messages"] == [] and top["enums"] == []
    reset, temperature, configuration = top["messages"]
    assert reset == {
        "name": "Reset", "kind": "telecommand", "id": 0, "length": 1, "acknowledge": False, "notes": ["TOP-003"],
        "fields": [{"name": "Magic", "offset": 0, "bits": 8, "type": "uint", "const": 0}],
    }  # fmt: skip
    assert (temperature["set_id"], temperature["get_id"], temperature["table"]) == (
        2,
        140,
        98,
    )
    assert "id" not in temperature
    assert temperature["fields"] == [
        {"name": "Air", "offset": 0, "bits": 16, "type": "int", "unit": "K", "scale": "5/9", "scale_offset": "-160/9",
         "formula": "(raw - 32)*5/9", "limits": {"min": "-81/2", "below": "100"}, "errata": ["TOP-001"]},
        {"name": "Mode", "offset": 16, "bits": 8, "type": "enum", "enum": "Mode"},
        {"name": "Count", "offset": 24, "bits": 8, "type": "uint", "unit": "stars", "scale": "5", "formula": "raw*5",
         "special": [{"value": 255, "meaning": "many"}]},
    ]  # fmt: skip
    assert configuration == {
        "name": "Nothing",
        "kind": "telemetry",
        "id": 141,
        "length": 0,
        "fields": [],
    }
    assert top["protocol"] == {
        "link": {"buses": {"uart": {"line": {"baud_rate": 115200}}}}
    }


def test_loggable_frames_of_a_node_and_of_all(shown):
    rows = [
        {"bit": 0, "id": 141, "name": "Nothing"},
        {"bit": 5, "id": 140, "notes": ["TOP-003"]},
    ]
    assert shown["nodes"][1]["loggable"] == rows
    assert shown["loggable"] == [{"node": "top"} | row for row in rows]


def test_errata_with_the_places_they_concern(shown):
    (erratum,), (two, three) = (shown["nodes"][1][key] for key in ("errata", "notes"))
    assert erratum == {
        "id": "TOP-001", "title": "Wrong unit", "why": "It is.", "evidence": "Table 98.", "confidence": "likely",
        "tables": [98], "printed": {"unit": "C"}, "held": {"unit": "K"}, "changes": True,
        "places": [{"message": "Temperature", "field": "Air"}],
    }  # fmt: skip
    assert two == {
        "id": "TOP-002",
        "title": "A section",
        "what": "W.",
        "evidence": "E.",
    }
    assert three["places"] == [{"message": "Reset"}, {"loggable": 5}]


def test_the_published_schema_holds(shown, shipped, schema):
    for tree in (shown, shipped):
        assert [error.message for error in schema.iter_errors(tree)] == []


@pytest.mark.parametrize(
    "spoil",
    [
        lambda tree: tree.pop("loggable"),
        lambda tree: tree["nodes"][1].pop("messages"),
        lambda tree: tree["nodes"][1]["messages"][0].pop("id"),
        lambda tree: tree["nodes"][1]["messages"][1].pop("get_id"),
        lambda tree: tree["nodes"][1]["messages"][1]["fields"][0].update(scale=0.01),
        lambda tree: tree["nodes"][1]["messages"][1]["fields"][0].pop("scale"),
        lambda tree: tree["nodes"][1]["messages"][1]["fields"][0].update(surprise=1),
        lambda tree: tree["nodes"][1]["errata"][0]["places"].append({"field": "Air"}),
    ],
)
def test_the_published_schema_refuses_invalid_output(shown, schema, spoil):
    tree = json.loads(json.dumps(shown))
    spoil(tree)
    assert not schema.is_valid(tree)


def test_the_shipped_icds_have_the_content_of_the_manual(shipped):
    messages = [message for node in shipped["nodes"] for message in node["messages"]]
    fields = [field for message in messages for field in message["fields"]]
    enums = [enum for node in shipped["nodes"] for enum in node["enums"]]
    order = ("telecommand", "telemetry", "configuration")
    kinds = {
        n["name"]: tuple(sum(m["kind"] == k for m in n["messages"]) for k in order)
        for n in shipped["nodes"]
    }
    assert kinds == {
        "common": (14, 15, 12),
        "bootloader": (5, 3, 0),
        "cubeacp": (16, 73, 26),
        "cubemag": (0, 4, 0),
        "cubewheel": (0, 3, 0),
    }
    assert len(messages) == 171
    assert (
        sum(len({"id", "set_id", "get_id"} & message.keys()) for message in messages)
        == 209
    )
    assert len(fields) == 1251
    assert sum("scale" in field for field in fields) == 346
    assert sum("unit" in field for field in fields) == 324
    assert (len(enums), sum(len(enum["members"]) for enum in enums)) == (37, 233)
    assert len(shipped["loggable"]) == 63


def test_scales_are_exact(shipped):
    fields = {
        (n["name"], m["name"], f["name"]): f
        for n in shipped["nodes"]
        for m in n["messages"]
        for f in m["fields"]
    }
    roll = fields["cubeacp", "Estimated Attitude Angles", "Estimated Roll Angle"]
    assert roll["scale"] == "1/100"
    for field in fields.values():
        if "scale" in field:
            assert str(Fraction(field["scale"])) == field["scale"]


def test_the_same_icds_give_the_same_text_from_any_folder(icd, monkeypatch, tmp_path):
    before = json.dumps(to_json(icd))
    monkeypatch.chdir(tmp_path)
    assert json.dumps(to_json(icd)) == before
    assert str(tmp_path.parent) not in before
