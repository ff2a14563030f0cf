"""Telecommands that, with their checksum, are telecommands of another program."""

from __future__ import annotations

import pytest

from icdgen.icd.rules import checksums  # noqa: F401
from tests.icd.files import codes
from tests.icd.rules.rows import messages, rows

HEAD = (
    "icdgen: 1\nnode: {{name: {0}, title: {0}, byte_order: little, bit_order: lsb0}}\n"
)
CRC = "kind: crc, width: {}, polynomial: 7, init: {}, reflect_in: false, reflect_out: false, xor_out: 0"
LINK = """\
protocol:
  link:
    buses: {{uart: {{line: {{baud_rate: 9600}}}}}}
    checksums: {{crc: {{{}}}}}
    packets:
      telecommand: {{from: host, trailer: [{{bits: {}, role: checksum, checksum: crc, covers: {{from: {}, to: data}}}}]}}
"""


def link(width: int = 8, init: str = "0", covers: str = "data", more: str = "") -> str:
    return LINK.format(CRC.format(width, init) + more, width, covers)


def command(name: str, id: int, length: int) -> str:
    field = (
        f", fields: [{{at: 0, bits: {length * 8}, name: Data, type: bytes}}]"
        if length
        else ""
    )
    return (
        f"  - {{name: {name}, id: {id}, kind: telecommand, length: {length}{field}}}\n"
    )


def programs(own: str, other: str, section: str, include: str = "[common.yaml]") -> str:
    """Return two programs, `demo` and `boot`, that include the file with the link."""
    return (
        f"include: [common.yaml]\nmessages:\n{own}"
        f"# boot.yaml\n{HEAD.format('boot')}include: {include}\nmessages:\n{other}"
        f"# common.yaml\n{HEAD.format('common')}{section}"
    )


@pytest.mark.parametrize("width", [8, 16, 32])
@pytest.mark.parametrize("longer", range(6))
def test_a_telecommand_is_longer_by_exactly_the_checksum(tmp_path, width, longer):
    text = programs(
        command("Reset", 7, 3), command("Deploy", 7, 3 + longer), link(width)
    )
    expected = "5:19 `Reset` of demo with its checksum is `Deploy` where boot runs"
    expected = expected.replace("5:19", "5:23")
    assert rows(tmp_path, text, "ICD108") == [expected] * (longer == width // 8)


def test_each_of_two_programs_is_compared_with_the_other(tmp_path):
    own = command("A", 7, 1) + command("B", 8, 3) + command("C", 9, 1)
    other = command("X", 7, 2) + command("Y", 8, 2) + command("C", 9, 2)
    assert rows(tmp_path, programs(own, other, link()), "ICD108") == [
        "boot.yaml:6:19 `Y` of boot with its checksum is `B` where demo runs",
        "5:19 `A` of demo with its checksum is `X` where boot runs",
    ]


def test_programs_without_a_common_protocol_section_do_not_share_a_line(tmp_path):
    own, other = command("A", 7, 1), command("X", 7, 2)
    text = programs(own, other, link(), include="[]")
    assert rows(tmp_path, text, "ICD108") == []


@pytest.mark.parametrize(
    ("section", "shown"),
    [
        (link(), "07 00,"),
        (link(init="0xAB"), "07 AB,"),
        (link(init="0xAB", more=", empty: 0xCD"), "07 CD,"),
        (link(init="0xA5").replace("xor_out: 0", "xor_out: 0xFF"), "07 5A,"),
        (
            link(init="0x13").replace("reflect_out: false", "reflect_out: true"),
            "07 C8,",
        ),
        (link(16), "07 0000,"),
        (link(covers="id"), "07 15,"),
        (link(covers="id", more=", empty: 0xCD"), "07 15,"),
    ],
)
def test_a_telecommand_without_data_is_shown_with_its_checksum(
    tmp_path, section, shown
):
    """The CRC with the polynomial 7 of the byte 7 is 0x15."""
    width = 2 if "width: 16" in section else 1
    text = programs(command("Reset", 7, 0), command("Deploy", 7, width), section)
    assert messages(tmp_path, text, "ICD108") == [
        f"`Reset` of demo with its checksum, {shown} is `Deploy` where boot runs"
    ]


def test_a_checksum_that_is_not_declared_has_only_its_own_finding(tmp_path):
    section = link().replace("checksum: crc,", "checksum: crd,")
    text = programs(command("Reset", 7, 0), command("Deploy", 7, 1), section)
    assert messages(tmp_path, text, "ICD108") == [
        "`Reset` of demo with its checksum is `Deploy` where boot runs"
    ]
    assert "ICD173" in codes(tmp_path, text)


def test_telemetry_has_no_part_in_it(tmp_path):
    section = link().replace("from: host", "from: device")
    text = programs(command("A", 7, 1), command("X", 7, 2), section)
    assert rows(tmp_path, text, "ICD108") == []
    both = link().replace("from: host", "from: both")
    text = programs(command("A", 7, 1), command("X", 7, 2), both)
    assert len(rows(tmp_path, text, "ICD108")) == 1
