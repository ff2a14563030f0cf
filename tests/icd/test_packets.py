"""Rules about packets: what a checksum covers, counts of CAN packets, and lengths in
units.
"""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Finding
from tests.icd.files import findings

NODE = "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: big, bit_order: msb0}\n"


def reported(folder, text: str, code: str) -> list[Finding]:
    return [f for f in findings(folder, NODE + text) if f.code == code]


def message(name: str, id: int, kind: str, length: int) -> str:
    data = f"{{at: 0, bits: {8 * length}, name: Data, type: bytes}}"
    fields = f", fields: [{data}]" if length else ""
    return f"  - {{name: {name}, id: {id}, kind: {kind}, length: {length}{fields}}}\n"


STATE = "messages:\n" + message("State", 9, "telemetry", 2)
CHECKSUM = "{{bits: 8, role: checksum, checksum: sum, covers: {{from: {}, to: {}}}}}"


def link(header: list[str], trailer: list[str]) -> str:
    return (
        "protocol:\n  link:\n    framing: {by: slip}\n"
        f"    header: [{', '.join(header)}]\n    trailer: [{', '.join(trailer)}]\n"
        f"    checksums: {{sum: {{kind: sum, width: 8}}}}\n{STATE}"
    )


ROWS = ["id", "flags", "sequence"]


@pytest.mark.parametrize("at", range(4))
@pytest.mark.parametrize("first", range(3))
def test_a_checksum_in_the_header_ends_before_what_it_covers(at, first, tmp_path):
    rows = [f"{{bits: 8, role: {role}}}" for role in ROWS]
    header = [*rows[:at], CHECKSUM.format(ROWS[first], "data"), *rows[at:]]
    covers_itself = at > first
    messages = [f.message for f in reported(tmp_path, link(header, []), "ICD173")]
    assert messages == ["the checksum covers itself"] * covers_itself


@pytest.mark.parametrize("at", range(4))
@pytest.mark.parametrize("last", range(3))
def test_a_checksum_in_the_trailer_begins_after_what_it_covers(at, last, tmp_path):
    names = ["flags", "sequence", "Spare"]
    rows = [
        "{bits: 8, role: flags}",
        "{bits: 8, role: sequence}",
        "{bits: 8, name: Spare, role: constant, value: 0}",
    ]
    trailer = [*rows[:at], CHECKSUM.format("id", names[last]), *rows[at:]]
    text = link(["{bits: 8, role: id}"], trailer)
    messages = [f.message for f in reported(tmp_path, text, "ICD173")]
    assert messages == ["the checksum covers itself"] * (at <= last)


@pytest.mark.parametrize("bits", [1, 4, 7])
def test_a_checksum_covers_whole_bytes(bits, tmp_path):
    """A range that begins within a byte is an error, one that ends there is not."""
    header = [f"{{bits: {bits}, role: flags}}", f"{{bits: {8 - bits}, role: sequence}}",
              "{bits: 8, role: id}"]  # fmt: skip
    for first, expected in (
        ("flags", []),
        ("sequence", ["it begins within a byte"]),
        ("id", []),
    ):
        text = link(header, [CHECKSUM.format(first, "data")])
        messages = [f.message for f in reported(tmp_path, text, "ICD173")]
        assert messages == expected
    trailer = [*header[:2], CHECKSUM.format("id", "flags")]
    assert reported(tmp_path, link(header[2:], trailer), "ICD173") == []


def test_a_checksum_that_shares_a_byte_with_what_it_covers_covers_itself(tmp_path):
    half = "{bits: 4, role: flags}", "{bits: 4, role: sequence}"
    for is_shared, trailer in (
        (True, [half[0], CHECKSUM.format("id", "flags"), half[1]]),
        (False, [*half, CHECKSUM.format("id", "sequence")]),
    ):
        text = link(["{bits: 8, role: id}"], trailer)
        messages = [f.message for f in reported(tmp_path, text, "ICD173")]
        assert ("the checksum covers itself" in messages) == is_shared


def can(segments: str, *messages: str, max_bytes: int = 8) -> str:
    identifier = ", ".join(
        f"{{name: {role}, role: {role}, bits: {bits}}}"
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
      Command: {{from: host, buses: [can], type: 1}}
      Long Command: {{from: host, buses: [can], type: 2, segment_of: Command}}
      Frame: {{from: device, buses: [can], type: 3}}
    buses:
      can:
        max_data_bytes: {max_bytes}
        identifier: [{identifier}]
        segments: {{packets_left_byte: {max_bytes - 1}, {segments}}}
messages:
{"".join(messages)}"""


@pytest.mark.parametrize(
    ("size", "in_last", "most"),
    [(7, 0, 256 * 7), (7, 1, 255 * 7), (7, 200, 56 * 7), (1, 0, 256), (1, 246, 10)],
)
def test_the_packets_of_the_longest_message_can_be_counted(
    size, in_last, most, tmp_path
):
    for length in (most - 1, most, most + 1):
        text = can(
            f"data_bytes: {size}, packets_left_in_last: {in_last}",
            message("Load", 1, "telecommand", length),
        )
        faults = reported(tmp_path, text, "ICD099")
        if length <= most:
            assert faults == []
            continue
        packets = -(-length // size)
        assert [f.message for f in faults] == [
            f"`Load` takes {packets} CAN packets, the first with 256 left: a byte holds 255"
        ]
        assert faults[0].help.startswith(f"{most:,} bytes can be sent: ")


def test_messages_of_one_packet_and_of_the_device_are_not_counted(tmp_path):
    """Only telecommands are split here. Two packets cannot count down to 255."""
    for kind, length, expected in (
        ("telecommand", 8, 0),
        ("telecommand", 9, 1),
        ("telemetry", 9, 0),
    ):
        text = can(
            "data_bytes: 7, packets_left_in_last: 255",
            message("Load", 1, kind, length),
        )
        assert len(reported(tmp_path, text, "ICD099")) == expected


@pytest.mark.parametrize(
    ("in_last", "most", "first"),
    [(0, 256, None), (0, 257, 256), (255, 1, None), (255, 2, 256), (256, 1, 256)],
)
def test_a_maximum_of_packets_can_be_counted(in_last, most, first, tmp_path):
    text = can(
        f"data_bytes: 7, packets_left_in_last: {in_last}, max_packets: {most}, "
        f"max_bytes: {7 * most}"
    ).replace("messages:\n", "")
    faults = [(f.message, f.help) for f in reported(tmp_path, text, "ICD099")]
    packets = f"{most} packet{'s' * (most > 1)}"
    assert faults == (
        [
            (
                f"the first of {packets} would count {first} left, a byte holds 255",
                f"correct `packets_left_in_last`, or `max_packets`: at most {256 - in_last}",
            )
        ]
        if first
        else []
    )


@pytest.mark.parametrize(
    ("counts", "around"), [("data", 0), ("message", 3)], ids=["data", "message"]
)
@pytest.mark.parametrize("unit", [2, 4])
def test_a_length_in_units_needs_messages_of_whole_units(
    counts, around, unit, tmp_path
):
    """The header has three bytes, which `counts: message` includes."""
    for length in range(1, 10):
        text = f"""\
protocol:
  link:
    framing: {{by: slip}}
    header:
      - {{bits: 8, role: id}}
      - {{bits: 8, role: flags}}
      - {{bits: 8, role: length, counts: {counts}, unit: {unit}}}
messages:
{message("State", 9, "telemetry", length)}"""
        messages = [f.message for f in reported(tmp_path, text, "ICD188")]
        size = length + around
        of_state = (
            "1 byte of `State` is" if size == 1 else f"{size} bytes of `State` are"
        )
        expected = f"the {of_state} not a multiple of the unit {unit}"
        assert messages == [expected] * (size % unit > 0)
