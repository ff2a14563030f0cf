"""Rules about numbers that must fit their bits, and lists with certain parts."""

from __future__ import annotations

import pytest

from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol_limits import roles_occur_once, section_in_effect
from icdgen.loading import load
from tests.icd.files import loaded, write
from tests.icd.rules.marked import findings_of, marked_text, reported

BITS = {"type": 3, "channel": 6, "source": 4, "destination": 5}


def can(keys: str = "", packets: str = "", messages: str = "", **bits: int) -> str:
    """Return an ICD with an identifier on CAN."""
    parts = ", ".join(
        f"{{name: {role.title()}, role: {role}, bits: {size}}}"
        for role, size in (BITS | bits).items()
    )
    return (
        f"protocol:\n  link:\n{packets}    buses:\n      can:\n"
        f"        identifier: [{parts}]\n{keys}messages:\n{messages}"
    )


def fits(folder, text: str) -> list[tuple[str, str]]:
    return reported(folder, text, "ICD100")


def test_an_address_fits_the_source_and_the_destination(tmp_path):
    message = "a {} address has {} bits: 0 to {}, not {}"
    source = ("source", 4, 15)
    destination = ("destination", 5, 31)
    for address, expected in (
        (0, []),
        (14, []),
        (15, []),
        (16, [source]),
        (31, [source]),
        (32, [destination, source]),
    ):
        rows = fits(tmp_path, can(f"        node_address: {address}\n"))
        assert rows == [
            (str(address), message.format(*row, address)) for row in expected
        ]


def test_one_bit_is_counted_and_numbers_keep_their_spelling(tmp_path):
    text = can("        node_address: 0x02\n", source=1)
    assert fits(tmp_path, text) == [
        ("0x02", "a source address has 1 bit: 0 to 1, not 0x02")
    ]
    (finding,) = findings_of(tmp_path, text, "ICD100")
    assert finding.help == "correct `node_address`, or `bits` of the identifier"


def test_types_of_all_packets_fit_the_identifier(tmp_path):
    packets = "    packets:\n" + "".join(
        f"      P{number}: {{from: host, type: {number}}}\n" for number in (9, 7, 6, 8)
    )
    message = "a message type has 3 bits: 0 to 7, not {}"
    rows = fits(tmp_path, can(packets=packets))
    assert rows == [("9", message.format(9)), ("8", message.format(8))]


def test_ids_of_messages_fit_the_channel(tmp_path):
    field = "fields: [{at: 0, bits: 8, name: A, type: uint}]"
    messages = f"""\
  - {{name: A, id: 63, kind: telecommand, length: 0}}
  - {{name: B, id: 64, kind: telecommand, length: 0}}
  - {{name: C, id: 65, kind: telemetry, length: 1, {field}}}
  - {{name: D, set_id: 62, get_id: 66, kind: configuration, length: 1, {field}}}
  - {{name: E, set_id: 67, get_id: 68, kind: configuration, length: 1, {field}}}
"""
    rows = fits(tmp_path, can(messages=messages))
    text = "the channel of a CAN identifier has 6 bits: 0 to 63, not {}"
    assert rows == [(str(id), text.format(id)) for id in (64, 65, 66, 67, 68)]


PART = """\
# parts/base.yaml
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
"""


def test_the_identifier_of_an_included_node_is_in_effect(tmp_path):
    base = can(keys="        node_address: 99\n").replace("messages:\n", "")
    message = "  - {name: A, id: 64, kind: telecommand, length: 0}\n"
    text = f"include: [parts/base.yaml]\nmessages:\n{message}{PART}{base}"
    rows = [f for f in loaded(tmp_path, text).findings if f.code == "ICD100"]
    assert sorted((f.place.line, f.message.split(" has")[0]) for f in rows) == [
        (5, "the channel of a CAN identifier"),
        (8, "a destination address"),
        (8, "a source address"),
    ]


def test_a_section_in_effect_is_the_own_one_or_that_of_an_included_node(tmp_path):
    """A bus, another part of the link and a section are replaced as a whole."""
    base = (
        "protocol:\n"
        "  log_mask: {bytes: 1, frame_bytes: 2}\n"
        "  link: {buses: {can: {segments: {data_bytes: 7, packets_left_byte: 7}}}}\n"
        "  boot: {identify_after: {seconds: 1, message: A}}\n"
    )
    own = (
        "include: [parts/base.yaml]\nprotocol:\n"
        "  boot: {attempts: 1}\n"
        "  link: {buses: {can: {max_data_bytes: 8}}}\n"
    )
    icd = load([write(tmp_path, f"{own}{PART}{base}")]).icd
    context = Context(icd)
    node = next(node for node in icd.nodes if node.name == "demo")
    log_mask = section_in_effect(context, node, "log_mask")
    assert dict(log_mask) == {"bytes": 1, "frame_bytes": 2}
    assert section_in_effect(context, node, "boot", "identify_after") is None
    assert section_in_effect(context, node, "link", "buses", "can", "segments") is None
    bus = section_in_effect(context, node, "link", "buses", "can")
    assert dict(bus) == {"max_data_bytes": 8}
    assert section_in_effect(context, node, "telemetry_log") is None


def test_each_part_of_an_identifier_occurs_once(tmp_path):
    text = """\
protocol:
  link:
    buses:
      can:
        requests: {packet: Get}
        identifier:
          - {name: Type, role: type, bits: 5}
          - {name: From, role: source, bits: 8}
          - {name: Again, role: source, bits: 8}
          - {name: source, bits: 8}
          - {name: Spare, bits: 1}
          - {name: Spare, bits: 1}
          - {name: channel, bits: 8}
"""
    rows = findings_of(tmp_path, text, "ICD101")
    assert [(marked_text(text, f), f.place.line, f.message, f.help) for f in rows] == [
        (
            "-",
            9,
            "the identifier has no part for `destination`",
            "give the parts their `role`",
        ),
        (
            "source",
            11,
            "`source` is given twice, here and in line 10",
            "correct the `role` of one part, or remove it",
        ),
        (
            "source",
            12,
            "`source` is given twice, here and in line 10",
            "correct the `name` of one part, or remove it",
        ),
    ]
    assert [(f.related.place.line, f.related.label) for f in rows[1:]] == [
        (10, "the first `source`")
    ] * 2


@pytest.mark.parametrize(
    "key",
    [
        "commands: {ack: {packet: A}}",
        "requests: {packet: A}",
        "identifier: [{name: A, bits: 29}]",
        "max_data_bytes: 8",
    ],
)
def test_a_bus_that_is_used_has_all_parts_of_its_identifier(key, tmp_path):
    text = f"protocol:\n  link:\n    buses:\n      can:\n        {key}\n"
    rows = findings_of(tmp_path, text, "ICD101")
    message = (
        "the identifier has no part for `type`, `channel`, `source` and `destination`"
    )
    is_listed = key.startswith("identifier")
    assert [f.message for f in rows] == [message] * is_listed


@pytest.mark.parametrize("first", ["role: type, name: A", "name: type"])
@pytest.mark.parametrize("second", ["role: type, name: B", "name: type"])
def test_both_parts_with_a_role_are_marked(first, second, tmp_path):
    text = (
        "protocol:\n  link:\n    buses:\n      can:\n        identifier:\n"
        f"          - {{bits: 5, {first}}}\n          - {{bits: 5, {second}}}\n"
    )
    finding = findings_of(tmp_path, text, "ICD101")[-1]
    key = second.partition(":")[0]
    assert finding.help == f"correct the `{key}` of one part, or remove it"
    related = finding._replace(place=finding.related.place)
    assert related.place.line == finding.place.line - 1
    assert marked_text(text, finding) == marked_text(text, related) == "type"


@pytest.mark.parametrize("last", [0, 255, 256])
def test_the_last_packet_has_a_number_of_a_byte(last, tmp_path):
    """Without messages and `max_packets`, nothing else is counted."""
    segments = f"data_bytes: 7, packets_left_byte: 7, packets_left_in_last: {last}"
    text = can(f"        segments: {{{segments}}}\n")
    rows = reported(tmp_path, text, "ICD099")
    if last < 256:
        assert rows == []
        return
    ((marked, message),) = rows
    assert marked == "256" and message.endswith(" left, a byte holds 255")
    (finding,) = findings_of(tmp_path, text, "ICD099")
    assert finding.help.endswith("or `max_packets`: at most 0")


def test_parts_that_the_schema_check_reports_may_be_the_missing_ones(tmp_path):
    text = """\
protocol:
  link:
    buses:
      can:
        identifier: [{name: Type, role: type, bits: 5}, {name: A, role: 7, bits: 5}]
"""
    assert reported(tmp_path, text, "ICD101") == []


def test_lists_of_roles_have_words_of_their_own(tmp_path):
    text = "protocol: {msdos_time: {bits: 6, parts: [{at: 0, bits: 6, name: hour}]}}\n"
    icd = load([write(tmp_path, text)]).icd
    section = icd.nodes[0].source["protocol"]["msdos_time"]
    faults = roles_occur_once(
        section, "parts", ["day", "hour", "year"], "It lacks", "Add."
    )
    assert [(f.message, f.help) for f in faults] == [
        ("It lacks `day` and `year`", "Add.")
    ]
    assert [*roles_occur_once(section, "rows", ["day"], "It lacks")] == []
