"""Definitions in the shapes that public files have become ICDs without a message fewer.

`python -m tests.xtce.shapes` compares the values with those of Yamcs, `python -m tests.devices` with those of other libraries.
"""

from __future__ import annotations

import re

import pytest

from icdgen.definitions import kinds, run
from icdgen.diagnostics import Findings
from tests.definitions.test_can import FILES, field, message

SHAPES = FILES / "shapes"


def placed(name, at):
    """An entry that says where it stands."""
    location = f'<LocationInContainerInBits referenceLocation="containerStart"><FixedValue>{at}</FixedValue>'
    return f'<ParameterRefEntry parameterRef="{name}">{location}</LocationInContainerInBits></ParameterRefEntry>'


def imported(path):
    return run.read(path, kinds.of(path))


def findings(read):
    return [(one.code, one.severity) for one in read.definitions.troubles]


@pytest.fixture(scope="module")
def kite():
    return imported(SHAPES / "aggregate.xml")


def test_xtce_conditions_on_members_of_aggregates_tell_messages_apart(kite):
    (tree,) = kite.trees.values()
    assert [(one["name"], one["id"]) for one in tree["messages"]] == [
        ("Orbit", 100), ("Wheels", 101), ("Sails", 101), ("Reboot", 101), ("SwitchOn", 101),
    ]  # fmt: skip
    assert field(kite, "Wheels", "Section Kind")["const"] == 1 and field(kite, "Sails", "Section Kind")["const"] == 2
    assert [one["name"] for one in message(kite, "Orbit")["fields"]] == [
        "Elapsed", "Position x", "Position y", "Position z", "Shadow",
    ]  # fmt: skip


def test_xtce_a_container_that_only_others_are_based_on_is_a_note_and_no_missing_message(kite):
    assert findings(kite) == [("IMP087", "note")] and kite.held == kite.definitions.total == 5
    assert "`TelemetryPacket`" in kite.definitions.troubles[0].message


def test_xtce_a_command_container_without_a_base_continues_that_of_the_base_command(kite):
    assert message(kite, "Reboot")["fields"] == [{"at": 0, "bits": 16, "name": "Packet_ID", "type": "uint", "const": 1}]
    assert [one["name"] for one in message(kite, "SwitchOn")["fields"]] == ["Packet_ID", "Battery"]


def edited(tmp_path, *changes):
    text = (SHAPES / "aggregate.xml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "kite.xml").write_text(text)
    return imported(tmp_path / "kite.xml")


def test_xtce_a_member_that_an_aggregate_does_not_have_costs_the_message_alone(tmp_path):
    read = edited(tmp_path, ('"Section/Kind"', '"Section/Sort"'))
    assert read.held == 4
    assert "`Sails` is not held: it is told by `Section/Sort`, which it does not have" in "".join(
        one.message for one in read.definitions.troubles
    )


def test_xtce_an_entry_may_be_a_member_of_an_aggregate(tmp_path):
    read = edited(tmp_path, ('"Wheel"/></EntryList>', '"Position/y"/></EntryList>'))
    assert message(read, "Wheels")["fields"][-1] == {"at": 104, "bits": 32, "name": "Position y", "type": "float"}


def test_xtce_a_packet_without_data_costs_itself_and_not_the_file(tmp_path):
    assigned = '<ArgumentAssignment argumentName="Packet_ID" argumentValue="{}"/>'
    entry = '<EntryList><ArgumentRefEntry argumentRef="Packet_ID"/></EntryList>'
    read = edited(tmp_path, (entry, "<EntryList/>"), (assigned.format(1), ""), (assigned.format(2), ""))
    assert read.held == 4 and "SwitchOn" in {one["name"] for one in read.trees["kite"]["messages"]}
    (lost,) = [one.message for one in read.definitions.troubles if one.severity == "error"]
    assert lost.startswith("message `Reboot` is not held: it has no data")


def test_xtce_a_header_of_which_only_parts_are_named_is_one(tmp_path):
    text = (SHAPES / "aggregate.xml").read_text()
    whole = re.search(r"<ParameterRefEntry parameterRef=\"Packet_Id\"/>.*?\"Packet_Length\"/>", text, re.DOTALL)[0]
    read = edited(
        tmp_path,
        (whole, placed("Packet_Id/APID", 5) + placed("Packet_Sequence/Count", 18)),
        ('<ParameterRefEntry parameterRef="Elapsed"/>', placed("Elapsed", 48)),
        ('<ParameterRefEntry parameterRef="Section"/>', placed("Section", 48)),
        ('<Comparison value="0" parameterRef="Packet_Id/Version"/>', ""),
        ('<Comparison value="TM" parameterRef="Packet_Id/Type"/>', ""),
        ('<Comparison value="NotPresent" parameterRef="Packet_Id/Secondary"/>', ""),
    )
    assert [one["id"] for one in read.trees["kite"]["messages"]] == [100, 101, 101, 101, 101]
    assert field(read, "Orbit", "Elapsed")["at"] == 0 and message(read, "Orbit")["length"] == 17


def test_xtce_a_field_within_the_header_is_left_out_with_a_finding(tmp_path):
    entry = '<ParameterRefEntry parameterRef="Shadow"/>'
    read = edited(tmp_path, (entry, entry + placed("Wheel", 25)))
    (lost,) = [one for one in read.definitions.troubles if one.severity == "error"]
    assert (lost.code, lost.message) == ("IMP086", "message `Orbit`: `Wheel` lies within the header")
    assert read.held == 5


def test_kaitai_types_without_a_sequence_and_sizes_of_0_have_no_bytes():
    read = imported(SHAPES / "cases.ksy")
    (tree,) = read.trees.values()
    assert findings(read) == [] and read.held == 3
    assert [(one["name"], one["length"]) for one in tree["messages"]] == [
        ("cases power", 5), ("cases nothing", 1), ("cases unknown", 1),
    ]  # fmt: skip
    assert [(one["name"], one["at"]) for one in message(read, "cases power")["fields"]] == [
        ("kind", 0), ("volts", 8), ("amps", 24),
    ]  # fmt: skip


def test_kaitai_instances_at_fixed_places_are_the_fields_of_a_format_without_a_sequence():
    read = imported(SHAPES / "places.ksy")
    assert findings(read) == []
    assert [(one["name"], one["at"]) for one in message(read, "places")["fields"]] == [
        ("x", 0),
        ("y", 16),
        ("tail", 48),
    ]


def test_kaitai_a_library_of_types_says_that_it_has_no_sequence(tmp_path):
    (tmp_path / "library.ksy").write_text("meta: {id: library}\ntypes:\n  one: {seq: [{id: x, type: u1}]}\n")
    with pytest.raises(Findings) as error:
        imported(tmp_path / "library.ksy")
    assert "it has no `seq`, and so no field" in error.value.findings[0].message
