"""Requests of links with a packet format try each limit of lengths, fields, buffers and
sequences, and their answers show which side was met.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.protocol.packet_formats import (
    Escaping,
    PacketField,
    PacketFormat,
    StreamRow,
)
from icdgen.protocol.packet_formats import Stream as StreamForm
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of_node
from icdgen.vectors.wire import framed
from tests.icd.files import loaded

LINK = """\
protocol:
  link:
    framing: {by: %s}
    header:
      - {at: 0, bits: 8, role: id}
      - {at: 8, bits: 4, role: source}
      - {at: 12, bits: 4, role: sequence}
    trailer: [{at: 0, bits: 8, role: checksum, checksum: sum, covers: {from: id, to: data}}]
    checksums:
      sum: {kind: sum, width: 8}
messages:
  - {name: State, id: 1, kind: telemetry, length: 4, fields: [{at: 0, bits: 32, name: A, type: uint}]}
  - {name: List, id: 0, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Count, type: uint},
     {at: 8, bits: 8, name: B, type: uint, count: Count, up_to: 20}]}
  - {name: Stop, id: 9, kind: telecommand, length: 0}
"""


class Case:
    """Requests of a link with their answers."""

    def __init__(self, folder, framing):
        result = loaded(folder, LINK % framing)
        assert result.ok, [finding.message for finding in result.findings]
        self.icd, node = result.icd, result.icd.nodes[0]
        self.form = facts.of(self.icd, node).stream
        self.link = link_of_node(self.icd, node)
        self.requests = list(framed.requests(self.link, self.form, Random(1)))

    def of(self, op, direction="telemetry"):
        return [
            (why, request)
            for why, request in self.requests
            if (request["op"], request.get("direction")) == (op, direction)
        ]

    def answer(self, request):
        return reference.answer(self.icd, request)

    def named(self, why, op="stream_events", direction="telemetry"):
        """Return the only request of a purpose."""
        (request,) = [r for w, r in self.of(op, direction) if w == why]
        return request


@pytest.fixture(scope="module")
def slip(tmp_path_factory):
    return Case(tmp_path_factory.mktemp("slip"), "slip")


@pytest.fixture(scope="module")
def datagram(tmp_path_factory):
    return Case(tmp_path_factory.mktemp("datagram"), "datagram")


def test_data_have_each_length_and_content_that_a_message_can_have(slip):
    def rows(least, most):
        row = StreamRow(1, least, most, False, 0, "M")
        data = list(framed._data(slip.form, row, Random(1)))
        return [why for why, _ in data], [content for _, content in data]

    whys, data = rows(1, 21)
    assert whys == [
        "1 random bytes", "11 random bytes", "21 random bytes", "zeros", "ones",
        "what delimiters are made of", "zeros at the end", "one byte, then zeros",
    ]  # fmt: skip
    assert [len(content) for content in data] == [1, 11] + [21] * 6
    assert data[3:5] == [bytes(21), b"\xff" * 21]
    assert set(data[5]) <= set(bytes.fromhex("007d7ec0dbdcddff"))
    assert data[6][10:] == bytes(11) and data[6][9]
    assert data[7] == b"\x01" + bytes(20)
    assert rows(2, 2)[0] == ["2 random bytes", *whys[3:6]]
    assert len(rows(3, 3)[0]) == 6
    assert rows(0, 0)[1] == [b""] * 4


def test_encoded_messages_are_decoded_and_other_lengths_are_refused(slip):
    encoded = [
        (why, request)
        for why, request in slip.of("stream_encode")
        if why.startswith(("State: ", "List: "))
    ]
    sizes = {0: set(), 1: set()}
    for why, request in encoded:
        answer, size = slip.answer(request), len(request["bytes"]) // 2
        if "does not have" in why:
            assert (answer["ok"], answer["error"]) == (False, "length"), why
            sizes[request["id"]].add(size)
            continue
        back = slip.named(f"{why}, and back")
        assert back["chunks"] == [answer["bytes"]]
        (event,) = slip.answer(back)["events"]
        assert (event["id"], event["bytes"]) == (request["id"], request["bytes"])
    # State has 4 bytes; List 1 to 21.
    assert sizes == {1: {3, 5}, 0: {0, 22}}
    (stop,) = [r for w, r in slip.of("stream_encode", "telecommand") if "not have" in w]
    assert len(stop["bytes"]) == 2  # no length below 0


@pytest.mark.parametrize("role", ["source", "sequence"])
def test_fields_of_the_sender_have_their_ends_and_one_value_beyond(slip, role):
    prefix = f"{role} "
    values = [
        r["values"][role] for w, r in slip.of("stream_encode") if w.startswith(prefix)
    ]
    assert values == [0, 1, 5, 15]
    for value in values:
        (event,) = slip.answer(slip.named(f"{role} {value}, and back"))["events"]
        assert event[role] == value
    request = slip.named(f"a {role} that does not fit", "stream_encode")
    assert request["values"] == {role: 16}
    assert slip.answer(request)["ok"] is False


def test_a_value_without_a_field_is_tried(slip):
    request = slip.named("a value that no field takes", "stream_encode")
    assert request["values"] == {"destination": 7}


def test_an_unknown_id_is_the_smallest(slip):
    requests = [r for w, r in slip.requests if w == "no such message"]
    assert [(r["direction"], r["id"], r["bytes"]) for r in requests] == [
        ("telecommand", 0, "")
    ]
    assert slip.answer(requests[0])["error"] == "unknown-id"
    assert framed._unknown(slip.form, "telemetry") == 2


def events(case, why):
    return case.answer(case.named(why))["events"]


def test_a_buffer_just_fits_and_one_byte_less_does_not(slip):
    fits = slip.named("a buffer that it just fits")
    # Header, trailer and the 4 bytes of the shorter message.
    assert fits["limit"] == 3 + 4
    assert slip.named("a buffer too small by one")["limit"] == 6
    received = [
        e
        for e in slip.answer(fits)["events"]
        if (e["event"], e.get("id")) == ("message", 1)
    ]
    assert len(received) == 4  # three of the shortest, and the last of all messages
    short = events(slip, "a buffer too small by one")
    assert not [e for e in short if e.get("event") == "message" and e.get("id") == 1]


def test_two_messages_are_cut_at_each_position_once(slip, datagram):
    cut = [r for w, r in slip.of("stream_events") if "cut behind byte" in w]
    whole = {"".join(request["chunks"]) for request in cut}
    assert len(whole) == 1
    size = len(whole.pop()) // 2
    firsts = [len(request["chunks"][0]) // 2 for request in cut]
    assert firsts == list(range(1, min(size, 40)))
    answers = [slip.answer(request)["events"] for request in cut]
    assert all(answer == answers[0] for answer in answers)
    assert not [w for w, _ in datagram.of("stream_events") if "cut behind" in w]


def test_datagrams_are_complete_empty_and_doubled(datagram):
    whys = [w for w, _ in datagram.of("stream_events") if not w.endswith("and back")]
    assert whys[:3] == [
        "packets, one after the other", "a packet of nothing", "two messages in a packet",
    ]  # fmt: skip
    nothing = datagram.named("a packet of nothing")
    assert nothing["chunks"][0] == "" and len(nothing["chunks"]) == 2
    (doubled,) = datagram.named("two messages in a packet")["chunks"]
    assert doubled == nothing["chunks"][1] * 2
    ids = [e["id"] for e in events(datagram, "packets, one after the other")]
    assert ids == [0, 1]


def test_sequences_run_over_have_gaps_and_restart(slip):
    row = slip.form.rows("telemetry")[1]
    gaps = dict(framed._gaps(slip.link, slip.form, "telemetry", row, Random(1)))
    assert list(gaps) == [
        "sequence numbers that run over", "a gap in the sequence",
        "the same message twice", "the sequence restarts", "messages in turn",
    ]  # fmt: skip

    def numbers(why):
        frames = [part for part in gaps[why].split(b"\xc0") if part]
        # Without escapes, header byte 1 has the source and the sequence.
        return [frame[1] >> 4 for frame in frames]

    assert numbers("sequence numbers that run over") == [14, 15, 0, 1]
    assert numbers("a gap in the sequence") == [3, 4, 9, 10]
    assert numbers("the same message twice") == [3, 3, 4]
    assert numbers("the sequence restarts") == [7, 0, 1]
    assert numbers("messages in turn") == [1, 1, 2, 2, 3, 3]


def test_undefined_messages_stand_between_good_ones(slip):
    row = slip.form.rows("telemetry")[1]
    tested = dict(
        framed._undefined_messages(slip.link, slip.form, "telemetry", row, b"<>")
    )
    assert list(tested) == [
        "a message of an unknown id", "a message that is too long by one",
        "a message that is too short by one",
    ]  # fmt: skip
    for why, (id, size) in zip(tested, ((2, 4), (1, 5), (1, 3)), strict=True):
        begin, line, finish = tested[why][:2], tested[why][2:-2], tested[why][-2:]
        assert begin == finish == b"<>"
        frame = line.strip(b"\xc0")
        assert (frame[0], frame[2:-1]) == (id, b"\x2a" * size)


@pytest.mark.parametrize("size", [1, 2, 5, 20])
def test_a_damaged_message_has_one_error(size):
    good = bytes(range(1, size + 1))
    *flips, (lost, short), (twice, long) = framed._damaged(good, Random(1))
    positions = [int(why.split()[1]) for why, _ in flips]
    expected = {0, 1, 2, 3, 4, size // 2, size - 2, size - 1}
    assert positions == sorted(at for at in expected if 0 <= at < size)
    for at, (_, data) in zip(positions, flips, strict=True):
        different = [n for n in range(size) if data[n] != good[n]]
        assert different == [at] and (data[at] ^ good[at]).bit_count() == 1
    half = size // 2
    assert (lost, twice) == ("a byte is lost", "a byte comes twice")
    assert short == good[:half] + good[half + 1 :]
    assert len(long) == size + (size > 1) and set(long) == set(good)


def test_a_message_is_nested_in_the_longest_if_it_fits(slip):
    rows = slip.form.rows("telemetry")
    good = bytes(range(21))
    tested = dict(framed._nested(slip.link, "telemetry", rows, good))
    line = tested["a message within another one"][: -len(good)]
    assert good in line  # 21 bytes of data
    assert tested["a message within a damaged one"] == (
        line[:-1] + bytes([line[-1] ^ 0x10]) + good + good
    )
    assert tested["messages within a truncated message"] == line[:-3] + good + good
    assert not list(framed._nested(slip.link, "telemetry", rows, bytes(22)))


def packet(name, *fields, content="none", directions=("telemetry",)):
    return PacketFormat(
        name=name, directions=directions, content=content, header_bytes=4,
        trailer_bytes=0, reserved=0, fields=fields, check=None,
    )  # fmt: skip


def field(role, bits):
    return PacketField(role, False, 0, 4, 0, bits, False, (0, 0))


def form_of(*packets, escaping=None):
    return StreamForm(
        delimited_by="slip", per_id=False, packets=packets, telecommands=(),
        telemetry=(), escaping=escaping,
    )  # fmt: skip


def test_packets_without_a_message_have_the_ends_of_id_and_fields():
    ack = packet("ack", field("id", 4), field("id", 3), field("status", 4))
    wide = packet("wide", field("id", 32), field("reason", 32))
    form = form_of(packet("data", content="message"), ack, wide)
    rows = list(framed._packets(form, Random(1)))
    refused = "{} of the {} is no packet without a message"
    assert [why for why, _ in rows if "is no packet" in why] == [
        refused.format("data", "telecommand"), refused.format("data", "telemetry"),
        refused.format("ack", "telecommand"), refused.format("wide", "telecommand"),
    ]  # fmt: skip
    ids = [r["id"] for w, r in rows if w.startswith("ack of id")]
    assert (ids[0], ids[-1], len(ids)) == (0, 127, 3)
    beyond = {w: (r["packet"], r["id"], r["values"]) for w, r in rows if "not fit" in w}
    assert beyond == {
        "ack of an id that does not fit": (1, 128, {}),
        "ack: a status that does not fit": (1, 0, {"status": 16}),
    }
    values = [(r["id"], r["values"]) for w, r in rows if w.startswith("ack: status")]
    assert values == [(127, {"status": value}) for value in (0, 1, 15)]
    values = [r["values"]["reason"] for w, r in rows if w.startswith("wide: reason")]
    assert values == [0, 1, 0xFFFFFFFF]
    assert rows[-1] == (
        "no such packet",
        {
            "op": "stream_encode_packet", "direction": "telemetry", "packet": 3,
            "id": 0, "values": {},
        },
    )  # fmt: skip


def escaping(start):
    return Escaping(escape=1, end=2, data=3, start=start, ignores_other=False)


def test_delimiters_consist_of_the_bytes_of_the_link():
    assert framed._markers(form_of(packet("p"))) == bytes.fromhex("007d7ec0dbdcddff")
    form = form_of(packet("p"), escaping=escaping(None))
    assert framed._markers(form) == bytes((1, 1, 2, 3, 0x55))
    form = form_of(packet("p"), escaping=escaping(0))
    assert framed._markers(form) == bytes((1, 0, 2, 3, 0x55))


def test_escape_bytes_come_where_they_have_another_meaning():
    assert not list(framed._escapes(form_of(packet("p")), b"abcd"))
    good = b"\x01\x09ab\x01\x02"
    rows = dict(framed._escapes(form_of(packet("p"), escaping=escaping(9)), good))
    assert rows == {
        "escape bytes before a message": b"\1\1\1" + good + b"\1\1\1\1" + good,
        "no message": b"\1\2\1\3\2" + good,
        "a message that begins within another one": good[:3] + good + good,
        "any byte after the escape byte": good[:-2] + b"\1\0\1\2" + good,
        "an escape byte before the start of a message": good[:-2]
        + b"\1\1"
        + good
        + good,
        "an empty packet": good[:2] + b"\1\2" + good,
        "a message that is too long": good[:-2] + bytes(12) + good[-2:] + good,
        "escape bytes in a message that is too long": (
            good[:-2] + b"\1\3" * 8 + good[-2:] + good
        ),
    }
