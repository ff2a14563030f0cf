"""Responses of an ICD become exchanges: the places that are compared, and the meaning of
each value.
"""

from __future__ import annotations

import pytest

from icdgen.icd.responses import field_of
from icdgen.protocol import facts
from icdgen.protocol.exchange import Echo, NumberPlace, ResponsePoll
from icdgen.protocol.responding import Number, place_of
from tests.conformance.icds import LINKS, icd_of
from tests.icd.files import loaded, status

ID = NumberPlace(0, 4, 0, 32, False)  # a whole id, in front of the data


def byte(at):
    return NumberPlace(at, 1, 0, 8, False)


def stream_of(icd):
    return facts.of(icd, icd.nodes[-1]).stream


@pytest.fixture(scope="module")
def arm():
    """Exchanges of a link whose responses are telemetry, by name of the telecommand."""
    rows = stream_of(icd_of([LINKS / "outcomes.yaml"])).telecommands
    return {row.name: row.exchange for row in rows}


@pytest.fixture(scope="module")
def formats():
    """The stream of a link whose responses are packets."""
    return stream_of(icd_of([LINKS / "formats.yaml"]))


def number_with(folder, *members, bits=8):
    """Return a number with an enumeration of these members."""
    rows = "".join(f"      - {{{member}}}\n" for member in members)
    text = f"enums:\n  - name: Codes\n    members:\n{rows}"
    text += status(f"at: 0, bits: {bits}, name: A, type: enum, enum: Codes")
    (enum,) = loaded(folder, text).icd.nodes[0].enums
    return Number(NumberPlace(0, 1, 0, bits, False), enum)


def test_values_of_a_number_are_compared_without_sign(tmp_path):
    number = number_with(
        tmp_path, "value: -2, name: Low", "value: 3, to: 5, name: Some"
    )
    assert [number.raw(value) for value in ("Low", "Some", -1, 3, 255, "None")] == [
        0xFE, 3, 0xFF, 3, 255, None,
    ]  # fmt: skip
    assert number.names == ((0xFE, "Low"), (3, "Some"), (4, "Some"), (5, "Some"))
    narrow = number._replace(place=NumberPlace(0, 1, 0, 4, False))
    assert (narrow.raw("Low"), narrow.names[0]) == (0xE, (0xE, "Low"))
    assert Number(byte(0), None).names == ()
    assert Number(byte(0), None).raw("Low") is None


@pytest.mark.parametrize(
    ("keys", "offset", "place"),
    [
        ("at: 0, bits: 8", 0, NumberPlace(0, 1, 0, 8, True)),
        ("at: 8, bits: 16", 0, NumberPlace(1, 2, 0, 16, True)),
        ("at: 8, bits: 16", 4, NumberPlace(5, 2, 0, 16, True)),
        ("at: 4, bits: 11", 0, NumberPlace(0, 2, 4, 11, True)),
        ("at: 3, bits: 3", 1, NumberPlace(1, 1, 3, 3, True)),
        ("at: 16, bits: 32", 0, NumberPlace(2, 4, 0, 32, True)),
        ("at: 16, bits: 33", 0, None),
        ("at: 4, bits: 32", 0, None),  # in 5 bytes
        (
            "at: 8, bits: 16, byte_order: big, bit_order: msb0",
            0,
            NumberPlace(1, 2, 0, 16, False),
        ),
    ],
)
def test_a_number_is_compared_in_at_most_4_bytes(tmp_path, keys, offset, place):
    text = status(f"{keys}, name: A, type: uint", length=8)
    result = loaded(tmp_path, text)
    node, message = result.icd.nodes[0], result.icd.nodes[0].messages[0]
    assert place_of(node, field_of(message, "A"), offset) == place
    assert place_of(node, None) is None


def test_telemetry_repeats_bytes_of_the_id_with_a_status_and_a_reason(arm):
    exchange = arm["Move Joint"]
    ack, nak, progress = exchange.responses
    # `id[0]` and `id[1]` are the last bytes of an id of 4 bytes; data follow it.
    assert exchange.sources == (byte(2), byte(3), NumberPlace(4, 4, 0, 32, False))
    assert (exchange.in_header, exchange.timeout, exchange.poll) == (0, 0, None)
    assert (ack.telemetry, ack.packet, ack.verdict) == (0x8001, None, "nak")
    assert ack.echoes == (
        Echo(NumberPlace(2, 1, 0, 8, True), 0),
        Echo(NumberPlace(3, 1, 0, 8, True), 1),
    )
    assert ack.status == NumberPlace(0, 1, 0, 3, True)
    assert ack.meanings == ((0, "ack"), (6, "ack"), (1, "busy"), (2, "progress"))
    assert ack.reason == NumberPlace(0, 2, 4, 12, True)
    assert ack.reasons == ((0, "Nothing"), (700, "Blocked"))
    assert (ack.enum.name, ack.detail) == ("Detail", None)
    assert (nak.telemetry, nak.verdict, nak.status, nak.meanings) == (
        0x8002, "nak", None, (),
    )  # fmt: skip
    assert nak.echoes == (Echo(NumberPlace(0, 4, 0, 32, False), 2),)
    assert (progress.telemetry, progress.verdict, progress.echoes) == (
        0x8003, "progress", (),
    )  # fmt: skip


def test_a_reply_with_a_status_is_a_reply_on_success(arm):
    (reply,) = arm["Read Load"].responses
    assert (reply.verdict, reply.meanings) == ("nak", ((0, "reply"), (1, "busy")))
    assert reply.is_reply and arm["Read Load"].reply == 0x0208
    assert (reply.reason, reply.reasons[3]) == (reply.status, (3, "Failed"))


def test_a_telecommand_has_its_own_timeout_and_can_have_no_response(arm):
    assert {name: exchange and exchange.timeout for name, exchange in arm.items()} == {
        "Move Joint": 0,
        "Read Position": 120,
        "Read All": 0,
        "Read Load": 0,
        "Halt": None,
    }
    assert [r.verdict for r in arm["Read All"].responses] == ["reply", "nak"]
    assert [r.verdict for r in arm["Read Position"].responses] == ["nak", "reply"]


def test_packets_repeat_each_part_of_the_id(formats):
    stop = next(row for row in formats.telecommands if row.name == "Stop").exchange
    ack, nak = stop.responses
    assert (ack.telemetry, ack.packet, ack.verdict) == (None, 0, "ack")
    # 24 bits of an id in one field, and in two: the highest byte first.
    low_24 = NumberPlace(0, 4, 0, 24, False)
    assert ack.echoes == (Echo(NumberPlace(1, 3, 0, 24, True), 0),)
    assert nak.echoes == (
        Echo(NumberPlace(2, 1, 0, 8, True), 1),
        Echo(NumberPlace(3, 2, 0, 16, True), 2),
    )
    assert stop.sources == (
        low_24,
        NumberPlace(0, 4, 16, 8, False),
        NumberPlace(0, 4, 0, 16, False),
    )
    assert (nak.packet, nak.reason) == (1, NumberPlace(1, 1, 4, 4, True))
    assert nak.reasons == ((0, "None"), (1, "Unknown"), (2, "Value"))


def test_requested_telemetry_responds_to_its_request_first(formats):
    exchange = formats.request.exchange
    reply, nak = exchange.responses
    assert (reply.telemetry, reply.packet, reply.verdict) == (None, None, "reply")
    assert (reply.echoes, reply.status, reply.reason) == ((), None, None)
    assert (nak.verdict, nak.packet, exchange.timeout) == ("nak", 1, 60)
    assert len(exchange.sources) == 2


def test_numbers_of_the_header_are_the_last_sources():
    rows = stream_of(icd_of([LINKS / "verification.yaml"])).telecommands
    exchange = rows[-1].exchange
    assert exchange.in_header == 2
    # Places in the header: 11 bits of the process, 14 bits of the sequence.
    assert exchange.sources == (
        NumberPlace(0, 2, 0, 11, False),
        NumberPlace(2, 2, 0, 14, False),
    )
    assert [exchange.is_in_header(source) for source in (0, 1)] == [True, True]
    for response in exchange.responses:
        assert [echo.source for echo in response.echoes] == [0, 1]


MIXED = """\
protocol:
  link:
    framing: {by: cobs}
    header:
      - {at: 0, bits: 8, role: id}
      - {at: 8, bits: 8, role: sequence}
    commands:
      ack: {message: Done, echo: {Number: header.sequence, Last: id, Key: Key}}
      nak: {message: Bad, echo: {Number: header.sequence}}
    client: {reply_timeout_ms: 100}
messages:
  - name: Done
    id: 6
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 8, name: Last, type: uint}
      - {at: 16, bits: 8, name: Key, type: uint}
  - name: Bad
    id: 7
    kind: telemetry
    length: 1
    fields: [{at: 0, bits: 8, name: Number, type: uint}]
  - name: Stop
    id: 3
    kind: telecommand
    length: 2
    fields: [{at: 8, bits: 8, name: Key, type: uint}]
"""


def test_responses_that_repeat_the_same_number_share_a_source(tmp_path):
    result = loaded(tmp_path, MIXED)
    assert result.ok, [finding.message for finding in result.findings]
    (row,) = stream_of(result.icd).telecommands
    exchange = row.exchange
    # Those of the header come last, although a response repeats one first.
    assert exchange.sources == (
        ID,
        NumberPlace(5, 1, 0, 8, True),
        NumberPlace(1, 1, 0, 8, True),
    )
    assert exchange.in_header == 1
    assert [exchange.is_in_header(source) for source in range(3)] == [
        False, False, True,
    ]  # fmt: skip
    done, bad = exchange.responses
    assert [(echo.place.at, echo.source) for echo in done.echoes] == [
        (0, 2), (1, 0), (2, 1),
    ]  # fmt: skip
    assert [(echo.place.at, echo.source) for echo in bad.echoes] == [(0, 2)]


DAMAGE = """\
protocol:
  link:
    framing: {by: cobs}
    header: [{at: 0, bits: 8, role: id}]
    commands:
      %s
      reasons: {checksum: Damaged, length: Long}
    client: {reply_timeout_ms: 100}
enums:
  - name: Codes
    members: [{value: 0, name: Fine}, {value: 1, name: Damaged}, {value: 2, name: Long},
              {value: 3, name: Full}]
messages:
  - name: Outcome
    id: 6
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 8, bits: 8, name: Code, type: enum, enum: Codes}
      - {at: 16, bits: 8, name: More, type: uint}
  - {name: Answer, id: 7, kind: telemetry, length: 0}
  - {name: Stop, id: 3, kind: telecommand, length: 0, response: {reply: Answer}}
"""


@pytest.mark.parametrize(
    ("response", "verdict", "meanings", "detail"),
    [
        (
            "ack: {message: Outcome, echo: Last, status: Code, success: [Fine]}",
            "nak",
            {0: "ack", 1: "again"},
            None,
        ),
        (
            "nak: {message: Outcome, echo: Last, reason: Code}",
            "nak",
            {1: "again"},
            None,
        ),
        (
            "nak: {message: Outcome, echo: Last, reason: Code, busy: [Full]}",
            "nak",
            {3: "busy", 1: "again"},
            None,
        ),
        (
            # A listed value keeps its meaning.
            "ack: {message: Outcome, echo: Last, status: Code, success: [Fine, Damaged]}",
            "nak",
            {0: "ack", 1: "ack"},
            None,
        ),
    ],
)
def test_a_damaged_telecommand_is_sent_again(
    tmp_path, response, verdict, meanings, detail
):
    result = loaded(tmp_path, DAMAGE % response)
    assert not [f for f in result.findings if f.severity == "error"], result.findings
    (row,) = stream_of(result.icd).telecommands
    (outcome,) = (each for each in row.exchange.responses if each.telemetry == 6)
    assert (outcome.verdict, dict(outcome.meanings)) == (verdict, meanings)
    assert outcome.status == NumberPlace(1, 1, 0, 8, True)
    assert (outcome.detail and outcome.detail.at) == detail


POLLED = """\
protocol:
  link:
    buses:
      i2c:
        write: {address_7bit: 0x20}
        commands: {ack: {message: Outcome, echo: Last, until: Done}}
messages:
  - {name: Stop, id: 7, kind: telecommand, length: 0}
  - name: Outcome
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 11, bits: 1, name: Done, type: bool}
"""


def test_telemetry_is_polled_until_a_number_is_not_zero(tmp_path):
    result = loaded(tmp_path, POLLED)
    bus = facts.of(result.icd, result.icd.nodes[0]).bus_exchanges["i2c"]
    assert bus.command.poll == ResponsePoll(130, NumberPlace(1, 1, 3, 1, True))
    assert bus.command.sources == (ID,)
    (reply,) = bus.request.responses
    assert (reply.verdict, reply.telemetry, bus.request.timeout) == ("reply", None, 0)


IN_TRAILER = """\
protocol:
  link:
    framing: {by: cobs}
    packets:
      refusal:
        from: device
        header: [{at: 0, bits: 8, role: constant, value: 1}, {at: 8, bits: 8, role: sequence}]
        trailer: [{at: 0, bits: 8, role: id}, {at: 8, bits: 8, role: reason, enum: Reason}]
        reserved: 5
      command: {from: host, header: [{at: 0, bits: 8, role: constant, value: 2}, {at: 8, bits: 8, role: id}]}
      read:
        from: host
        header:
          - {at: 0, bits: 8, role: constant, value: 3}
          - {at: 8, bits: 8, role: id}
          - {at: 16, bits: 8, role: sequence}
      data: {from: device, header: [{at: 0, bits: 8, role: constant, value: 4}, {at: 8, bits: 8, role: id}]}
    requests:
      packet: read
      nak: {packet: refusal, echo: {sequence: header.sequence, id: id}, reason: reason}
    client: {reply_timeout_ms: 100}
enums:
  - {name: Reason, members: [{value: 1, name: Length}]}
messages:
  - {name: State, id: 6, kind: telemetry, length: 0}
  - {name: Stop, id: 3, kind: telecommand, length: 0, response: none}
"""


def test_a_number_of_a_trailer_stands_behind_the_reserved_bytes(tmp_path):
    result = loaded(tmp_path, IN_TRAILER)
    assert result.ok, [finding.message for finding in result.findings]
    exchange = stream_of(result.icd).request.exchange
    _, nak = exchange.responses
    # Header and reserved bytes: 2 + 5.
    assert (nak.reason.at, nak.reason.size) == (8, 1)
    assert [echo.place.at for echo in nak.echoes] == [1, 7]
    # The sequence number stands in the header of the packet that requests.
    assert (exchange.in_header, exchange.sources[-1]) == (
        1,
        NumberPlace(2, 1, 0, 8, True),
    )
