"""CAN databases become ICDs with the values that cantools reads. Only mistakes in a
database are findings.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import can, kinds, run
from icdgen.diagnostics import Findings
from icdgen.icd import wire_ids
from tests.conftest import ROOT

FILES = ROOT / "tests" / "definitions" / "files"


@pytest.fixture(scope="module")
def train():
    return run.read(FILES / "train.dbc", can.Dbc())


@pytest.fixture(scope="module")
def faulty():
    return run.read(FILES / "faulty.dbc", can.Dbc())


def message(read: run.ReadDefinitions, name: str) -> dict:
    (tree,) = read.trees.values()
    return next(message for message in tree["messages"] if message["name"] == name)


def field(read: run.ReadDefinitions, owner: str, name: str) -> dict:
    return next(
        field for field in message(read, owner)["fields"] if field["name"] == name
    )


def test_names_ids_lengths_senders_and_comments_arrive(train):
    assert {key: value for key, value in message(train, "DriveStatus").items() if key != "fields"} == {
        "name": "DriveStatus", "id": 256, "kind": "telemetry", "length": 8, "reserved": 1, "group": "Drive",
        "summary": "What the drive says, every 10 ms.",
    }  # fmt: skip
    assert message(train, "Heartbeat") == {
        "name": "Heartbeat", "id": 257, "kind": "telemetry", "length": 1, "reserved": 1,
    }  # fmt: skip


def test_an_id_of_29_bits_is_marked_only_among_those_of_11_bits(train, tmp_path):
    (tree,) = train.trees.values()
    assert tree["node"]["id_bits"] == 32
    assert (
        message(train, "BrakeDetails")["id"] == 2566844926
        and message(train, "DriveStatus")["id"] == 256
    )
    only = 'BU_: Drive\nBO_ 2566844926 BrakeDetails: 1 Drive\n SG_ Page : 0|8@1+ (1,0) [0|0] "" Drive\n'
    (tmp_path / "only.dbc").write_text(only)
    read = run.read(tmp_path / "only.dbc", can.Dbc())
    (tree,) = read.trees.values()
    assert tree["node"]["id_bits"] == 29
    assert message(read, "BrakeDetails")["id"] == 2566844926 - (1 << 31)


def test_units_formulas_and_limits_arrive_where_they_say_more_than_the_width(train):
    speed = field(train, "DriveStatus", "Speed")
    assert (speed["unit"], speed["formula"], speed.get("min"), speed["max"]) == (
        "km/h",
        "raw*0.01",
        None,
        300,
    )
    torque = field(train, "DriveStatus", "Torque")
    assert (torque["unit"], torque["formula"], "min" in torque, "max" in torque) == (
        "N.m",
        "raw*0.5 - 20",
        False,
        False,
    )


def test_fields_with_another_byte_order_than_most_state_it(train):
    pressure = field(train, "DriveStatus", "Pressure")
    assert (pressure["at"], pressure["byte_order"], pressure["bit_order"]) == (
        32,
        "big",
        "msb0",
    )


def test_named_values_become_enumerations_or_special_values_of_scaled_fields(train):
    (tree,) = train.trees.values()
    (mode,) = tree["enums"]
    assert [(member["value"], member.get("to"), member["name"], member.get("identifier")) for member in mode["members"]] == [
        (0, None, "Off 0", None), (1, None, "2nd gear", "value 2nd gear"), (2, 3, "Spare", None), (5, None, "Off 5", None),
    ]  # fmt: skip
    assert field(train, "DriveStatus", "Torque")["special"] == [
        {"value": 2047, "meaning": "not known"}
    ]
    assert [finding.code for finding in train.definitions.import_findings] == [
        "IMP074",
        "IMP073",
        "IMP071",
        "IMP085",
    ]


def test_the_smaller_of_overlapping_fields_is_an_overlay_field(train):
    assert field(train, "DriveStatus", "LevelLow")["view"] and "view" not in field(
        train, "DriveStatus", "Level"
    )


def test_multiplexed_fields_have_conditions(train):
    whens = {
        field["name"]: field.get("when")
        for field in message(train, "BrakeDetails")["fields"]
    }
    assert whens == {
        "Page": None,
        "Temperature": {"Page": 0},
        "Wear": {"Page": 1},
        "Hours": {"Page": 1},
        "Common": None,
    }


def test_names_that_are_no_identifiers_get_one_and_are_listed(train):
    assert train.identifiers == [
        "value `2nd gear`: `value 2nd gear`",
        "field `class`: `class field`",
    ]
    assert field(train, "DriveStatus", "class")["identifier"] == "class field"


def test_a_mistake_only_removes_the_message_or_field_it_concerns(faulty):
    (tree,) = faulty.trees.values()
    assert [message["name"] for message in tree["messages"]] == [
        "Wide",
        "Short",
        "Nested",
        "Fine",
    ]
    assert message(faulty, "Wide")["id"] == wire_ids.CAN_EXTENDED_FLAG + 13274
    assert [field["name"] for field in message(faulty, "Short")["fields"]] == ["Inside"]
    findings = [
        (finding.code, finding.spot.line, finding.message)
        for finding in faulty.definitions.import_findings
    ]
    assert findings == [
        ("IMP076", 5, "the id 0x33da has more than the 11 bits of a standard frame"),
        (
            "IMP075",
            7,
            '`SG_ 0_COUNTER : 8|8@1+ (1,0) [0|0] "" Drive` is not understood',
        ),
        (
            "IMP075",
            13,
            "`BO_ 513 2nd: 1 Drive` is not understood, nor are the 1 signals below it",
        ),
        ("IMP075", 21, '`CM_ "no end"` is not understood'),
        (
            "IMP076",
            27,
            "`VAL_` names `Missing` of message 515, which has no such signal",
        ),
        ("IMP072", None, "message `Short`: `Outside` ends behind its 2 bytes"),
        (
            "IMP091",
            None,
            "message `Nested`, `Value` is left out: it depends on `Inner`, which is optional itself",
        ),
        (
            "IMP085",
            None,
            "`receivers` of `signal` is not used (5 times, first: message `Wide`, `Speed`)",
        ),
    ]
    assert faulty.failed and (faulty.imported, faulty.definitions.total) == (4, 4)


def test_a_signal_that_begins_before_its_message_is_left_out(tmp_path):
    text = (FILES / "faulty.dbc").read_text()
    assert "Outside : 12|8@1+" in text
    (tmp_path / "before.dbc").write_text(
        text.replace("Outside : 12|8@1+", "Outside : -1|8@1+")
    )
    read = run.read(
        tmp_path / "before.dbc", kinds.reader_of_file(tmp_path / "before.dbc")
    )
    assert [field["name"] for field in message(read, "Short")["fields"]] == ["Inside"]
    messages = [
        finding.message
        for finding in read.definitions.import_findings
        if finding.code == "IMP072"
    ]
    assert messages == ["message `Short`: `Outside` begins before its 2 bytes"]


@pytest.mark.parametrize("form", ["kcd", "sym"])
def test_the_same_database_in_another_form_gives_the_same_fields(form, train, tmp_path):
    import cantools

    path = tmp_path / f"train.{form}"
    cantools.database.dump_file(
        cantools.database.load_file(FILES / "train.dbc", strict=False), path
    )
    reader = kinds.reader_of_file(path)
    assert reader is not None and reader.name == form
    read = run.read(path, reader)
    keys = ("at", "bits", "type", "formula", "when", "enum", "byte_order", "view")
    for name in ("DriveStatus", "BrakeDetails"):
        ours, theirs = (
            [
                (field["name"], *(field.get(key) for key in keys))
                for field in message(each, name)["fields"]
            ]
            for each in (train, read)
        )
        # In this format a signal is listed under each value of the multiplexer.
        several = [0, 1] if form == "sym" else None
        assert [
            (
                row
                if row[0] != "Common"
                else (*row[:5], several and {"Page": several}, *row[6:])
            )
            for row in ours
        ] == theirs


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.dbc", "BU_: A\nBO_ 1 nothing but this", "`BO_ 1 nothing but this` is not understood"),
        ("a.kcd", '<!DOCTYPE a [<!ENTITY b "c">]><NetworkDefinition>&b;</NetworkDefinition>', "document type"),
        ("a.arxml", '<!DOCTYPE a SYSTEM "file:///etc/passwd"><AUTOSAR/>', "document type"),
        ("a.kcd", "<NetworkDefinition><Bus></NetworkDefinition>", "not XML: mismatched tag"),
        ("a.sym", "FormatVersion=6.0\nTitle=", "not a symbol file"),
        ("a.dbc", "BU_: A\n" + "x" * 8_000_000, "more than the 8,000,000 bytes allowed"),
        ("a.dbc", "BU_: A\n", "none is defined"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_read_is_a_finding(name, text, says, tmp_path):
    path = tmp_path / name
    path.write_text(text)
    reader = kinds.reader_of_file(path)
    assert reader is not None
    with pytest.raises(Findings) as raised:
        run.read(path, reader)
    (finding,) = raised.value.findings
    assert finding.code == "IMP005" and says in finding.message
