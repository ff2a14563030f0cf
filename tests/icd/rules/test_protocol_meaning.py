"""Rules about ranges of ids, names of buses, and messages that fit a CAN packet."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.icd.files import loaded
from tests.icd.rules.marked import reported
from tests.limits import assert_limits


def ids(bit: int | None, commands: tuple, telemetry: tuple) -> str:
    """Return an ICD with (direction, first id, last id) of telecommands and telemetry."""
    lines = ["protocol:", "  link:", "    ids:"]
    lines += [f"      direction_bit: {bit}"] * (bit is not None)
    for name, row in (("telecommand", commands), ("telemetry", telemetry)):
        keys = zip(("direction", "first", "last"), row, strict=True)
        pairs = ", ".join(f"{key}: {value}" for key, value in keys if value is not None)
        lines.append(f"      {name}: {{{pairs}}}")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("bit", "commands", "telemetry", "expected"),
    [
        (7, (0, 0, 127), (1, 128, 255), []),
        (0, (0, 4, 4), (1, 5, 5), []),
        (7, (0, 0, 128), (1, 129, 255), [
            ("128", "the range contains 128, whose bit 7 is 1; in a telecommand id it is 0"),
        ]),
        (7, (0, 0, 126), (1, 127, 255), [
            ("127", "the range contains 127, whose bit 7 is 0; in a telemetry id it is 1"),
        ]),
        (0, (0, 8, 20), (1, 31, 31), [
            ("20", "the range contains 9, whose bit 0 is 1; in a telecommand id it is 0"),
        ]),
        (7, (0, 5, 4), (1, 200, 0xC7), [
            ("4", "the last id, 4, comes before the first, 5"),
            ("199", "the last id, 199, comes before the first, 200"),
        ]),
        (None, (0, 0, 10), (1, 10, 20), [
            ("10", "id 10 is in the range of telecommands, too"),
        ]),
        (None, (0, 0, 11), (1, 10, 20), [
            ("10", "ids 10 to 11 are in the range of telecommands, too"),
        ]),
        (None, (0, 10, 20), (1, 0, 30), [
            ("0", "ids 10 to 20 are in the range of telecommands, too"),
        ]),
        (None, (0, 0, 9), (1, 10, 20), []),
        (None, (0, 21, 30), (1, 10, 20), []),
    ],
)  # fmt: skip
def test_a_range_of_ids_determines_the_direction(
    bit, commands, telemetry, expected, tmp_path
):
    assert reported(tmp_path, ids(bit, commands, telemetry), "ICD103") == expected


def test_numbers_of_a_range_keep_their_spelling(tmp_path):
    text = ids(7, (0, "0x10", "0x0F"), (1, 128, 255))
    assert reported(tmp_path, text, "ICD103") == [
        ("0x0F", "the last id, 0x0F, comes before the first, 0x10")
    ]


NUMBERS = st.integers(0, 40)


@given(st.integers(0, 6), *[st.tuples(st.integers(0, 1), NUMBERS, NUMBERS)] * 2)
@settings(max_examples=40, deadline=None)
def test_ranges_are_reported_as_often_as_their_ids_contradict(
    tmp_path_factory, bit, commands, telemetry
):
    folder = tmp_path_factory.getbasetemp()
    expected = 0
    for direction, first, last in (commands, telemetry):
        expected += first > last
        expected += any(id >> bit & 1 != direction for id in range(first, last + 1))
    both = {*range(commands[1], commands[2] + 1)} & {
        *range(telemetry[1], telemetry[2] + 1)
    }
    expected += bool(both)
    assert len(reported(folder, ids(bit, commands, telemetry), "ICD103")) == expected


@pytest.mark.parametrize(
    "link",
    [
        "packets: {one: {from: host, buses: [uart, can, i2c]}}, buses: {uart: {line: {baud_rate: 9600}}}",
        "packets: {one: {from: host, buses: [can]}, two: {from: device, buses: [uart, i2c]}}, "
        "buses: {uart: {line: {baud_rate: 9600}}}",
    ],
)
def test_each_bus_of_each_packet_is_declared(link, tmp_path):
    text = f"protocol:\n  link: {{{link}}}\nmessages: []\n"
    assert reported(tmp_path, text, "ICD106") == [
        ("can", "`link: buses` has no `can`"),
        ("i2c", "`link: buses` has no `i2c`"),
    ]


def test_a_bus_can_be_declared_by_a_node_that_includes_the_packets(tmp_path):
    part = """\
# parts/base.yaml
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
protocol: {link: {packets: {one: {from: host, type: 1, buses: [can, uart]}}}}
"""
    own = "include: [parts/base.yaml]\nprotocol: {link: {buses: {can: {max_data_bytes: 8}}}}\n"
    findings = loaded(tmp_path, own + part).findings
    assert [(f.message, f.help) for f in findings if f.code == "ICD106"] == [
        ("`link: buses` has no `uart`", "add it, or remove `uart`")
    ]


def can(length: int, *, keys: str = "", kind: str = "telemetry", bus: str = "") -> str:
    id = "set_id: 1, get_id: 130" if kind == "configuration" else "id: 130"
    field = f"{{at: 0, bits: {8 * length}, name: Data, type: bytes}}"
    parts = "".join(
        f"          - {{name: {role}, role: {role}, bits: {bits}}}\n"
        for role, bits in (
            ("type", 5),
            ("channel", 8),
            ("source", 8),
            ("destination", 8),
        )
    )
    return f"""\
protocol:
  link:
    packets:
      Command: {{from: host, type: 1, buses: [can]}}
      Long: {{from: host, type: 2, buses: [can], segment_of: Command}}
      Frame: {{from: device, type: 3, buses: [can]}}
    buses:
{bus}      can:
{keys}        identifier:
{parts}messages:
  - {{name: Data, kind: {kind}, {id}, length: {length}, fields: [{field}]}}
"""


SEGMENTS = "        segments: {data_bytes: 7, packets_left_byte: 7}\n"


@pytest.mark.parametrize(
    ("keys", "most"), [("", 8), ("        max_data_bytes: 5\n", 5)]
)
@pytest.mark.parametrize("kind", ["telemetry", "telecommand", "configuration"])
def test_a_message_fits_a_packet(keys, most, kind, tmp_path):
    def rows(length: int) -> list[tuple[str, str]]:
        return reported(tmp_path, can(length, keys=keys, kind=kind), "ICD107")

    assert_limits(lambda length: not rows(length), most=most)
    message = f"`Data` has {most + 1} bytes, but a packet has up to {most}"
    assert rows(most + 1) == [(str(most + 1), message)]


@pytest.mark.parametrize("kind", ["telemetry", "telecommand", "configuration"])
def test_only_directions_with_segments_have_longer_messages(kind, tmp_path):
    """A configuration is sent in both directions."""
    rows = reported(tmp_path, can(9, keys=SEGMENTS, kind=kind), "ICD107")
    assert bool(rows) == (kind != "telecommand")
    whole = can(9, keys=SEGMENTS, kind=kind).replace(
        "Long: {from: host", "Long: {from: device"
    )
    whole = whole.replace("segment_of: Command", "segment_of: Frame")
    assert bool(reported(tmp_path, whole, "ICD107")) == (kind != "telemetry")


@pytest.mark.parametrize(
    "bus", ["uart: {line: {baud_rate: 9600}}", "i2c: {write: {address_7bit: 3}}"]
)
def test_a_message_that_is_too_long_for_can_can_use_another_bus(bus, tmp_path):
    assert reported(tmp_path, can(9, bus=f"      {bus}\n"), "ICD107") == []


def test_messages_of_a_direction_without_a_packet_are_not_sent_on_can(tmp_path):
    text = can(9).replace("      Frame: {from: device, type: 3, buses: [can]}\n", "")
    assert reported(tmp_path, text, "ICD107") == []


def test_an_included_message_is_reported_once(tmp_path):
    base = can(9)
    part = "# parts/base.yaml\nicdgen: 1\nnode: {name: base, title: Base, byte_order: little, bit_order: lsb0}\n"
    other = part.replace("base", "other").replace("parts/", "")
    other += "include: [parts/base.yaml]\n"
    text = f"include: [parts/base.yaml]\n{part}{base}{other}"
    codes = [f.code for f in loaded(tmp_path, text).findings]
    assert codes.count("ICD107") == 1
