"""Dialects of MAVLink become ICDs whose links and fields are those that pymavlink makes
of the same XML.
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
    reader = kinds.of(FILES / "rover.xml")
    assert isinstance(reader, mavlink.MavLink2)
    return run.read(FILES / "rover.xml", reader)


def test_fields_come_in_the_order_in_which_they_are_sent_and_extensions_behind_them(
    rover,
):
    drive = message(rover, "ROVER_DRIVE")
    assert [(one["at"], one["name"]) for one in drive["fields"]] == [
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


def test_units_that_say_a_factor_are_formulas_and_what_is_not_known_is_special(rover):
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


def test_enumerations_of_several_files_are_one_and_those_without_fields_are_none(rover):
    (tree,) = rover.trees.values()
    (mode,) = tree["enums"]
    assert [(one["value"], one["name"]) for one in mode["members"]] == [
        (0, "OFF"),
        (2, "MANUAL"),
        (8, "3D_DRIVE"),
    ]
    assert rover.identifiers == ["value `3D_DRIVE`: `value 3D_DRIVE`"]
    assert field(rover, "ROVER_DRIVE", "mode")["enum"] == "ROVER_MODE"
    assert [
        one["meaning"] for one in field(rover, "ROVER_DRIVE", "signed_mode")["special"]
    ] == [
        "OFF",
        "MANUAL",
        "3D_DRIVE",
    ]
    assert [(one.code, one.message) for one in rover.definitions.import_findings] == [
        (
            "IMP077",
            "enumeration `ROVER_MODE`: 2 is `ROVER_MODE_MANUAL` and `ROVER_MODE_BY_HAND`",
        ),
        ("IMP070", "message `ODD` is not imported: `value` is of the type `strange`"),
    ]


@pytest.mark.parametrize(("version", "reader"), READERS.items())
def test_seeds_names_places_and_lengths_are_those_of_pymavlink(version, reader):
    dialect = import_module(f"pymavlink.dialects.{version}.common")
    found = kinds.read(Path(dialect.__file__).with_suffix(".xml"), reader)
    (network,) = found.networks
    ours = {
        one["id"]: (
            one["name"],
            network.seeds[one["name"]],
            one["length"],
            [part["name"] for part in one["fields"]],
        )
        for one in network.messages
    }
    theirs = {
        one.id: (
            one.msgname,
            one.crc_extra,
            one.unpacker.size,
            list(one.ordered_fieldnames),
        )
        for one in dialect.mavlink_map.values()
    }
    assert ours == theirs and len(ours) == found.total > 100


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
def test_what_is_included_may_not_lead_astray(files, says, tmp_path):
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
    read = run.read(tmp_path / "rover.xml", kinds.get("mavlink1"))
    (tree,) = read.trees.values()
    assert [one["name"] for one in tree["messages"]] == [
        "HEARTBEAT"
    ] and "may_end_early" not in tree["messages"][0]
    assert (
        tree["protocol"]["link"]["header"][0]["value"] == 0xFE
        and tree["node"]["id_bits"] == 8
    )


def dialect(folder, *fields):
    """A dialect with a message of these fields."""
    (folder / "one.xml").write_text(
        f'<mavlink><messages><message id="1" name="STATE">{"".join(fields)}</message></messages></mavlink>'
    )
    return run.read(folder / "one.xml", READERS["v20"])


@pytest.mark.parametrize("length", [1, 2])
def test_of_a_message_of_one_byte_nothing_can_be_cut_off(length, tmp_path):
    fields = (
        f'<field type="uint8_t" name="part{number}">A part.</field>'
        for number in range(length)
    )
    state = message(dialect(tmp_path, *fields), "STATE")
    assert (state["length"], state.get("may_end_early")) == (
        length,
        None if length == 1 else "zeros",
    )


def test_what_a_dialect_says_beyond_an_icd_is_reported(tmp_path):
    field = '<field type="uint8_t" name="mode" increment="2" units="m">Text.</field>'
    read = dialect(
        tmp_path,
        field,
        "<extensions/>",
        '<field type="uint8_t" name="more">More.</field>',
        "<wip/>",
    )
    assert [(one.code, one.message) for one in read.definitions.import_findings] == [
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
