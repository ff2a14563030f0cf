"""MAVLink dialects become ICDs whose links and fields agree with what pymavlink reads
from the same XML.
"""

from __future__ import annotations

import shutil
from importlib import import_module
from pathlib import Path

import pytest

from icdgen.definitions import kinds, mavlink, run
from icdgen.diagnostics import Findings
from tests.definitions.test_can import FILES, field, message

READERS = {"v20": mavlink.MavLink2(), "v10": mavlink.MavLink1()}


@pytest.fixture(scope="module")
def rover():
    reader = kinds.reader_of_file(FILES / "rover.xml")
    assert isinstance(reader, mavlink.MavLink2)
    return run.read(FILES / "rover.xml", reader)


def test_fields_have_the_order_on_the_wire_followed_by_extensions(
    rover,
):
    drive = message(rover, "ROVER_DRIVE")
    assert [(field["at"], field["name"]) for field in drive["fields"]] == [
        (0, "lat"), (32, "yaw"), (64, "currents"), (112, "eph"), (128, "mode"), (136, "name"), (216, "signed_mode"),
        (224, "odometer"),
    ]  # fmt: skip
    assert (drive["length"], drive["may_end_early"], drive["group"]) == (
        32,
        "zeros",
        "rover",
    )
    assert drive["summary"] == "What drives."
    assert (
        message(rover, "HEARTBEAT")["summary"]
        == "Deprecated since 2026-01, replaced by NOTHING."
    )


def test_units_with_a_factor_become_formulas_and_invalid_markers_become_special_values(
    rover,
):
    lat, currents, yaw = (
        field(rover, "ROVER_DRIVE", name) for name in ("lat", "currents", "yaw")
    )
    assert (lat["unit"], lat["formula"], lat["special"]) == (
        "deg",
        "raw*1e-7",
        [{"value": 2**31 - 1, "meaning": "not known"}],
    )
    assert (currents["count"], currents["unit"], currents["formula"]) == (
        3,
        "A",
        "raw*0.01",
    )
    assert field(rover, "ROVER_DRIVE", "eph")["formula"] == "raw*1e-2"
    assert (
        yaw["special"] == [{"value": "nan", "meaning": "not known"}]
        and "formula" not in yaw
    )
    assert (
        field(rover, "ROVER_DRIVE", "name")["type"],
        field(rover, "ROVER_DRIVE", "name")["bits"],
    ) == ("text", 80)
    assert field(rover, "HEARTBEAT", "mavlink_version")["const"] == 3


def test_enumerations_are_merged_across_files_and_unused_ones_left_out(rover):
    (tree,) = rover.trees.values()
    (mode,) = tree["enums"]
    assert [(member["value"], member["name"]) for member in mode["members"]] == [
        (0, "OFF"),
        (2, "MANUAL"),
        (8, "3D_DRIVE"),
    ]
    assert rover.identifiers == ["value `3D_DRIVE`: `value 3D_DRIVE`"]
    assert field(rover, "ROVER_DRIVE", "mode")["enum"] == "ROVER_MODE"
    assert [
        value["meaning"]
        for value in field(rover, "ROVER_DRIVE", "signed_mode")["special"]
    ] == [
        "OFF",
        "MANUAL",
        "3D_DRIVE",
    ]
    assert [
        (finding.code, finding.message) for finding in rover.definitions.import_findings
    ] == [
        (
            "IMP077",
            "enumeration `ROVER_MODE`: 2 is `ROVER_MODE_MANUAL` and `ROVER_MODE_BY_HAND`",
        ),
        ("IMP070", "message `ODD` is not imported: `value` is of the type `strange`"),
    ]


@pytest.mark.parametrize(("version", "reader"), READERS.items())
def test_seeds_names_positions_and_lengths_equal_those_of_pymavlink(version, reader):
    dialect = import_module(f"pymavlink.dialects.{version}.common")
    definitions = kinds.read(Path(dialect.__file__).with_suffix(".xml"), reader)
    (network,) = definitions.networks
    ours = {
        message["id"]: (
            message["name"],
            network.seeds[message["name"]],
            message["length"],
            [part["name"] for part in message["fields"]],
        )
        for message in network.messages
    }
    theirs = {
        message_class.id: (
            message_class.msgname,
            message_class.crc_extra,
            message_class.unpacker.size,
            list(message_class.ordered_fieldnames),
        )
        for message_class in dialect.mavlink_map.values()
    }
    assert ours == theirs and len(ours) == definitions.total > 100


@pytest.mark.parametrize(
    ("files", "says"),
    [
        (
            {"a.xml": "<include>b.xml</include>", "b.xml": "<include>a.xml</include>"},
            "in a circle: a.xml -> b.xml -> a.xml",
        ),
        ({"a.xml": "<include>a.xml</include>"}, "in a circle: a.xml -> a.xml"),
        (
            {"a.xml": "<include>b.xml</include>"},
            "`b.xml`, which it includes, is not in its folder",
        ),
        (
            {"a.xml": "<include>../../etc/passwd</include>"},
            "`../../etc/passwd`, which it includes, is not in its folder",
        ),
        (
            {"a.xml": "<include>b.xml</include>", "b.xml": "<messages>"},
            "not XML: mismatched tag",
        ),
        ({"a.xml": "<messages/>"}, "no message can be imported, for none is defined"),
    ],
)
def test_includes_outside_the_folder_or_in_a_cycle_are_refused(files, says, tmp_path):
    for name, text in files.items():
        (tmp_path / name).write_text(f"<mavlink>{text}</mavlink>")
    with pytest.raises(Findings) as raised:
        run.read(tmp_path / "a.xml", READERS["v20"])
    (finding,) = raised.value.findings
    assert finding.code == "IMP005" and says in finding.message


def test_many_files_are_refused(tmp_path):
    for number in range(mavlink.MOST_FILES + 1):
        (tmp_path / f"{number}.xml").write_text(
            f"<mavlink><include>{number + 1}.xml</include></mavlink>"
        )
    with pytest.raises(Findings) as raised:
        run.read(tmp_path / "0.xml", READERS["v20"])
    assert "more than 100 files" in raised.value.findings[0].message


def test_version_1_has_ids_of_a_byte_and_no_extensions(tmp_path):
    for name in ("rover.xml", "rover_common.xml"):
        shutil.copy(FILES / name, tmp_path)
    read = run.read(tmp_path / "rover.xml", kinds.reader_of_kind("mavlink1"))
    (tree,) = read.trees.values()
    assert [message["name"] for message in tree["messages"]] == [
        "HEARTBEAT"
    ] and "may_end_early" not in tree["messages"][0]
    assert (
        tree["protocol"]["link"]["header"][0]["value"] == 0xFE
        and tree["node"]["id_bits"] == 8
    )


def dialect(folder, *fields):
    """Return a dialect with a message of these fields."""
    (folder / "one.xml").write_text(
        f'<mavlink><messages><message id="1" name="STATE">{"".join(fields)}</message></messages></mavlink>'
    )
    return run.read(folder / "one.xml", READERS["v20"])


@pytest.mark.parametrize("length", [1, 2])
def test_a_message_of_one_byte_cannot_end_early(length, tmp_path):
    fields = (
        f'<field type="uint8_t" name="part{number}">A part.</field>'
        for number in range(length)
    )
    state = message(dialect(tmp_path, *fields), "STATE")
    assert (state["length"], state.get("may_end_early")) == (
        length,
        None if length == 1 else "zeros",
    )


def test_statements_that_an_icd_cannot_represent_are_reported(tmp_path):
    field = '<field type="uint8_t" name="mode" increment="2" units="m">Text.</field>'
    read = dialect(
        tmp_path,
        field,
        "<extensions/>",
        '<field type="uint8_t" name="more">More.</field>',
        "<wip/>",
    )
    assert [
        (finding.code, finding.message) for finding in read.definitions.import_findings
    ] == [
        ("IMP085", "`increment` of `field` is not used (`mode`)"),
        ("IMP085", "`wip` of `message` is not used (`STATE`)"),
    ]


def test_an_enumeration_of_two_files_has_the_first_description(tmp_path):
    def enum(value: int, description: str) -> str:
        entry = f'<entry value="{value}" name="MODE_{value}A"/>'
        text = f"<description>{description}</description>" if description else ""
        return f'<enums><enum name="MODE">{text}{entry}</enum></enums>'

    field = '<field type="uint8_t" name="mode" enum="MODE">Mode.</field>'
    body = f'<messages><message id="1" name="STATE">{field}</message></messages>'
    for first, second, summary in (
        ("Of one.", "Of two.", "Of one."),
        ("", "Of two.", "Of two."),
        ("Of one.", "", "Of one."),
    ):
        (tmp_path / "one.xml").write_text(
            f"<mavlink><include>two.xml</include>{enum(1, first)}{body}</mavlink>"
        )
        (tmp_path / "two.xml").write_text(f"<mavlink>{enum(2, second)}</mavlink>")
        (tree,) = run.read(tmp_path / "one.xml", READERS["v20"]).trees.values()
        (mode,) = tree["enums"]
        assert mode["summary"] == summary
