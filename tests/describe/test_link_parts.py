"""Parts of links: each assumption is returned once, byte tables of CRCs, and sizes of
joined packets and log entries.
"""

from __future__ import annotations

import random
from types import SimpleNamespace

import pytest

from icdgen.describe.links import Assumptions, LinkDescription, byte_table

REASONS = (
    ("framing", "start", "1"),
    ("framing", "crc", "2"),
    ("files", "time_out", "3"),
    ("files.index", "size", "4"),
    ("filesystem", "size", "5"),
)


def assumptions():
    framing, crc = object(), object()
    facts = SimpleNamespace(
        parts={"framing": framing},
        checksums={"sum": SimpleNamespace(crc=crc, section="framing")},
        assumptions=[
            SimpleNamespace(section=section, key=key, why=why)
            for section, key, why in REASONS
        ],
    )
    return Assumptions(facts), framing, crc


def test_an_assumption_is_returned_only_once():
    left, framing, crc = assumptions()
    assert left.why("framing", "start") == "1"
    assert left.why("framing", "start") == "" == left.why("framing", "other")
    # The first part of a dotted key is the key of the section.
    assert left.why_fact(crc, SimpleNamespace(key="crc.width")) == "2"
    assert left.why_fact(framing, SimpleNamespace(key="crc")) == ""
    assert left.why_fact(framing, SimpleNamespace(key="")) == ""
    assert left.remaining() == list(REASONS[2:])
    assert left.remaining() == []


def test_assumptions_of_a_section_include_others_only_in_its_tree():
    left, framing, _ = assumptions()
    assert left.of_part(framing) == [("start", "1"), ("crc", "2")]
    assert left.of_section("framing") == []
    left, *_ = assumptions()
    assert left.of_section("files") == [("time_out", "3")]
    left, *_ = assumptions()
    assert left.of_section_tree("files") == [("time_out", "3"), ("index size", "4")]
    assert left.of_section_tree("files") == []
    assert [row[0] for row in left.remaining()] == ["framing", "framing", "filesystem"]


def bit_by_bit(byte: int, polynomial: int, width: int, is_reflected: bool) -> int:
    """Return the register after a byte, which was 0 before."""
    register = 0
    for n in range(8):
        # Bits enter most significant bit first, unless reflected.
        bit = byte >> (n if is_reflected else 7 - n) & 1
        out = register >> (width - 1) & 1
        register = register << 1 & (1 << width) - 1
        register ^= polynomial if bit ^ out else 0
    text = f"{register:0{width}b}"
    return int(text[::-1] if is_reflected else text, 2)


@pytest.mark.parametrize("is_reflected", [False, True])
@pytest.mark.parametrize("width", [8, 12, 16, 24, 32, 64])
def test_a_table_has_the_register_after_each_byte(width, is_reflected):
    polynomial = random.Random(width).getrandbits(width) | 1
    crc = SimpleNamespace(width=width, polynomial=polynomial, reflect_in=is_reflected)
    assert byte_table(crc) == [
        bit_by_bit(byte, polynomial, width, is_reflected) for byte in range(256)
    ]


def link(**facts) -> LinkDescription:
    return LinkDescription(SimpleNamespace(message=None), SimpleNamespace(**facts))


@pytest.mark.parametrize(
    ("longest", "size"), [(0, 0), (1, 7), (7, 7), (8, 14), (14, 14), (15, 21)]
)
def test_packets_of_a_message_are_whole(longest, size):
    can = SimpleNamespace(extended=SimpleNamespace(data_bytes=7))
    assert link(can=can, longest_data=longest).joined_bytes == size


@pytest.mark.parametrize("can", [None, SimpleNamespace(extended=None)])
def test_messages_of_one_packet_are_not_joined(can):
    assert link(can=can, longest_data=9).joined_bytes == 0


def test_the_longest_log_entry_has_a_slot_for_each_bit_of_the_mask():
    file = SimpleNamespace(frames_at=10)
    mask = SimpleNamespace(size=4, slot_bytes=3)
    assert link(log_file=file, mask=mask).log_entry_bytes == 10 + 32 * 3
    assert link(log_file=None, mask=mask).log_entry_bytes == 0
    assert link(log_file=file, mask=None).log_entry_bytes == 0


@pytest.mark.parametrize(
    ("framing", "address", "buses"),
    [(None, None, []), (object(), None, ["uart"]), (None, 0, ["i2c"]), (0, 8, ["uart", "i2c"])],
)  # fmt: skip
def test_a_bus_is_described_if_it_has_a_fact_even_if_it_is_0(framing, address, buses):
    assert link(framing=framing, i2c_address=address, can=None).buses == buses


def test_messages_are_listed_by_id_unless_packets_list_them():
    messages = {9: "b", 0: "a"}
    own = link(telecommands=messages, telemetry={}, stream=None)
    assert [(sent.id, sent.message) for sent in own.telecommands] == [
        (0, "a"),
        (9, "b"),
    ]
    framed = link(
        telecommands=messages,
        telemetry=messages,
        stream=SimpleNamespace(requested_ids={3}),
    )
    assert framed.telecommands == framed.telemetry == []
    assert (own.requested_ids, framed.requested_ids) == (frozenset(), {3})


def test_codes_of_refusals_are_those_of_all_buses_in_order():
    def bus(*codes):
        response = SimpleNamespace(reasons=[(code, "busy") for code in codes])
        return SimpleNamespace(command=SimpleNamespace(responses=[response]))

    exchanges = {
        "uart": bus(7, 2),
        "can": SimpleNamespace(command=None),
        "i2c": bus(0, 2),
    }
    assert link(bus_exchanges=exchanges).reasons == [0, 2, 7]
