"""Rules of packet formats: which packet carries a message, what distinguishes packets,
and what a request of telemetry needs.
"""

from __future__ import annotations

import tempfile
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.icd.rules.reported import messages, reported
from tests.icd.rules.test_framed_links import message, open_message
from tests.limits import assert_limits

HEAD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: slip}
    packets:
"""
"""Line 7 is the first packet."""


def packets(rows: dict[str, str], *content: str, keys: str = "") -> str:
    """Return an ICD with these packets; each value is the inside of a flow mapping."""
    lines = "".join(f"      {name}: {{{row}}}\n" for name, row in rows.items())
    return f"{HEAD}{lines}{keys}messages:\n{''.join(content)}"


def packet(sender: str, *fields: str, keys: str = "") -> str:
    """Return a packet with these fields of its header."""
    rows = ", ".join(f"{{{field}}}" for field in fields)
    return f"from: {sender}, header: [{rows}]{keys}"


def constant(value: object, bits: int = 8, role: str = "constant") -> str:
    return f"bits: {bits}, role: {role}, value: {value}"


ID = "bits: 8, role: id"
STATE = message("State", 9)
SAVE = message("Save", 1, kind="telecommand")


def test_all_packets_that_could_carry_a_message_are_listed(tmp_path):
    rows = {name: packet("device", constant(n), ID) for n, name in enumerate("ABC")}
    assert reported(tmp_path, packets(rows, STATE), "ICD184") == [
        (
            11,
            "State",
            "nothing says whether the telemetry `State` is sent in the packet `A` or `B` "
            "or `C`",
            "list the messages of one of them in `messages`",
        )
    ]


def test_a_packet_of_both_sides_carries_messages_in_both_directions(tmp_path):
    rows = {"All": packet("both", ID, keys=", messages: [State, Save]")}
    assert reported(tmp_path, packets(rows, STATE, SAVE), "ICD184") == []
    rows["Other"] = packet("device", constant(1), ID, keys=", messages: [State]")
    assert reported(tmp_path, packets(rows, STATE, SAVE), "ICD184") == [
        (8, "State", "`State` is in the packet `All` already", "list it in one packet")
    ]


def test_a_message_can_be_listed_once_in_each_direction(tmp_path):
    """A configuration is sent in both."""
    config = "  - {name: Mode, set_id: 1, get_id: 2, kind: configuration, length: 0}\n"
    rows = {
        "Order": packet("host", ID, keys=", messages: [Mode]"),
        "Data": packet("device", ID, keys=", messages: [Mode]"),
    }
    assert reported(tmp_path, packets(rows, config), "ICD184") == []
    rows["Data"] = packet("device", ID, keys=", messages: [Save]")
    assert messages(tmp_path, packets(rows, config, SAVE), "ICD184") == [
        "the node has no message `Save` in the direction of the packet `Data`",
        "no packet carries the telemetry `Mode`",
        "no packet carries the telecommand `Save`",
    ]


def test_a_packet_can_list_a_message_with_errors(tmp_path):
    """The schema reports the message, and a misspelt name is still reported."""
    rows = {"Data": packet("device", ID, keys=", messages: [State, Broken, Stat]")}
    broken = message("Broken", 5).replace("length: 1", "length: x")
    assert messages(tmp_path, packets(rows, STATE, broken), "ICD184") == [
        "the node has no message `Stat` in the direction of the packet `Data`"
    ]


def test_packets_of_every_link_are_checked(tmp_path):
    """Also behind a link without packets, and one without requests."""
    rows = {
        "Order": packet("host", ID),
        "Data": packet("device", ID, keys=", messages: [Stat]"),
    }
    other = packets(rows, STATE, keys="    requests: {packet: Ordr}\n").replace(
        "name: demo", "name: other"
    )
    plain = "".join(HEAD.partition("    packets:")[0]) + f"    header: [{{{ID}}}]\n"
    text = f"{plain}messages:\n{STATE}# other.yaml\n{other}"
    assert messages(tmp_path, text, "ICD184") == [
        "the node has no message `Stat` in the direction of the packet `Data`",
        "no packet carries the telemetry `State`",
    ]
    assert messages(tmp_path, text, "ICD186") == ["there is no packet `Ordr`"]


FIELDS = st.lists(
    st.tuples(st.sampled_from(["constant", "sync", "flags"]), st.integers(0, 2)),
    min_size=1,
    max_size=2,
)


@settings(max_examples=60, deadline=None)
@given(st.lists(FIELDS, min_size=2, max_size=3))
def test_a_packet_hides_later_ones_that_have_all_its_constants(headers):
    """Only the first pair of a direction is reported."""
    rows, constants = {}, []
    for name, header in zip("ABC", headers, strict=False):
        fields = [f"bits: 4, role: {role}, value: {value}" for role, value in header]
        end = f", trailer: [{{{constant(ord(name))}}}]"
        rows[name] = packet("device", *fields, keys=end)
        constants.append(
            {at: value for at, (role, value) in enumerate(header) if role != "flags"}
        )
    pair = next(
        (
            (first, second)
            for first, second in combinations(range(len(headers)), 2)
            if constants[first].items() <= constants[second].items()
        ),
        None,
    )
    with tempfile.TemporaryDirectory() as folder:
        found = reported(Path(folder), packets(rows), "ICD185")
    if pair is None:
        assert found == []
        return
    first, second = ("ABC"[number] for number in pair)
    assert found == [
        (
            7 + pair[1],
            "device",
            f"`{second}` is received as `{first}`, which precedes it and has no other "
            "constants",
            "give them different constants in the header, or move "
            f"`{second}` in front if its constants are more",
        )
    ]


@pytest.mark.parametrize(
    ("first", "second", "is_hidden"),
    [
        ([constant("{telecommand: 1, telemetry: 2}")], [constant(1)], False),
        ([constant("{telecommand: 1, telemetry: 2}")], [constant(2)], True),
        ([constant("[1, 2]", 16)], [constant("0x0102", 16)], True),
        ([constant("[1, 2]", 16)], [constant("0x0201", 16)], False),
        ([constant("[1, 2]", 16)], [constant(1), constant(2)], True),
        ([constant("0x0102", 16) + ", byte_order: little"], [constant(2), constant(1)], True),
        ([constant("0x0102", 16) + ", byte_order: little"], [constant(1), constant(2)], False),
        ([constant("[1, 2]", 16) + ", byte_order: little"], [constant(1), constant(2)], True),
        ([constant(10, 4)], [constant(0xA5)], True),
        ([constant(5, 4)], [constant(0xA5)], False),
        ([constant(0xA5)], [constant(10, 4)], False),
    ],
)  # fmt: skip
def test_constants_of_packets_are_compared_bit_by_bit(
    first, second, is_hidden, tmp_path
):
    rows = {"A": packet("both", *first, ID), "B": packet("device", *second, ID)}
    assert len(messages(tmp_path, packets(rows), "ICD185")) == is_hidden


NOTHING = (
    "no telemetry can be requested: its packets have no id, or telecommands have the "
    "same ids"
)


@pytest.mark.parametrize(
    ("data", "content", "is_reported"),
    [
        ([ID], [STATE, SAVE], False),
        ([ID], [SAVE], False),
        ([constant(2)], [STATE, SAVE], True),
        ([ID], [message("State", 1), SAVE], True),
        ([ID], [message("State", 1), message("Mode", 2), SAVE], False),
        ([ID], [message("State", 9, keys=", requested: false"), SAVE], True),
    ],
)
def test_some_telemetry_can_be_requested(data, content, is_reported, tmp_path):
    rows = {
        "Order": packet("host", constant(1), ID),
        "Data": packet("device", *data),
    }
    text = packets(rows, *content, keys="    requests: {timeout_ms: 100}\n")
    found = reported(tmp_path, text, "ICD186")
    expected = (9, "requests", NOTHING, "remove `requests`, or correct the packets")
    assert found == [expected] * is_reported


def test_a_request_in_the_only_packet_of_the_host_is_reported_at_the_requests(tmp_path):
    rows = {"Order": packet("host", constant(1)), "Data": packet("device", ID)}
    keys = "    requests: {timeout_ms: 100}\n"
    text = packets(rows, STATE, keys=keys)
    assert [each[:2] for each in reported(tmp_path, text, "ICD186")] == [
        (9, "requests")
    ]
    text = packets(rows, STATE, keys=keys.replace("{", "{packet: Order, "))
    assert [each[:2] for each in reported(tmp_path, text, "ICD186")] == [(9, "packet")]


@pytest.mark.parametrize(("request_by", "number"), [("Read", 1), ("Raed", 0)])
def test_telemetry_without_id_is_compared_with_requests_by_a_packet(
    request_by, number, tmp_path
):
    """An unknown packet has a finding of its own (ICD186)."""
    rows = {
        "Read": packet("host", constant(1), ID),
        "Data": packet("device", constant(1)),
    }
    state = message("State", 9, keys=", requested: false")
    keys = f"    requests: {{packet: {request_by}, response: Data}}\n"
    found = messages(tmp_path, packets(rows, state, keys=keys), "ICD187")
    assert (
        found
        == [
            "`State` is sent in the packet `Data`, which does not say what it carries, and "
            "cannot be requested"
        ]
        * number
    )


def of_request(length: str, *content: str) -> str:
    """Return an ICD whose requests have the length of the response."""
    rows = {
        "Read": packet("host", constant(1), ID, length),
        "Write": packet("host", constant(2), ID),
        "Data": packet("device", constant(1), ID),
    }
    return packets(rows, *content, keys="    requests: {packet: Read}\n")


@pytest.mark.parametrize(("unit", "most"), [(1, 7), (2, 14), (3, 21)])
def test_a_request_holds_the_length_of_its_response_in_units(unit, most, tmp_path):
    def fits(length: int) -> bool:
        row = f"bits: 3, role: response_length, unit: {unit}"
        text = of_request(row, message("State", 9, length), SAVE)
        return messages(tmp_path, text, "ICD188") == []

    assert_limits(fits, most=most, step=unit)


def test_a_length_of_a_response_without_unit_is_reported_at_its_role(tmp_path):
    text = of_request("bits: 3, role: response_length", message("State", 9, 8), SAVE)
    assert reported(tmp_path, text, "ICD188") == [
        (
            7,
            "response_length",
            "a length of 3 bits does not hold 8, that of `State`",
            "make the field wider, or the message shorter",
        )
    ]


def test_telemetry_that_is_not_requested_has_any_length(tmp_path):
    content = message("State", 9, 8, keys=", requested: false"), message("Mode", 8)
    text = of_request("bits: 3, role: response_length", *content, SAVE)
    assert messages(tmp_path, text, "ICD188") == []


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ([message("A", 9, 2), message("B", 8, 4)], None),
        ([message("A", 9, 2, keys=", shares_id: true"), message("B", 9, 4, keys=", shares_id: true")], "B"),
        ([message("A", 9, 2), message("B", 9, 4, kind="telecommand")], None),
        ([message("A", 9, 2, keys=", may_end_early: zeros")], "A"),
        ([message("A", 9, 2), open_message("B", 8, 2, 4)], "B"),
    ],
)  # fmt: skip
def test_a_length_in_units_needs_one_length_for_each_id(content, name, tmp_path):
    rows = {"All": packet("both", ID, "bits: 8, role: length, unit: 2")}
    expected = (
        7,
        "2",
        f"`{name}` has no fixed length, which the length needs",
        "let the message have a fixed length, or remove `unit`",
    )
    found = reported(tmp_path, packets(rows, *content), "ICD188")
    assert found == ([expected] if name else [])


@pytest.mark.parametrize("counts", ["data", "message"])
@pytest.mark.parametrize("reserved", range(4))
def test_the_reserved_bytes_of_a_request_are_whole_units(counts, reserved, tmp_path):
    """With the 3 bytes of the header, if those are counted."""
    length = f"bits: 8, role: length, unit: 2, counts: {counts}"
    keys = f"    requests: {{packet: Read, reserved: {reserved}}}\n"
    rows = {
        "Read": packet("host", constant(1), ID, length),
        "Write": packet("host", constant(2), ID),
        "Data": packet("device", ID),
    }
    text = packets(rows, STATE, SAVE, keys=keys)
    size = reserved + 3 * (counts == "message")
    assert messages(tmp_path, text, "ICD188") == [
        f"{'1 byte is' if size == 1 else f'{size} bytes are'} not a multiple of the unit 2"
    ] * (size % 2)


def test_a_length_that_packets_share_is_reported_once(tmp_path):
    keys = "    header: [{bits: 8, role: id}, {bits: 8, role: length, unit: 2}]\n"
    rows = {"Order": "from: host", "Data": "from: device"}
    text = packets(
        rows, message("State", 9, 3), message("Save", 1, 3, "telecommand"), keys=keys
    )
    assert messages(tmp_path, text, "ICD188") == [
        "the 3 bytes of `Save` are not a multiple of the unit 2"
    ]


def test_the_first_message_that_is_no_whole_units_is_reported(tmp_path):
    rows = {"Data": packet("device", ID, "bits: 8, role: length, unit: 2")}
    content = message("A", 1, 2), message("B", 2, 5), message("C", 3, 3)
    assert messages(tmp_path, packets(rows, *content), "ICD188") == [
        "the 5 bytes of `B` are not a multiple of the unit 2"
    ]


@pytest.mark.parametrize("name", ["Write", "Data", "Refused"])
def test_only_the_packet_of_requests_has_the_length_of_the_response(name, tmp_path):
    """`Refused` carries no message, as that packet."""
    keys = "    requests: {packet: Read, nak: {packet: Refused}}\n"
    rows = {
        "Read": packet("host", constant(1), ID),
        "Write": packet("host", constant(2), ID),
        "Data": packet("device", constant(1), ID),
        "Refused": packet("device", constant(2)),
    }
    rows[name] = rows[name].replace("]", ", {bits: 8, role: response_length}]")
    assert reported(tmp_path, packets(rows, STATE, SAVE, keys=keys), "ICD188") == [
        (
            7 + [*rows].index(name),
            "response_length",
            "a `response_length` is in a packet that only requests telemetry",
            "name the packet in `requests: packet`, and let another one carry "
            "telecommands",
        )
    ]
