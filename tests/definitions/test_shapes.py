"""Definitions with features of public files become ICDs without losing a message.

`python -m tests.xtce.shapes` compares the values with Yamcs, `python -m tests.devices`
with other libraries.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from icdgen.definitions import kinds, packets, run
from icdgen.diagnostics import Findings
from tests.definitions.test_can import FILES, field, message
from tests.importer.test_command import icdgen

SHAPES = FILES / "shapes"


def placed(name, at):
    """Return an entry with an explicit position."""
    location = f'<LocationInContainerInBits referenceLocation="containerStart"><FixedValue>{at}</FixedValue>'
    return f'<ParameterRefEntry parameterRef="{name}">{location}</LocationInContainerInBits></ParameterRefEntry>'


def imported(path):
    return run.read(path, kinds.reader_of_file(path))


def imported_set(*paths):
    files = [
        file_and_kind
        for path in paths
        for file_and_kind in (
            kinds.within(path)
            if path.is_dir()
            else [(path, kinds.reader_of_file(path))]
        )
    ]
    return {Path(read.definitions.file).name: read for read in run.read_set(files)}


def findings(read):
    return [
        (finding.code, finding.severity) for finding in read.definitions.import_findings
    ]


def errors(read):
    return [
        finding
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]


@pytest.fixture(scope="module")
def kite():
    return imported(SHAPES / "aggregate.xml")


def test_xtce_conditions_on_members_of_aggregates_are_discriminators(kite):
    (tree,) = kite.trees.values()
    assert [(message["name"], message["id"]) for message in tree["messages"]] == [
        ("Orbit", 100), ("Wheels", 101), ("Sails", 101), ("Reboot", 101), ("SwitchOn", 101),
    ]  # fmt: skip
    assert (
        field(kite, "Wheels", "Section Kind")["const"] == 1
        and field(kite, "Sails", "Section Kind")["const"] == 2
    )
    assert [field["name"] for field in message(kite, "Orbit")["fields"]] == [
        "Elapsed", "Position x", "Position y", "Position z", "Shadow",
    ]  # fmt: skip


def test_xtce_a_container_used_only_as_a_base_is_a_note_and_no_missing_message(
    kite,
):
    assert (
        findings(kite) == [("IMP087", "note")]
        and kite.imported == kite.definitions.total == 5
    )
    assert "`TelemetryPacket`" in kite.definitions.import_findings[0].message


def test_xtce_a_command_container_without_a_base_continues_that_of_the_base_command(
    kite,
):
    assert message(kite, "Reboot")["fields"] == [
        {"at": 0, "bits": 16, "name": "Packet_ID", "type": "uint", "const": 1}
    ]
    assert [field["name"] for field in message(kite, "SwitchOn")["fields"]] == [
        "Packet_ID",
        "Battery",
    ]


def edited(tmp_path, *changes):
    text = (SHAPES / "aggregate.xml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "kite.xml").write_text(text)
    return imported(tmp_path / "kite.xml")


def test_xtce_an_unknown_member_of_an_aggregate_removes_only_its_message(
    tmp_path,
):
    read = edited(tmp_path, ('"Section/Kind"', '"Section/Sort"'))
    assert read.imported == 4
    assert (
        "`Sails` is not imported: it depends on `Section/Sort`, which it does not have"
        in "".join(finding.message for finding in read.definitions.import_findings)
    )


def test_xtce_an_entry_may_be_a_member_of_an_aggregate(tmp_path):
    read = edited(tmp_path, ('"Wheel"/></EntryList>', '"Position/y"/></EntryList>'))
    assert message(read, "Wheels")["fields"][-1] == {
        "at": 104,
        "bits": 32,
        "name": "Position y",
        "type": "float",
    }


def test_xtce_a_packet_without_data_is_left_out_and_the_file_imported(tmp_path):
    assigned = '<ArgumentAssignment argumentName="Packet_ID" argumentValue="{}"/>'
    entry = '<EntryList><ArgumentRefEntry argumentRef="Packet_ID"/></EntryList>'
    read = edited(
        tmp_path,
        (entry, "<EntryList/>"),
        (assigned.format(1), ""),
        (assigned.format(2), ""),
    )
    assert read.imported == 4 and "SwitchOn" in {
        message["name"] for message in read.trees["kite"]["messages"]
    }
    (lost,) = [
        finding.message
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]
    assert lost.startswith("message `Reboot` is not imported: it has no data")


def test_xtce_a_header_may_have_named_parts_only(tmp_path):
    text = (SHAPES / "aggregate.xml").read_text()
    header = re.search(
        r"<ParameterRefEntry parameterRef=\"Packet_Id\"/>.*?\"Packet_Length\"/>",
        text,
        re.DOTALL,
    )[0]
    read = edited(
        tmp_path,
        (header, placed("Packet_Id/APID", 5) + placed("Packet_Sequence/Count", 18)),
        ('<ParameterRefEntry parameterRef="Elapsed"/>', placed("Elapsed", 48)),
        ('<ParameterRefEntry parameterRef="Section"/>', placed("Section", 48)),
        ('<Comparison value="0" parameterRef="Packet_Id/Version"/>', ""),
        ('<Comparison value="TM" parameterRef="Packet_Id/Type"/>', ""),
        ('<Comparison value="NotPresent" parameterRef="Packet_Id/Secondary"/>', ""),
    )
    assert [message["id"] for message in read.trees["kite"]["messages"]] == [
        100,
        101,
        101,
        101,
        101,
    ]
    assert (
        field(read, "Orbit", "Elapsed")["at"] == 0
        and message(read, "Orbit")["length"] == 17
    )


def test_xtce_a_field_within_the_header_is_left_out_with_a_finding(tmp_path):
    entry = '<ParameterRefEntry parameterRef="Shadow"/>'
    read = edited(tmp_path, (entry, entry + placed("Wheel", 25)))
    (lost,) = [
        finding
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]
    assert (lost.code, lost.message) == (
        "IMP086",
        "message `Orbit`: `Wheel` lies within the header",
    )
    assert read.imported == 5


def test_kaitai_types_without_a_sequence_and_sizes_of_0_have_no_bytes():
    read = imported(SHAPES / "cases.ksy")
    (tree,) = read.trees.values()
    assert findings(read) == [] and read.imported == 3
    assert [(message["name"], message["length"]) for message in tree["messages"]] == [
        ("cases power", 5), ("cases nothing", 1), ("cases unknown", 1),
    ]  # fmt: skip
    assert [(field["name"], field["at"]) for field in message(read, "cases power")["fields"]] == [
        ("kind", 0), ("volts", 8), ("amps", 24),
    ]  # fmt: skip


def test_kaitai_instances_at_fixed_places_are_the_fields_of_a_format_without_a_sequence():
    read = imported(SHAPES / "places.ksy")
    assert findings(read) == []
    assert [
        (field["name"], field["at"]) for field in message(read, "places")["fields"]
    ] == [
        ("x", 0),
        ("y", 16),
        ("tail", 48),
    ]


def test_kaitai_a_library_of_types_says_that_it_has_no_sequence(tmp_path):
    (tmp_path / "library.ksy").write_text(
        "meta: {id: library}\ntypes:\n  one: {seq: [{id: x, type: u1}]}\n"
    )
    with pytest.raises(Findings) as error:
        imported(tmp_path / "library.ksy")
    assert "it has no `seq`, and so no field" in error.value.findings[0].message


def test_xtce_files_that_refer_to_each_other_are_one_database_called_like_their_folder():
    (read,) = imported_set(SHAPES / "pus").values()
    assert findings(read) == [] and read.imported == read.definitions.total == 4
    (name, tree), = read.trees.items()  # fmt: skip
    assert name == "pus" and [(message["name"], message["id"]) for message in tree["messages"]] == [
        ("report", 7), ("alive", 7), ("connected", 7), ("ask alive", 7),
    ]  # fmt: skip
    assert field(read, "connected", "target") == {
        "at": 40,
        "bits": 8,
        "name": "target",
        "type": "uint",
    }
    assert [field["const"] for field in message(read, "ask alive")["fields"]] == [17, 1]


def test_xtce_files_that_do_not_refer_to_each_other_are_icds_of_their_own():
    reads = imported_set(SHAPES / "aggregate.xml", FILES / "probe.xml", SHAPES / "pus")
    assert {name for read in reads.values() for name in read.trees} == {
        "aggregate",
        "probe",
        "pus",
    }


def test_xtce_a_single_file_reports_missing_files_and_how_to_pass_them():
    with pytest.raises(Findings) as error:
        imported(SHAPES / "pus" / "test.xml")
    (finding,) = error.value.findings
    assert (
        "there is no container `/Service/report`" in finding.message
        and "icdgen import FILE FILE" in finding.help
    )


def test_xtce_two_files_that_define_one_name_are_reported_with_both(tmp_path):
    folder = shutil.copytree(SHAPES / "pus", tmp_path / "pus")
    (folder / "again.xml").write_text((folder / "service.xml").read_text())
    (read,) = imported_set(folder).values()
    lost = {error.message: error for error in errors(read)}
    finding = lost[
        "the container `/Service/report` is in `again.xml` and in `service.xml`"
    ]
    assert (finding.code, finding.help, finding.spot.line) == (
        "IMP076",
        "the first one is taken",
        23,
    )
    assert finding.spot.file.endswith("service.xml") and read.imported == 4


def test_eds_sheets_of_module_folders_find_types_and_design_parameters_of_each_other():
    reads = imported_set(SHAPES / "cfs")
    assert {file: read.imported for file, read in reads.items()} == {
        "config.xml": 0, "base_types.xml": 0, "packets.xml": 0, "pump.xml": 1, "lamp.xml": 1,
    }  # fmt: skip
    assert not any(errors(read) for read in reads.values())
    assert message(reads["lamp.xml"], "LampTlm")["fields"] == [
        {"at": 0, "bits": 16, "name": "Current", "type": "int"},
        {"at": 16, "bits": 8, "name": "State", "type": "enum", "enum": "Mode"},
    ]


def test_eds_aliases_stand_for_scalars_arrays_containers_and_bases():
    read = imported_set(SHAPES / "cfs")["pump.xml"]
    assert message(read, "PumpTlm")["fields"] == [
        {"at": 0, "bits": 8, "name": "State", "type": "enum", "enum": "Mode"},
        {"at": 8, "bits": 16, "name": "Levels", "type": "uint", "count": 3},
        {"at": 56, "bits": 16, "name": "Runs", "type": "uint"},
    ]


def test_eds_a_label_without_a_value_follows_the_one_before():
    (enum,) = imported_set(SHAPES / "cfs")["pump.xml"].trees["pump"]["enums"]
    assert [(member["name"], member["value"]) for member in enum["members"]] == [
        ("OFF", 0),
        ("SLOW", 4),
        ("FAST", 5),
    ]


def test_eds_an_alias_of_itself_removes_the_objects_that_use_it(tmp_path):
    folder = shutil.copytree(SHAPES / "cfs", tmp_path / "cfs")
    types = folder / "core" / "eds" / "base_types.xml"
    types.write_text(
        types.read_text().replace(
            'name="Counter" type="uint16"', 'name="Counter" type="Counter"'
        )
    )
    reads = imported_set(folder)
    (lost,) = errors(reads["pump.xml"])
    assert "is an alias of itself" in lost.message and reads["lamp.xml"].imported == 1


def test_eds_a_single_sheet_reports_missing_packages_and_how_to_pass_them():
    with pytest.raises(Findings) as error:
        imported(SHAPES / "cfs" / "lamp" / "eds" / "lamp.xml")
    (finding,) = error.value.findings
    assert (
        "is of the package `PACKETS`" in finding.message
        and "the folder of both" in finding.help
    )


def test_a_broken_file_of_a_set_is_left_out(tmp_path):
    folder = shutil.copytree(SHAPES / "pus", tmp_path / "pus")
    (folder / "broken.xml").write_text(
        '<SpaceSystem name="Broken"><TelemetryMetaData></SpaceSystem>'
    )
    reads = imported_set(folder)
    (lost,) = errors(reads["broken.xml"])
    assert lost.code == "IMP005" and lost.message.startswith("not XML")
    assert sum(read.imported for read in reads.values()) == 4


def test_a_folder_is_imported_by_the_command(tmp_path):
    shutil.copytree(SHAPES / "cfs", tmp_path / "cfs")
    result = icdgen("import", "cfs", cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert (
        "without messages of their own: cfs/config/eds/config.xml, cfs/core/eds/packets.xml"
        in result.stdout
    )
    assert sorted(path.name for path in (tmp_path / "icd").glob("*.yaml")) == [
        "lamp.yaml",
        "pump.yaml",
    ]
    report = json.loads(
        icdgen("import", "cfs", "--update", "--format", "json", cwd=tmp_path).stdout
    )
    assert {
        definition["definition"]: definition["held"]
        for definition in report["definitions"]
    }["cfs/pump/eds/pump.xml"] == 1
    assert [file["file"] for file in report["files"]] == [
        "icd/lamp.yaml",
        "icd/pump.yaml",
    ] and report["check"] == []


def test_definitions_that_cannot_be_imported_together_are_misuse(tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "manual.txt").write_text("A manual\n")
    shutil.copy(SHAPES / "cases.ksy", tmp_path)
    for arguments, why in (
        (["empty"], "there is no definition in the folder empty"),
        (["cases.ksy", "manual.txt"], "manual.txt is not a known definition"),
        (["cases.ksy", "lost.xml"], "lost.xml does not exist"),
        (
            ["empty", "--kind", "eds"],
            "there is no definition of the kind eds in the folder empty",
        ),
    ):
        result = icdgen("import", *arguments, cwd=tmp_path)
        assert result.returncode == 2 and why in result.stderr, result.stderr


def test_help_names_all_kinds(tmp_path):
    text = icdgen("import", "--help", cwd=tmp_path).stdout
    assert [name for name in kinds.names() if not re.search(rf"\b{name}\b", text)] == []


def unused(read):
    return [
        (finding.message, finding.spot.line)
        for finding in read.definitions.import_findings
        if finding.code == "IMP085"
    ]


def test_xtce_unused_content_is_a_note_with_its_line(tmp_path):
    alarm = '<DefaultAlarm><StaticAlarmRanges><CriticalRange maxInclusive="9"/></StaticAlarmRanges></DefaultAlarm>'
    type_ = '<IntegerParameterType name="u32_t" signed="false">'
    read = edited(
        tmp_path,
        (type_, type_ + alarm),
        (
            '<EntryList><ParameterRefEntry parameterRef="Sail"/>',
            "<RateInStream/><EntryList>",
        ),
    )
    assert unused(read) == [
        ("`DefaultAlarm` of `IntegerParameterType` is not used (`u32_t`)", 49),
        ("`parameterTypeRef` of `Parameter` is not used (`Sail`)", 62),
        ("`RateInStream` of `SequenceContainer` is not used (`Sails`)", 111),
    ]


def test_xtce_unused_content_of_a_set_names_its_file(tmp_path):
    folder = shutil.copytree(SHAPES / "pus", tmp_path / "pus")
    text = (folder / "types.xml").read_text()
    (folder / "types.xml").write_text(
        text.replace(
            '<IntegerParameterType name="uint8"',
            '<IntegerParameterType name="uint8" initialValue="3"',
        )
    )
    (read,) = imported_set(folder).values()
    (finding,) = read.definitions.import_findings
    assert (finding.code, finding.spot.line, Path(finding.spot.file).name) == (
        "IMP085",
        5,
        "types.xml",
    )
    assert (
        finding.message
        == "`initialValue` of `IntegerParameterType` is not used (`uint8`)"
    )


def test_eds_unused_content_is_a_note_in_its_file(tmp_path):
    folder = shutil.copytree(SHAPES / "cfs", tmp_path / "cfs")
    pump = folder / "pump" / "eds" / "pump.xml"
    pump.write_text(
        pump.read_text().replace(
            '<Entry name="State" type="State"/>',
            '<Entry name="State" type="State" priority="3"/>',
        )
    )
    reads = imported_set(folder)
    assert unused(reads["pump.xml"]) == [
        ("`priority` of `Entry` is not used (`State`)", 17)
    ]
    assert unused(reads["base_types.xml"]) == [
        ("`IntegerDataEncoding` of `IntegerDataType` is not used (`uint8`)", 5)
    ]
    assert unused(reads["lamp.xml"]) == []


def test_kaitai_unused_content_is_a_note_with_its_line(tmp_path):
    text = (SHAPES / "places.ksy").read_text()
    (tmp_path / "a.ksy").write_text(
        text.replace(
            "tail: {pos: 6, type: u2}", "tail: {pos: 6, type: u2, -orig-id: TL}"
        )
    )
    assert unused(imported(tmp_path / "a.ksy")) == [
        ("`-orig-id` of `instances` is not used (instances.tail)", 4)
    ]


def test_an_unsupported_header_is_left_out_and_the_messages_imported(monkeypatch):
    def fill(network, message, to, fill=packets.fill):
        fill(network, message, to)
        network.protocol["link"]["header"][-1]["plus"] = -40

    monkeypatch.setattr(packets, "fill", fill)
    read = imported(SHAPES / "aggregate.xml")
    (lost,) = errors(read)
    assert lost.code == "IMP070" and lost.message.startswith(
        "the header is not imported: the length of"
    )
    assert read.imported == 5 and "protocol" not in read.trees["aggregate"]


def test_xtce_a_field_of_unknown_size_removes_only_the_fields_after_it(tmp_path):
    text = '<StringParameterType name="text_t"><StringDataEncoding><SizeInBits><LeadingSize/></SizeInBits></StringDataEncoding></StringParameterType>'  # fmt: skip  # noqa: E501
    read = edited(
        tmp_path,
        ("</ParameterTypeSet>", f"{text}</ParameterTypeSet>"),
        (
            'name="Position" parameterTypeRef="vec3_t"',
            'name="Position" parameterTypeRef="text_t"',
        ),
    )
    (lost,) = errors(read)
    assert (lost.code, lost.spot.line) == ("IMP081", 83)
    assert (
        lost.message
        == "message `Orbit`: from `Position` on only bytes are imported: it has a length prefix"
    )
    assert read.imported == 5 and [(field["name"], field["type"]) for field in message(read, "Orbit")["fields"]] == [
        ("Elapsed", "uint"), ("Position", "bytes"),
    ]  # fmt: skip
    assert unused(read) and "`Shadow`" in "".join(text for text, _ in unused(read))


def test_xtce_the_discriminator_of_a_message_must_be_representable(tmp_path):
    read = edited(
        tmp_path, ('name="Kind" typeRef="u8_t"', 'name="Kind" typeRef="lost_t"')
    )
    why = "there is no parameter type `lost_t`"
    assert sorted(error.message for error in errors(read)) == [
        f"message `{name}` is not imported: it depends on `Section/Kind`, which is in or behind `Section`: {why}"
        for name in ("Sails", "Wheels")
    ]
    assert read.imported == 3
