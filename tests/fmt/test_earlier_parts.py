"""``icdgen fmt`` converts each key of earlier versions, alone and with others."""

from __future__ import annotations

from textwrap import indent

import pytest
import yaml

from icdgen.icd.fmt import format_text


def converted(protocol: str, rest: str = "") -> object:
    """Return the protocol section after the conversion."""
    text = f"icdgen: 1\nprotocol:\n{indent(protocol, '  ')}\n{rest}"
    return yaml.safe_load(format_text(text, "pump.yaml"))["protocol"]


CRC = "width: 8, polynomial: 7"


@pytest.mark.parametrize(
    ("protocol", "expected"),
    [
        ("client: {retries: 1}", {"link": {"client": {"retries": 1}}}),
        ("message_id: {direction_bit: 7}", {"link": {"ids": {"direction_bit": 7}}}),
        ("can: {max_data_bytes: 8}", {"link": {"buses": {"can": {"max_data_bytes": 8}}}}),
        ("i2c: {write: 1}", {"link": {"buses": {"i2c": {"write": 1}}}}),
        (
            "uart: {baud_rate: 1, data_bits: 2, parity: none, stop_bits: 3, other: 4}",
            {"link": {"buses": {"uart": {
                "other": 4,
                "line": {"baud_rate": 1, "data_bits": 2, "parity": "none", "stop_bits": 3},
            }}}},
        ),
        (
            "uart: {line: {parity: odd}, stop_bits: 1}",
            {"link": {"buses": {"uart": {"line": {"parity": "odd", "stop_bits": 1}}}}},
        ),
        (
            "uart: {framing: {escape: 1, start_of_message: 2, end_of_message: 3, escaped_data: 4}}",
            {"link": {"buses": {"uart": {
                "framing": {"by": "escape", "escape": 1, "start": 2, "end": 3, "data": 4},
            }}}},
        ),
        (
            "link: {buses: {can: {bit_rate: 1}}}\nuart: {other: 1}",
            {"link": {"buses": {"can": {"bit_rate": 1}, "uart": {"other": 1}}}},
        ),
        ("stream: {delimited_by: none}", {"link": {"framing": {"by": "datagram"}}}),
        ("stream: {delimited_by: slip}", {"link": {"framing": {"by": "slip"}}}),
        ("stream: {delimited_by: [a]}", {"link": {"delimited_by": ["a"]}}),
        (
            "stream: {delimited_by: cobs}\nuart: {baud_rate: 9600}\nchecksums: {a: {kind: sum}}",
            {"link": {
                "framing": {"by": "cobs"},
                "checksums": {"a": {"kind": "sum"}},
                "line": {"baud_rate": 9600},
            }},
        ),
    ],
)  # fmt: skip
def test_parts_of_a_link_are_in_the_link(protocol, expected):
    assert converted(protocol) == expected


@pytest.mark.parametrize(
    "protocol",
    [
        "boot: {attempts: 1}",
        "link: {framing: {by: slip}}",
        "stream: [a]",
        "stream: {delimited_by: slip}\nlink: {framing: {by: slip}}",
        "link: 7\nclient: {retries: 1}",
        "link: {buses: 7}\ncan: {bit_rate: 1}",
        "link: 7\ncrc8: {width: 8}",
        "link: {checksums: 7}\ncrc8: {width: 8}",
    ],
)
def test_what_cannot_be_moved_stays(protocol):
    assert converted(protocol) == yaml.safe_load(protocol)


def test_what_cannot_be_moved_does_not_prevent_other_conversions():
    protocol = "link: {buses: 7}\nclient: {retries: 1}\ncan: {bit_rate: 1}"
    link = {"buses": 7, "client": {"retries": 1}}
    assert converted(protocol) == {"link": link, "can": {"bit_rate": 1}}
    protocol = "link: {packets: 7}\nclient: {}\ncrc8: {width: 8, telemetry: {}}"
    link = {"packets": 7, "client": {}, "checksums": {}}
    rest = {"width": 8, "telemetry": {}}
    assert converted(protocol) == {"link": link, "crc8": rest}


def test_a_section_that_is_no_mapping_stays():
    for protocol in ("[a]", "7", "null"):
        text = f"icdgen: 1\nprotocol: {protocol}\n"
        assert format_text(text, "pump.yaml") == text


def test_what_checksums_cover_is_at_the_fields_with_the_checksum():
    """At any depth, unless the field has its own."""
    link = converted("""\
stream:
  header: [{role: id}, {checksum: sum}]
  trailer: [{checksum: crc}, {checksum: other}, {checksum: sum, covers: {from: v, to: w}}]
  packets: {one: {trailer: [{checksum: crc}]}}
checksums:
  crc: {kind: crc, covers: {from: a, to: b}}
  sum: {covers: {from: c, to: d}}
  other: {kind: xor}
""")["link"]
    crc, own = {"from": "a", "to": "b"}, {"from": "c", "to": "d"}
    assert link == {
        "header": [{"role": "id"}, {"checksum": "sum", "covers": own}],
        "trailer": [
            {"checksum": "crc", "covers": crc},
            {"checksum": "other"},
            {"checksum": "sum", "covers": {"from": "v", "to": "w"}},
        ],
        "packets": {"one": {"trailer": [{"checksum": "crc", "covers": crc}]}},
        "checksums": {"crc": {"kind": "crc"}, "sum": {}, "other": {"kind": "xor"}},
    }


def test_the_first_field_with_a_checksum_gets_the_comments_about_what_it_covers():
    text = """\
icdgen: 1
protocol:
  stream:
    trailer: [{checksum: crc}, {checksum: crc}]
  checksums:
    crc:
      kind: crc
      # of the manual
      covers: {from: a, to: b}  # both
"""
    field = "- {checksum: crc, covers: {from: a, to: b}}"
    lines = [line.strip() for line in format_text(text, "pump.yaml").splitlines()]
    assert lines[3:] == [
        "trailer:",
        "# of the manual",
        "# both",
        field,
        field,
        "checksums:",
        "crc: {kind: crc}",
    ]


def trailer(bits: int, first: str, **keys) -> list[dict]:
    covers = {"from": first, "to": "data"}
    return [
        {"bits": bits, "role": "checksum", "checksum": "crc8", "covers": covers, **keys}
    ]


@pytest.mark.parametrize(
    ("keys", "packets"),
    [
        ("telecommand: {}", {
            "telecommand": {"from": "host", "trailer": trailer(8, "data", optional=True)},
        }),
        ("telemetry: {optional: true}", {
            "telemetry": {"from": "device", "trailer": trailer(8, "data", optional=True)},
        }),
        ("telemetry: {optional: false, extra_bytes: 2}, covers_id: true", {
            "telemetry": {"from": "device", "trailer": trailer(16, "id")},
        }),
        ("telecommand: {optional: false, source: {page: 3}, buses: [uart]}, covers_id: false", {
            "telecommand": {
                "source": {"page": 3}, "from": "host", "buses": ["uart"],
                "trailer": trailer(8, "data"),
            },
        }),
        ("telemetry: {optional: false, extra_bytes: x}, telecommand: {optional: false}", {
            "telecommand": {"from": "host", "trailer": trailer(8, "data")},
            "telemetry": {"from": "device", "trailer": trailer(8, "data")},
        }),
    ],
)  # fmt: skip
def test_packets_name_the_checksum_of_messages(keys, packets):
    link = converted(f"crc8: {{{CRC}, covers: [frame], {keys}}}")["link"]
    assert link["packets"] == packets
    assert link["checksums"] == {"crc8": {"kind": "crc", "width": 8, "polynomial": 7}}


def test_the_field_of_a_checksum_has_its_width():
    for width, bits in ((16, 16), (32, 32), (None, 8)):
        keys = f"width: {width}, " if width else ""
        link = converted(f"crc8: {{{keys}telemetry: {{optional: false}}}}")["link"]
        assert link["packets"]["telemetry"]["trailer"][0]["bits"] == bits


def test_a_checksum_of_files_says_what_it_covers():
    link = converted(
        "crc16: {source: {page: 1}, width: 16, covers: [block, file, [x]]}"
    )["link"]
    assert link == {
        "checksums": {
            "crc16": {
                "source": {"page": 1},
                "kind": "crc",
                "width": 16,
                "summary": "Covers block, file.",
            }
        }
    }


def test_both_checksums_are_moved_and_other_values_are_not():
    link = converted("crc16: {width: 16}\ncrc8: {width: 8}")["link"]
    assert link["checksums"] == {
        "crc8": {"kind": "crc", "width": 8},
        "crc16": {"kind": "crc", "width": 16},
    }
    assert converted("crc16: 7\ncrc8: {width: 8}") == {
        "crc16": 7,
        "link": {"checksums": {"crc8": {"kind": "crc", "width": 8}}},
    }


def test_reasons_of_assumptions_are_next_to_the_values():
    uses = "telecommand: {optional: false}, telemetry: {optional: false}"
    reasons = "covers_id: A., telecommand: B., telemetry: C., init: D."
    link = converted(f"crc8: {{{CRC}, {uses}, assumptions: {{{reasons}}}}}")["link"]
    command, telemetry = link["packets"].values()
    assert command["assumptions"] == {"trailer": "A.", "buses": "B."}
    assert telemetry["assumptions"] == {"buses": "C."}
    assert link["checksums"]["crc8"]["assumptions"] == {"init": "D."}
    uart = converted(
        "uart: {parity: odd, other: 1, assumptions: {parity: A., other: B.}}"
    )
    assert uart["link"]["buses"]["uart"] == {
        "other": 1,
        "line": {"parity": "odd", "assumptions": {"parity": "A."}},
        "assumptions": {"other": "B."},
    }
    uart = converted("uart: {parity: odd, assumptions: {parity: A.}}")
    assert "assumptions" not in uart["link"]["buses"]["uart"]


PATHS = {
    "protocol.client": "protocol.link.client",
    "protocol.client.retries": "protocol.link.client.retries",
    "protocol.clients": "protocol.clients",
    "protocol.message_id.telemetry": "protocol.link.ids.telemetry",
    "protocol.errors.none": "protocol.link.commands.reasons.none",
    "protocol.crc8": "protocol.link.checksums.crc8",
    "protocol.crc8.width": "protocol.link.checksums.crc8.width",
    "protocol.crc8.telecommand": "protocol.link.packets.telecommand",
    "protocol.crc8.telemetry.buses": "protocol.link.packets.telemetry.buses",
    "protocol.crc16.init": "protocol.link.checksums.crc16.init",
    "protocol.uart": "protocol.link.buses.uart",
    "protocol.uart.baud_rate": "protocol.link.buses.uart.line.baud_rate",
    "protocol.uart.data_bits": "protocol.link.buses.uart.line.data_bits",
    "protocol.uart.parity": "protocol.link.buses.uart.line.parity",
    "protocol.uart.stop_bits": "protocol.link.buses.uart.line.stop_bits",
    "protocol.uart.framing.escape": "protocol.link.buses.uart.framing.escape",
    "protocol.uart.acknowledge.source": "protocol.link.packets.acknowledge.source",
    "protocol.uart.acknowledge.data.0": "protocol.link.packets.acknowledge",
    "protocol.i2c.acknowledge.field": "protocol.link.buses.i2c.commands.ack.field",
    "protocol.can.message_types.values.3.value": "protocol.link.packets",
    "protocol.can.telecommand.request": "protocol.link.buses.can.commands.request",
    "protocol.can.telemetry": "protocol.link.buses.can.requests",
    "protocol.can.extended.fill": "protocol.link.buses.can.segments.fill",
    "protocol.link.reasons.length": "protocol.link.commands.reasons.length",
    "protocol.link.packets.acknowledge.header": "protocol.link.packets.acknowledge.header",
    "protocol.link.packets.one.values": "protocol.link.packets.one.values",
    "protocol.boot": "protocol.boot",
}


@pytest.mark.parametrize("earlier", PATHS)
def test_errata_name_present_places(earlier):
    text = f"errata: 1\nnode: pump\nnotes: [{{id: A, where: [{{message: M}}, {{section: {earlier}}}]}}]\n"
    after = format_text(text, "pump.yaml")
    (note,) = yaml.safe_load(after)["notes"]
    assert note["where"] == [{"message": "M"}, {"section": PATHS[earlier]}]


def test_printed_keys_of_the_framing_of_the_uart_are_the_present_ones():
    text = """\
errata: 1
entries:
  - id: A
    where: {section: protocol.uart.framing}
    printed: {start_of_message: 1, end_of_message: 2, escaped_data: 3, escape: 4}
    correct: {start: 5}
  - id: B
    where: {section: protocol.uart.line}
    printed: {start_of_message: 1}
  - {id: C, where: 7, printed: {escaped_data: 1}}
  - {id: D, where: {section: [a]}}
"""
    first, second, third, fourth = yaml.safe_load(format_text(text, "e.yaml"))[
        "entries"
    ]
    assert first["printed"] == {"start": 1, "end": 2, "data": 3, "escape": 4}
    assert second["printed"] == {"start_of_message": 1}
    assert third == {"id": "C", "where": 7, "printed": {"escaped_data": 1}}
    assert fourth == {"id": "D", "where": {"section": ["a"]}}
