"""The pages show the bytes of a message on each bus."""

from __future__ import annotations

import re
from dataclasses import replace

from icdgen.backends.html import wire
from icdgen.backends.html.relations import Relations
from icdgen.loading import load
from icdgen.runtime_objects.links import link_of
from tests import links
from tests.conformance.icds import LINKS


def lines(icd, node: str, name: str, data: bytes) -> dict[str, list[tuple[str, str]]]:
    message = next(m for m in icd.node(node).messages if m.name == name)
    buses = wire.buses(message, Relations(icd).wire(message), data)
    return {
        bus.name: [
            (line.label, " ".join(c.text for c in line.chunks)) for line in bus.lines
        ]
        for bus in buses
    }


def test_a_telecommand_has_its_bytes_on_each_bus(shipped):
    lines_by_bus = lines(shipped, "cubeacp", "ASGP4 Run Mode", b"\x1f")
    assert lines_by_bus["UART"][0] == ("Telecommand", "1F 7F 1F 1F 1F 1F 1F FF")
    assert lines_by_bus["I²C"][0] == ("Telecommand", "AE 1F 1F")
    assert lines_by_bus["CAN"] == [("Telecommand", "011F0001 1F")]


def test_an_optional_checksum_covers_the_parameters(shipped):
    lines_by_bus = lines(shipped, "cubeacp", "Trigger ADCS Loop", b"")
    assert lines_by_bus["UART"] == [
        ("Telecommand", "1F 7F 12 1F FF"),
        ("with CRC", "1F 7F 12 FF 1F FF"),
    ]


def test_the_bytes_follow_the_id_rules_of_the_icd(shipped):
    message = next(
        m for m in shipped.node("cubeacp").messages if m.name == "ASGP4 Run Mode"
    )
    facts, section, _, checked = Relations(shipped).wire(message)
    covering = [
        replace(
            checked_bus.facts,
            checksum=replace(checked_bus.facts.checksum, covers_id=True),
        )
        for checked_bus in checked
    ]
    plain = replace(facts, framing=replace(facts.framing, escapes_id=False))
    speakers = [
        wire.Speaker(facts, section, link_of(shipped, facts)) for facts in covering
    ]
    other = wire.Wire(plain, section, link_of(shipped, plain), speakers)
    uart = wire.buses(message, other, b"\x1f")[0]
    texts = [" ".join(chunk.text for chunk in line.chunks) for line in uart.lines]
    form = covering[0].checksum.algorithm.crc
    check, of_data = links.crc(form, b"\x1f\x1f"), links.crc(form, b"\x1f")
    assert texts == ["1F 7F 1F 1F 1F 1F FF", f"1F 7F 1F 1F 1F {check:02X} 1F FF"]
    assert check != of_data


def test_a_telemetry_frame_has_its_bytes_on_each_bus(shipped):
    lines_by_bus = lines(
        shipped, "cubeacp", "Estimated Attitude Angles", bytes.fromhex("2efb1f000000")
    )
    assert lines_by_bus["UART"] == [
        ("Request", "1F 7F 92 1F FF"),
        ("Answer", "1F 7F 92 2E FB 1F 1F 00 00 00 1F FF"),
    ]
    assert lines_by_bus["I²C"][0] == (
        "Request and answer",
        "AE 92 repeated start AF 2E FB 1F 00 00 00",
    )
    assert lines_by_bus["CAN"] == [
        ("Request", "04920001"),
        ("Answer", "05920100 2E FB 1F 00 00 00"),
    ]


def test_telemetry_with_a_checksum_on_the_uart_shows_it():
    icd = load([LINKS / "battery.yaml"]).icd
    form = Relations(icd).wire(icd.nodes[0].messages[3]).facts.checksum.algorithm.crc
    check = links.crc(form, b"\x83\x04").to_bytes(2, "big").hex(" ").upper()
    assert lines(icd, "battery", "Last Error", b"\x04") == {
        "UART": [
            ("Request", "1F 7F 83 1F FF"),
            ("Answer", "1F 7F 83 04 1F FF"),
            ("with CRC", f"1F 7F 83 04 {check} 1F FF"),
        ],
        "I²C": [("Request and answer", "40 83 repeated start 41 04")],
    }


def test_long_frames_are_split_into_packets_that_count_down(shipped):
    packets = lines(shipped, "cubeacp", "ADCS State", bytes(range(54)))["CAN"]
    assert packets[1] == ("Answer 1/8", "08BE0100 00 01 02 03 04 05 06 07")
    assert packets[-1][0] == "Answer 8/8" and packets[-1][1].endswith(" 00")


def test_a_node_without_protocol_facts_has_no_bytes_on_a_wire(shipped):
    assert lines(shipped, "cubemag", "State", bytes(3)) == {}


def test_the_page_shows_the_same_bytes(site):
    text = (site / "cubeacp" / "asgp4_run_mode.html").read_text("utf-8")
    section = text[text.index('id="wire"') :]
    shown = re.sub(
        "<[^>]*>", "", section[section.index("<dd") : section.index("</dd>")]
    )
    assert shown.split() == "1F 7F 1F 1F 00 1F FF".split()
