"""Generated code decodes the devices of examples/devices as their libraries or data
sheets do.

Random frames are compared with the library of the protocol. If there is none, the
layout of the data sheet is programmed here.
"""

from __future__ import annotations

import json
import random
import re
import shutil
import struct
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
import yaml

from icdgen import codec
from icdgen.icd.build import plain
from icdgen.icd.fmt import format_text
from icdgen.icd.model import Icd
from icdgen.icd.places import places_in, scalars_in
from icdgen.loading import load
from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.languages import all_languages
from tests.conftest import ROOT
from tests.devices.agree import Agreement, compare
from tests.devices.definition import Definition, NotSupported, Values
from tests.devices.mavlink import _read as mavlink_reads

DEVICES = {
    path.stem: path for path in sorted((ROOT / "examples" / "devices").glob("*/*.yaml"))
}
LANGUAGES = [
    "python",
    *(
        name
        for name, tool in (("c", "gcc"), ("rust-debug", "cargo"))
        if shutil.which(tool)
    ),
]
FRAMES = 40


@cache
def devices() -> Icd:
    loaded = load(list(DEVICES.values()))
    assert loaded.findings == []
    return loaded.icd


@pytest.fixture(scope="module", params=LANGUAGES)
def testee(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Testee]:
    """The testee of all devices, built with the strictest flags of the conformance run."""
    built = Testee(
        build(
            all_languages()[request.param],
            devices(),
            tmp_path_factory.mktemp("devices"),
        ),
        timeout=300,
    )
    yield built
    built.close()


def decoded(testee: Testee, node: str, kind: str, id: int, data: bytes) -> Values:
    """Return the raw values of a frame."""
    request = {
        "op": "decode",
        "node": node,
        "kind": kind,
        "id": id,
        "bytes": data.hex(),
    }
    answer = json.loads(testee.ask([json.dumps(request).encode()])[0] or b"{}")
    assert answer["ok"], answer
    return answer["raw"]  # type: ignore[no-any-return]


@pytest.mark.parametrize("name", DEVICES)
def test_the_icd_is_without_findings_and_formatted(name: str) -> None:
    assert load([DEVICES[name]]).findings == []
    text = DEVICES[name].read_text("utf-8")
    assert format_text(text, DEVICES[name].name) == text


def definitions(node: str, reads: Callable[[str, bytes], Values]) -> list[Definition]:
    """Return the fixed-length messages of an ICD, with the library's decoder of each."""
    messages = []
    for message in devices().node(node).messages:
        fields = [
            plain(place.source)
            for place in places_in(message.layout)
            if not place.is_read_only
        ]
        scaled = {field["name"] for field in fields if "formula" in field}

        def read(data: bytes, name: str = message.name) -> Values:
            return reads(name, data)

        def raw(
            data: bytes,
            read: Callable[[bytes], Values] = read,
            scaled: set[str] = scaled,
        ) -> Values:
            return {
                key: value for key, value in read(data).items() if key not in scaled
            }

        def physical(
            data: bytes,
            read: Callable[[bytes], Values] = read,
            scaled: set[str] = scaled,
        ) -> Values:
            return {key: value for key, value in read(data).items() if key in scaled}

        if not message.layout.parts:
            id = message.ids[0]
            messages.append(
                Definition(
                    message.name,
                    id,
                    message.kind,
                    message.length,
                    fields,
                    raw=raw,
                    physical=physical,
                )
            )
    return messages


def assert_agreement(
    node: str, testee: Testee, reads: Callable[[str, bytes], Values]
) -> Agreement:
    agreement = Agreement()
    compare(node, definitions(node, reads), testee, FRAMES, 1, agreement)
    assert agreement.differences == []
    assert agreement.refused == 0
    return agreement


# MAVLink, by pymavlink

FACTORS = {"lat": 1e7, "lon": 1e7, "alt": 1e3, "eph": 100, "epv": 100, "vel": 100, "cog": 100, "alt_ellipsoid": 1e3,
           "h_acc": 1e3, "v_acc": 1e3, "vel_acc": 1e3, "hdg_acc": 1e5, "yaw": 100}  # fmt: skip


PARAMETERS = {
    "COMMAND_LONG, NAV_TAKEOFF": {
        "pitch": 1,
        "yaw": 4,
        "latitude": 5,
        "longitude": 6,
        "altitude": 7,
    },
    "COMMAND_LONG, DO_SET_MODE": {"mode": 1, "custom_mode": 2, "custom_submode": 3},
    "COMMAND_LONG, COMPONENT_ARM_DISARM": {"arm": 1, "force": 2},
    "COMMAND_LONG, SET_MESSAGE_INTERVAL": {
        "message_id": 1,
        "interval": 2,
        "response_target": 7,
    },
}


def mavlink_values(name: str, data: bytes) -> Values:
    from pymavlink.dialects.v20 import common

    message = next(
        kind
        for kind in common.mavlink_map.values()
        if kind.msgname == name.partition(",")[0]
    )
    values = mavlink_reads(common, message, data)
    if name == "GPS_RAW_INT":
        return {
            key: value / FACTORS[key] if key in FACTORS else value
            for key, value in values.items()
        }  # type: ignore[operator]
    if name == "COMMAND_LONG":
        values["param"] = [values[f"param{number}"] for number in range(1, 8)]
    return values | {
        key: values[f"param{number}"]
        for key, number in PARAMETERS.get(name, {}).items()
    }


def test_mavlink_is_read_as_by_pymavlink(testee: Testee) -> None:
    agreement = assert_agreement("mavlink", testee, mavlink_values)
    assert agreement.messages == 10 and agreement.values > 2500


def test_the_commands_of_mavlink_have_the_numbers_of_pymavlink() -> None:
    from pymavlink.dialects.v20 import common

    commands = [
        command
        for command in devices().node("mavlink").messages
        if command.name in PARAMETERS
    ]
    assert len(commands) == len(PARAMETERS) == 4
    for command in commands:
        number = next(
            field.const for field in command.fields if field.name == "command"
        )
        assert number == getattr(common, f"MAV_CMD_{command.name.partition(', ')[2]}")


def test_mavlink_frames_end_before_their_zeros(testee: Testee) -> None:
    assert decoded(testee, "mavlink", "telemetry", 30, b"\1")["time_boot_ms"] == 1
    assert (
        decoded(testee, "mavlink", "telemetry", 253, b"\4low")["text"]
        == b"low".ljust(50, b"\0").hex()
    )


# u-blox, by pyubx2


def ubx_message(name: str, data: bytes) -> Values:
    import pyubx2

    message = next(
        candidate
        for candidate in devices().node("ublox").messages
        if candidate.name == name
    )
    key = message.ids[0].to_bytes(2, "big")
    mode = pyubx2.GET if message.kind == "telemetry" else pyubx2.SET
    decoded = pyubx2.UBXMessage(key[:1], key[1:], mode, payload=data)
    if decoded.identity != name:
        raise NotSupported(decoded.identity)
    return {
        key: value for key, value in decoded.__dict__.items() if not key.startswith("_")
    }


def ubx_values(name: str, data: bytes) -> Values:
    values = ubx_message(name, data)
    if name == "MON-HW":
        values["VP"] = [_number(values[f"VP_{number:02}"]) for number in range(1, 18)]
        values |= {
            key: _number(value)
            for key, value in values.items()
            if isinstance(value, bytes)
        }
    if name == "NAV-HPPOSLLH":  # pyubx2 combines coarse and fine parts
        places = {
            "lon": (8, "i", 1e7),
            "lat": (12, "i", 1e7),
            "height": (16, "i", 0),
            "hMSL": (20, "i", 0),
        }
        places |= {
            "lonHp": (24, "b", 1e9),
            "latHp": (25, "b", 1e9),
            "heightHp": (26, "b", 10),
            "hMSLHp": (27, "b", 10),
        }
        for key, (at, form, per) in places.items():
            (raw,) = struct.unpack_from(f"<{form}", data, at)
            values[key] = raw / per if per else raw
    return values


def _number(value: object) -> object:
    return int.from_bytes(value, "little") if isinstance(value, bytes) else value


def test_ubx_is_read_as_by_pyubx2(testee: Testee) -> None:
    agreement = assert_agreement("ublox", testee, ubx_values)
    assert agreement.messages == 22 and agreement.values > 7000


def test_positions_of_high_precision_are_derived_as_by_pyubx2(testee: Testee) -> None:
    chance = random.Random(3)
    names = {
        "Longitude": ("lon", 9),
        "Latitude": ("lat", 9),
        "Height above Ellipsoid": ("height", 1),
        "Height above Sea": ("hMSL", 1),
    }
    for _ in range(FRAMES):
        data = chance.randbytes(36)
        theirs, ours = (
            ubx_message("NAV-HPPOSLLH", data),
            decoded(testee, "ublox", "telemetry", 0x0114, data),
        )
        for name, (key, digits) in names.items():
            assert round(_double(ours[name]), digits) == round(theirs[key], digits)  # type: ignore[call-overload]


def test_the_time_of_a_receiver_is_derived_from_weeks_and_seconds(
    testee: Testee,
) -> None:
    # iTOW in ms, fTOW in ns, week, leap seconds, valid flags, accuracy.
    data = struct.pack("<IihbBI", 302400000, -250000000, 2300, 18, 7, 20)
    ours = decoded(testee, "ublox", "telemetry", 0x0120, data)
    assert _double(ours["GPS Time"]) == 2300 * 604800 + 302400 - 0.25


def _double(bits: object) -> float:
    """Return the number whose bits are a raw value."""
    value: float = struct.unpack(">d", bytes.fromhex(str(bits)))[0]
    return value


@pytest.mark.parametrize("count", [0, 1, 3, 32, 64])
def test_the_satellites_of_a_ubx_frame_are_read_as_by_pyubx2(
    testee: Testee, count: int
) -> None:
    chance = random.Random(count)
    # `numSvs` is the sixth byte, and each satellite has 12 bytes.
    data = chance.randbytes(5) + bytes([count]) + chance.randbytes(2 + 12 * count)
    theirs, ours = (
        ubx_message("NAV-SAT", data),
        decoded(testee, "ublox", "telemetry", 0x0135, data),
    )
    names = [
        scalar.name for scalar in scalars_in(devices().node("ublox").structs[0].layout)
    ]
    assert len(names) == 26 and {
        key: ours[key] for key in ("iTOW", "version", "numSvs")
    } == {key: theirs[key] for key in ("iTOW", "version", "numSvs")}
    for index in range(64):
        mine = {name: ours[f"satellites[{index}].{name}"] for name in names}
        if index < count:
            read = {name: theirs[f"{name}_{index + 1:02}"] for name in names}
            assert mine == read | {"prRes": round(float(str(read["prRes"])) * 10)}
        else:
            assert set(mine.values()) == {0}  # not in the frame


@pytest.mark.parametrize("count", [0, 1, 3, 30])
def test_the_extensions_of_a_ubx_version_are_read_as_by_pyubx2(
    testee: Testee, count: int
) -> None:
    rows = [f"MOD=ANY-{number}".encode().ljust(30, b"\0") for number in range(count)]
    data = (
        b"EXT CORE 1.00".ljust(30, b"\0")
        + b"00190000".ljust(10, b"\0")
        + b"".join(rows)
    )
    theirs, ours = (
        ubx_message("MON-VER", data),
        decoded(testee, "ublox", "telemetry", 0x0A04, data),
    )
    for key in ("swVersion", "hwVersion"):
        assert bytes.fromhex(str(ours[key])).rstrip(b"\0") == theirs[key].rstrip(b"\0")  # type: ignore[attr-defined]
    assert ours["extension Count"] == count
    for index, row in enumerate(rows, 1):
        assert bytes.fromhex(str(ours[f"extension[{index - 1}]"])) == row
        assert theirs[f"extension_{index:02}"].rstrip(b"\0") == row.rstrip(b"\0")  # type: ignore[attr-defined]


def test_the_keys_of_a_ubx_configuration_are_the_bytes_that_pyubx2_makes_of_them(
    testee: Testee,
) -> None:
    import pyubx2

    message = pyubx2.UBXMessage.config_set(
        5, 1, [("CFG_RATE_MEAS", 250), ("CFG_NAVSPG_DYNMODEL", 4)]
    )
    ours = decoded(testee, "ublox", "telecommand", 0x068A, message.payload)
    assert [ours[key] for key in ("ram", "bbr", "flash", "action")] == [
        True,
        False,
        True,
        1,
    ]
    data = b"\x01\x00\x21\x30\xfa\x00" + b"\x21\x00\x11\x20\x04"
    assert bytes.fromhex(str(ours["cfgData"]))[: int(str(ours["cfgData Size"]))] == data


# BME280, by the layout of its registers in the data sheet


def test_the_bme280_is_decoded_as_in_its_data_sheet(testee: Testee) -> None:
    chance = random.Random(1)
    for _ in range(FRAMES):
        b = chance.randbytes(8)
        assert decoded(testee, "bme280", "telemetry", 0xF7, b) == {
            "Pressure": b[0] << 12 | b[1] << 4 | b[2] >> 4,
            "Temperature": b[3] << 12 | b[4] << 4 | b[5] >> 4,
            "Humidity": b[6] << 8 | b[7],
        }
        b = chance.randbytes(26)
        names = [
            "T1",
            "T2",
            "T3",
            "P1",
            *(f"P2 to P9[{number}]" for number in range(8)),
            "H1",
        ]
        assert decoded(testee, "bme280", "telemetry", 0x88, b) == dict(
            zip(names, struct.unpack("<HhhH8hxB", b), strict=True)
        )
        b = chance.randbytes(7)
        h4, h5 = b[3] << 4 | b[4] & 15, b[5] << 4 | b[4] >> 4
        assert decoded(testee, "bme280", "telemetry", 0xE1, b) == {
            "H2": struct.unpack("<h", b[:2])[0],
            "H3": b[2],
            "H4": h4 - (h4 >> 11 << 12),
            "H5": h5 - (h5 >> 11 << 12),
            "H6": struct.unpack("b", b[6:])[0],
        }


def test_a_bme280_with_fixed_coefficients_has_a_polynomial_of_temperature(
    tmp_path: Path,
) -> None:
    """The polynomial of docs/guides/example-devices.md gives 25.08 degrees.

    This is the example in the data sheet of the preceding sensor.
    """
    formula = re.search(
        r"^formula: (.*)$",
        (ROOT / "docs" / "guides" / "example-devices.md").read_text("utf-8"),
        re.MULTILINE,
    )
    assert formula
    tree = yaml.safe_load(DEVICES["bme280"].read_text("utf-8"))
    field = next(
        message for message in tree["messages"] if message["name"] == "Measurement"
    )["fields"][1]
    field |= {"formula": formula[1], "unit": "C"}
    (tmp_path / "bme280.yaml").write_text(json.dumps(tree), "utf-8")
    loaded = load([tmp_path / "bme280.yaml"])
    assert loaded.findings == []
    field = next(
        message
        for message in loaded.icd.node("bme280").messages
        if message.name == "Measurement"
    ).fields[1]
    assert field.name == "Temperature"
    physical = codec.physical_double(field, 519888)
    assert physical is not None and round(physical, 2) == 25.08


# P31u, by frames whose bytes were laid out by hand

POWER = ["Converters[0]", "Converters[1]", "Converters[2]", "Battery", "Inputs[0]", "Inputs[1]", "Inputs[2]",
         "From Panels", "From Battery"]  # fmt: skip
COUNTS = {"Currents": 6, "States": 8, "Time to On": 8, "Time to Off": 8, "Latch-ups": 6}
OUTPUTS = [
    f"{name}[{number}]" for name, count in COUNTS.items() for number in range(count)
]
WATCHDOGS = ["Time Left of I2C", "Time Left of Ground", "Pings Left[0]", "Pings Left[1]", "Resets by I2C",
             "Resets by Ground", "Resets by Pings[0]", "Resets by Pings[1]"]  # fmt: skip
BASICS = [
    "Boots",
    *(f"Temperatures[{number}]" for number in range(6)),
    "Boot Cause",
    "Battery Mode",
    "Tracking",
]
PARTS = {
    1: ("Power", ">9H2x", POWER),
    2: ("Outputs", ">6H8B8H8H6H", OUTPUTS),
    3: ("Watchdogs", ">IIBBIIII", WATCHDOGS),
    4: ("Basics", ">I6hBBB2x", BASICS),
}


def test_the_p31u_is_read_as_its_bytes_were_laid_out(testee: Testee) -> None:
    chance, frame, expected = random.Random(1), b"", {}
    for number, (part, form, names) in PARTS.items():
        data = chance.randbytes(struct.calcsize(form))
        values = {
            f"{part}.{name}": value
            for name, value in zip(names, struct.unpack(form, data), strict=True)
        }
        assert decoded(testee, "p31u", "telemetry", 0x0800 | number, data) == values
        frame, expected = frame + data, expected | values
    assert decoded(testee, "p31u", "telemetry", 0x0800, frame) == expected
    nominal = bytes.fromhex("0fa0 0fa0 0fa0 1f40 0000 012c 0000 012c 0064 0000")
    power = decoded(testee, "p31u", "telemetry", 0x0801, nominal)
    assert (
        power["Power.Converters[0]"],
        power["Power.Battery"],
        power["Power.Inputs[1]"],
    ) == (4000, 8000, 300)


def test_telecommands_of_the_p31u_have_the_bytes_of_its_manual(testee: Testee) -> None:
    on = decoded(testee, "p31u", "telecommand", 0x0900, b"\x41")
    assert {name for name, value in on.items() if value} == {
        "Battery Heater",
        "Channel 1",
    }
    assert decoded(testee, "p31u", "telecommand", 0x0A00, b"\2\1\xff\xfe") == {
        "Channel": 2,
        "State": 1,
        "Delay": -2,
    }
    assert decoded(testee, "p31u", "telecommand", 0x1000, b"\x78") == {"Key": 0x78}
    values = struct.unpack(
        ">BBbb8B8B8H8H3H", settings := random.Random(2).randbytes(58)
    )
    assert (
        tuple(decoded(testee, "p31u", "configuration", 0x1300, settings).values())
        == values
    )
