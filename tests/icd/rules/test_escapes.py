"""Framing by escape characters: the first byte of each packet, and keys without
effect.
"""

from __future__ import annotations

import pytest

from icdgen.icd.rules import escapes  # noqa: F401
from tests.icd.rules.rows import messages, rows

KEYS = {
    "escape": "0x10",
    "start": "0x02",
    "end": "0x03",
    "data": "0x04",
    "other": "drop",
}


def link(
    *rest: str,
    order: str = "big, bit_order: msb0",
    framing: str = "by: escape, escape: 0x10, end: 0x03, data: 0x04",
) -> str:
    lines = "".join(f"    {line}\n" for line in rest)
    return (
        f"icdgen: 1\nnode: {{name: demo, title: Demo, byte_order: {order}}}\n"
        f"protocol:\n  link:\n    framing: {{{framing}}}\n{lines}"
    )


def telemetry(**ids: int) -> str:
    return "messages:\n" + "".join(
        f"  - {{name: {name}, id: {id}, kind: telemetry, length: 0}}\n"
        for name, id in ids.items()
    )


@pytest.mark.parametrize("key", KEYS)
def test_each_escape_character_needs_framing_by_escape(tmp_path, key):
    text = link(
        "header: [{bits: 8, role: id}]", framing=f"by: slip, {key}: {KEYS[key]}"
    )
    assert rows(tmp_path, text, "ICD196") == [
        f"5:25 `{key}` has no effect without `by: escape`"
    ]


@pytest.mark.parametrize("is_started", [True, False])
@pytest.mark.parametrize("id", [0x02, 0x03, 0x04, 0x05, 0x10, 0x11])
def test_the_first_byte_has_no_other_meaning_after_an_escape(tmp_path, id, is_started):
    framing = "by: escape, escape: 0x10, end: 0x03, data: 0x04"
    framing += ", start: 0x02" if is_started else ""
    header = "header: [{bits: 8, role: id}, {bits: 8, role: sequence}]"
    text = link(header, framing=framing) + telemetry(A=1, B=id)
    wrong = f"5:14 without `start`, no packet can begin with 0x{id:02X}, as that of `B` does"
    is_wrong = id in (0x03, 0x04, 0x10) and not is_started
    assert rows(tmp_path, text, "ICD196") == [wrong] * is_wrong


BITS = [
    # byte order, bit order, fields of the header, id, first byte
    ("big", "msb0", ["bits: 4, role: constant, value: 1", "bits: 4, role: id"], 0, 0x10),
    ("big", "msb0", ["bits: 4, role: id", "bits: 4, role: constant, value: 3"], 0, 0x03),
    ("little", "lsb0", ["bits: 4, role: id", "bits: 4, role: constant, value: 1"], 0, 0x10),
    ("little", "lsb0", ["bits: 4, role: constant, value: 0", "bits: 4, role: id"], 1, 0x10),
    # The first of several bytes.
    ("big", "msb0", ["bits: 16, role: id"], 0x0341, 0x03),
    ("little", "lsb0", ["bits: 16, role: id"], 0x4103, 0x03),
    ("little", "lsb0", ["bits: 16, role: id, byte_order: big"], 0x0341, 0x03),
    ("big", "msb0", ["bits: 16, role: sync, value: [0x04, 1]", "bits: 16, role: id"], 1, 0x04),
    ("little", "lsb0", ["bits: 16, role: sync, value: [0x04, 1]", "bits: 16, role: id"], 1, 0x04),
    # An id in two fields, the most significant bits first.
    ("big", "msb0", ["bits: 8, role: id", "bits: 8, role: id"], 0x1099, 0x10),
    ("big", "msb0", ["bits: 8, role: constant, value: 3", "bits: 8, role: id"], 1, 0x03),
]  # fmt: skip


@pytest.mark.parametrize(("byte_order", "bit_order", "fields", "id", "first"), BITS)
def test_the_first_byte_is_composed_of_ids_and_constants(
    tmp_path, byte_order, bit_order, fields, id, first
):
    order = f"{byte_order}, bit_order: {bit_order}, id_bits: 16"
    header = ", ".join(f"{{{field}}}" for field in fields)
    text = link(f"header: [{header}]", order=order) + telemetry(A=id)
    assert messages(tmp_path, text, "ICD196") == [
        f"without `start`, no packet can begin with 0x{first:02X}, as that of `A` does"
    ]


@pytest.mark.parametrize(
    ("header", "is_wrong"),
    [
        ("{bits: 8, role: id}", False),
        ("{bits: 7, role: id}, {bits: 1, role: flags}", True),
        ("{bits: 7, role: constant, value: 1}, {bits: 8, role: id}", False),
        ("{bits: 1, role: flags}, {bits: 8, role: id}", True),
        ("{bits: 8, role: sequence}, {bits: 8, role: id}", True),
    ],
)
def test_all_bits_of_the_first_byte_are_determined(tmp_path, header, is_wrong):
    text = link(f"header: [{header}]") + telemetry(A=0x55, B=0x56)
    wrong = (
        "5:14 without `start`, the first byte of packets must be an id or a constant"
    )
    assert rows(tmp_path, text, "ICD196") == [wrong] * is_wrong


def test_each_packet_is_reported_once(tmp_path):
    """With the first message, or for a packet without messages, any id."""
    packets = link(
        "packets:",
        "  data: {from: device, header: [{bits: 8, role: id}], messages: [A, B, C]}",
        "  fine: {from: device, header: [{bits: 8, role: constant, value: 9}, {bits: 8, role: id}], messages: [D]}",
        "  fixed: {from: device, header: [{bits: 8, role: constant, value: 3}, {bits: 8, role: id}], messages: [E]}",
        "  host: {from: host, header: [{bits: 8, role: id}]}",
    )
    assert rows(tmp_path, packets + telemetry(A=1, B=3, C=4, D=3, E=5), "ICD196") == [
        "7:20 without `start`, no packet can begin with 0x03, as that of `B` does",
        "9:21 without `start`, no packet can begin with 0x03, as that of `E` does",
        "10:20 without `start`, no packet can begin with 0x03, as that of `B` does",
    ]


def test_a_constant_can_differ_by_direction(tmp_path):
    header = "header: [{bits: 8, role: sync, value: {telecommand: 3, telemetry: 1}}, {bits: 8, role: id}]"
    text = link(header) + telemetry(A=9)
    text += "  - {name: Stop, id: 8, kind: telecommand, length: 0}\n"
    assert messages(tmp_path, text, "ICD196") == [
        "without `start`, no packet can begin with 0x03, as that of `Stop` does"
    ]


def test_a_link_without_messages_is_checked_with_the_id_0(tmp_path):
    text = link("header: [{bits: 4, role: constant, value: 1}, {bits: 4, role: id}]")
    assert messages(tmp_path, text, "ICD196") == [
        "without `start`, no packet can begin with 0x10, as that of each message does"
    ]


def test_a_link_without_messages_is_checked_by_its_constants(tmp_path):
    text = link("header: [{bits: 8, role: sync, value: 3}, {bits: 8, role: id}]")
    assert messages(tmp_path, text, "ICD196") == [
        "without `start`, no packet can begin with 0x03, as that of each message does"
    ]
