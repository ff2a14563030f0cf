"""`icdgen log` for recorded bytes of a framed link."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import struct
from pathlib import Path
from random import Random

import pytest
from icdgen_runtime.wire.stream import StreamEvent, stream_encode

from icdgen import codec
from icdgen.icd.variants import ids_of
from icdgen.loading import load
from icdgen.logfile.recording import Recording, Tally
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from icdgen.values.frame import decoded_frame
from icdgen.vectors.make import make_vectors
from tests.conftest import ROOT
from tests.features.framed import recorded
from tests.log.test_command import icdgen
from tests.log.test_convert import _same, value_of

LINKS = ROOT / "examples" / "links"
UBX = LINKS / "ubx.yaml"
CLOCK = bytes.fromhex("B562012214004AB37B0F00000000E8030000B90B000027000000")
"""A message as it is on the line, but for its checksum."""


def ubx(*data: bytes) -> bytes:
    """Return the messages with these ids and data, with the checksum of RFC 1145."""
    line = bytearray()
    for id_and_data in data:
        body = (
            id_and_data[:2]
            + (len(id_and_data) - 2).to_bytes(2, "little")
            + id_and_data[2:]
        )
        first = second = 0
        for byte in body:
            first = (first + byte) % 256
            second = (second + first) % 256
        line += b"\xb5\x62" + body + bytes((first, second))
    return bytes(line)


CLOCK_DATA = CLOCK[2:4] + CLOCK[6:]
EPOCH, OTHER = bytes.fromhex("01614AB37B0F"), bytes.fromhex("0107000102")


@pytest.fixture
def capture(tmp_path) -> Path:
    """Write a recording: three messages, one unknown, one damaged, noise, and the start
    of another.
    """
    damaged = bytearray(ubx(EPOCH))
    damaged[-1] ^= 1
    path = tmp_path / "capture.ubx"
    path.write_bytes(
        ubx(CLOCK_DATA, EPOCH, OTHER)
        + damaged
        + b"noise"
        + ubx(CLOCK_DATA)
        + ubx(EPOCH)[:9]
    )
    return path


def test_a_recording_is_listed(capture):
    result = icdgen("receiver", capture, "--icd", UBX)
    assert result.returncode == 0, result.stderr
    lines = result.stdout.splitlines()
    assert (
        lines[0]
        == f"{capture}: telemetry of receiver, {capture.stat().st_size} bytes, 3 messages"
    )
    assert [line.split() for line in lines if re.match(r" *\d", line)] == [
        ["290", "Navigation", "Clock", "2", "40", "5"],
        ["353", "End", "of", "Epoch", "1", "4", "1"],
    ]
    for note in (
        "wrong checksum (1)",
        "ids that the ICD does not have: 263 (1)",
        "belong to no whole message: 9",
    ):
        assert note in result.stdout
    assert (
        f"bytes that belong to no message: {len(ubx(OTHER)) + len(ubx(EPOCH)) + 5}"
        in result.stdout
    )


def test_a_row_is_a_message_and_errors_are_reported(capture, tmp_path):
    result = icdgen(capture, "--icd", UBX, "--format", "csv")
    assert result.returncode == 0, result.stderr
    assert "wrong checksum (1)" in result.stderr and "no message" in result.stderr
    rows = list(csv.DictReader(io.StringIO(result.stdout)))
    assert [row["message"] for row in rows] == [
        "Navigation Clock",
        "End of Epoch",
        "Navigation Clock",
    ]
    assert [row["navigation_clock__time_of_week_ms"] for row in rows] == [
        "259765066",
        "",
        "259765066",
    ]
    assert [row["end_of_epoch__time_of_week_ms"] for row in rows] == [
        "",
        "259765066",
        "",
    ]
    assert [row["navigation_clock__clock_drift"] for row in rows] == [
        "1000",
        "",
        "1000",
    ]


def test_a_recording_can_be_limited_to_some_messages(capture):
    result = icdgen(
        "receiver", capture, "End of Epoch", "--icd", UBX, "--format", "jsonl"
    )
    assert [json.loads(line) for line in result.stdout.splitlines()] == [
        {"message": "End of Epoch", "end_of_epoch__time_of_week_ms": 259765066}
    ]
    first = icdgen(capture, "--icd", UBX, "--format", "jsonl", "--head", "1")
    assert len(first.stdout.splitlines()) == 1
    assert (
        "End of Epoch"
        not in icdgen(capture, "290", "--icd", UBX, "--format", "csv").stdout
    )


def test_a_recording_of_telecommands_is_converted(tmp_path):
    path = tmp_path / "sent"
    path.write_bytes(ubx(bytes.fromhex("0601012201"), bytes.fromhex("0122")))
    output = icdgen(
        path, "--icd", UBX, "--direction", "telecommand", "--format", "jsonl"
    ).stdout
    assert [json.loads(line)["message"] for line in output.splitlines()] == [
        "Set Message Rate",
        "Poll Clock",
    ]


def test_misuse_is_reported(capture, tmp_path):
    other = tmp_path / "other"
    other.write_bytes(b"telemetry of zebras, yaks and antelopes " * 100)
    packets = tmp_path / "packets.yaml"
    content = (LINKS / "slip.yaml").read_text().replace("slip", "datagram")
    packets.write_text(content)
    for words, expected in (
        (
            (other, "--icd", UBX),
            "holds no telemetry of receiver: bytes that belong to no message: 3,999",
        ),
        (
            (other, "--icd", UBX, "--out", tmp_path / "x.csv"),
            "holds no telemetry of receiver",
        ),
        ((capture, "--icd", packets), "ends with the packet that carries it"),
        (
            (capture, "Set Message Rate", "--icd", UBX),
            "Set Message Rate is no telemetry of receiver",
        ),
        ((capture, "End of Epok", "--icd", UBX), "has no message `End of Epok`"),
        ((tmp_path / "missing", "--icd", UBX), "cannot read"),
        ((tmp_path, "--icd", UBX), "is a folder"),
        (
            (capture, "--icd", UBX, "--format", "parquet"),
            "does not go to standard output",
        ),
    ):
        result = icdgen(*words)
        assert (
            result.returncode == 2
            and expected in result.stderr
            and "Traceback" not in result.stderr
        ), result.stderr
    assert not (tmp_path / "x.csv").exists()


def test_an_empty_recording_is_an_empty_table(tmp_path):
    (tmp_path / "empty").write_bytes(b"")
    result = icdgen(tmp_path / "empty", "--icd", UBX, "--format", "csv")
    assert (result.returncode, result.stdout) == (0, "message\n")


ODD = """\
icdgen: 1
node: {name: odd, title: Odd, byte_order: big, bit_order: msb0, id_bits: 16}
protocol:
  link:
    framing: {by: cobs}
    header: [{at: 0, bits: 16, role: id}, {at: 16, bits: 8, role: source, value: 7}]
enums: [{name: Way, members: [{value: 0, name: Down}, {value: 1, name: Up}]}]
structs:
  - name: Point
    length: 3
    fields: [{at: 0, bits: 16, name: X, type: int, formula: raw*0.1, unit: m}, {at: 16, bits: 8, name: Way, type: enum, enum: Way}]
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Levels, type: uint, count: Inner, up_to: 2}
      - {at: 8, after: Levels, bits: 8, name: End, type: uint}
messages:
  - name: Points
    id: 1000
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, name: Points, struct: Point, count: Count, up_to: 4}
  - name: Rest
    id: 1001
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 16, name: Number, type: uint}
      - {at: 16, name: Rest, type: bytes, size: rest, up_to: 8}
  - name: Text
    id: 1002
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, name: Text, type: text, size: Size, up_to: 8}
  - name: Either
    id: 1003
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 32, name: Rate, type: float, when: {Mode: 1}}
      - {at: 8, bits: 16, name: Way, type: enum, enum: Way, when: {Mode: [0, 2]}}
  - name: Zeros
    id: 1004
    kind: telemetry
    length: 6
    may_end_early: zeros
    fields:
      - {at: 0, bits: 32, name: A, type: uint}
      - {at: 32, bits: 16, name: B, type: bytes}
  - name: First
    id: 1005
    shares_id: true
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint, const: 1}
      - {at: 8, bits: 8, name: Value, type: uint}
  - name: Second
    id: 1005
    shares_id: true
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint, const: 2}
      - {at: 8, bits: 8, name: Value, type: int}
  - {name: Nothing, id: 1006, kind: telemetry, length: 0}
  - name: Behind
    id: 1007
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, bits: 8, name: Size, type: uint}
      - {at: 16, bits: 8, name: Length, type: uint}
      - {at: 24, bits: 8, name: Age, type: uint}
      - {at: 32, name: Points, struct: Point, count: Count, up_to: 3}
      - {at: 32, after: Points, name: Key, type: bytes, size: Size, up_to: 4}
      - {at: 32, after: Key, name: Words, type: text, size: Length, up_to: 5}
  - name: Curves
    id: 1008
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Inner, type: uint}
      - {at: 8, bits: 8, name: Count, type: uint}
      - {at: 16, name: Curves, struct: Curve, count: Count, up_to: 3}
  - name: Checked
    id: 1009
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, name: Payload, type: bytes, size: rest, up_to: 6}
      - {at: 8, after: Payload, name: Last, struct: Point}
      - {at: 8, after: Last, bits: 16, name: CRC, type: uint}
"""


def test_every_kind_of_message_has_the_values_of_the_reference_codec(tmp_path):
    import pyarrow.parquet as pq

    (tmp_path / "odd.yaml").write_text(ODD)
    loaded = load([tmp_path / "odd.yaml"])
    assert loaded.ok, loaded.findings
    icd, random = loaded.icd, Random(1)
    node = icd.nodes[0]
    frames = [
        (message.message, row.frame)
        for message in make_vectors(icd, node).messages
        for row in message.rows
        if _is_sent(icd, message, row)
    ]
    random.shuffle(frames)
    sent = b"".join(
        recorded(icd, node, {message.name: [data]})["telemetry"]
        for message, data in frames
    )
    (tmp_path / "sent").write_bytes(sent)
    wanted = []
    for message, data in frames:
        rows = decoded_frame(icd, node, message, data).rows
        wanted.append((message.name, [_same(value_of(row)) for row in rows]))
    assert len({name for name, _ in wanted}) == 11 and len(wanted) > 100
    icd_option = ("--icd", tmp_path / "odd.yaml")
    result = icdgen(tmp_path / "sent", *icd_option, "--format", "jsonl")
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    assert {row.pop("source") for row in rows} == {7}
    assert [
        (row.pop("message"), [_short(value) for value in row.values()]) for row in rows
    ] == [(name, [_short(value) for value in values]) for name, values in wanted]
    icdgen(tmp_path / "sent", *icd_option, "--out", tmp_path / "sent.parquet")
    table = (
        pq.read_table(tmp_path / "sent.parquet").drop_columns(["source"]).to_pylist()
    )
    got = [
        (
            row.pop("message"),
            [_same(_read(value)) for value in row.values() if value is not None],
        )
        for row in table
    ]
    assert got == wanted


def _is_sent(icd, sample, row) -> bool:
    """Return whether the row is a frame of that message that the reference codec
    accepts.
    """
    candidates = [
        variant.message
        for variant in ids_of(icd, icd.nodes[0]).telemetry[sample.message.telemetry_id]
    ]
    try:
        codec.decode(icd.nodes[0], sample.message, row.frame)
        return codec.message_of_frame(icd, candidates, row.frame) is sample.message
    except codec.LengthError:
        return False


def _short(value: object) -> object:
    """Return a value as in text output: the shortest form of a float, null for NaN and
    infinity.
    """
    if value == "nan" or (isinstance(value, float) and math.isinf(value)):
        return None
    return (
        struct.unpack("<f", struct.pack("<f", value))[0]
        if isinstance(value, float)
        else value
    )


def _read(value: object) -> object:
    return value.hex() if isinstance(value, bytes) else value


PACKETS = """\
icdgen: 1
node: {name: odd, title: Odd, byte_order: big, bit_order: msb0, id_bits: 8}
protocol:
  link:
    framing: {by: cobs}
    packets:
      command:
        from: host
        header: [{bits: 8, role: constant, value: 1}, {bits: 8, role: id}, {bits: 8, role: sequence}]
      query:
        from: host
        messages: [Ask]
        header: [{bits: 8, role: constant, value: 2}, {bits: 8, role: id}]
      data:
        from: device
        header: [{bits: 8, role: id}, {bits: 8, role: time}]
messages:
  - {name: Set, id: 1, kind: telecommand, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
  - {name: Ask, id: 2, kind: telecommand, length: 1, fields: [{at: 0, bits: 8, name: B, type: uint}]}
  - {name: State, id: 3, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: C, type: uint}]}
"""


@pytest.mark.parametrize(
    ("direction", "sent", "rows"),
    [
        (
            "telecommand",
            "0501010709000402020800",
            [
                {"message": "Set", "sequence": 7, "set__a": 9, "ask__b": None},
                {"message": "Ask", "sequence": None, "set__a": None, "ask__b": 8},
            ],
        ),
        ("telemetry", "0403070900", [{"message": "State", "time": 7, "state__c": 9}]),
    ],
)
def test_header_columns_are_the_header_fields_of_the_direction(
    tmp_path, direction, sent, rows
):
    import pyarrow.parquet as pq

    icd = tmp_path / "odd.yaml"
    icd.write_text(PACKETS)
    (tmp_path / "sent").write_bytes(bytes.fromhex(sent))
    options = (tmp_path / "sent", "--icd", icd, "--direction", direction)
    result = icdgen(*options, "--format", "csv")
    assert result.returncode == 0, result.stderr
    assert list(csv.DictReader(io.StringIO(result.stdout))) == [
        {name: "" if value is None else str(value) for name, value in row.items()}
        for row in rows
    ]
    assert icdgen(*options, "--out", tmp_path / "sent.parquet").returncode == 0
    assert pq.read_table(tmp_path / "sent.parquet").to_pylist() == rows


@pytest.mark.parametrize("direction", ["telecommand", "telemetry"])
def test_a_packet_that_carries_no_message_gives_no_column(tmp_path, direction):
    import pyarrow.parquet as pq

    file = LINKS / "jbd.yaml"
    icd = load([file]).icd
    node = icd.nodes[0]
    frames = {
        message.message.name: [row.frame for row in message.rows[:2]]
        for message in make_vectors(icd, node).messages
    }
    (tmp_path / "sent").write_bytes(recorded(icd, node, frames)[direction])
    options = (tmp_path / "sent", "--icd", file, "--direction", direction)
    assert icdgen(*options, "--out", tmp_path / "sent.parquet").returncode == 0
    names = pq.read_table(tmp_path / "sent.parquet").column_names
    assert "reason" not in names and len(names) > 1


@pytest.mark.parametrize(
    "name", ["slip", "cobs", "hdlc", "tsip", "mavlink2", "sbp", "ccsds", "kiss"]
)
def test_every_kind_of_delimiter_is_supported(name, tmp_path):
    file = LINKS / f"{name}.yaml"
    icd = load([file]).icd
    node = icd.nodes[0]
    frames = {
        message.message.name: [row.frame for row in message.rows[:5]]
        for message in make_vectors(icd, node).messages
    }
    sent = recorded(icd, node, frames)["telemetry"]
    (tmp_path / "sent").write_bytes(sent)
    wanted = {
        message.name: len(frames[message.name])
        for message in node.messages
        if message.telemetry_id is not None
    }
    tally = Recording(icd, node, tmp_path / "sent").survey(None, lambda size: None)
    assert {
        name: times for (_, name), times in tally.messages.items()
    } == wanted and not tally.faults


def test_lost_and_repeated_messages_are_counted_by_their_sequence_numbers(tmp_path):
    icd = load([LINKS / "ccsds.yaml"]).icd
    link = link_of(icd, facts.of(icd, icd.nodes[0]))
    path = tmp_path / "packets"
    path.write_bytes(
        b"".join(
            stream_encode(link, 0x64, bytes(6), "telemetry", sequence=number)
            for number in (7, 8, 11, 11, 12, 17)
        )
    )
    listed = icdgen(path, "--icd", LINKS / "ccsds.yaml").stdout
    assert f"{path.stat().st_size} bytes, 6 messages" in listed
    assert "messages missing, by their sequence numbers: 6\n" in listed
    assert "messages that came again, by their sequence numbers: 1\n" in listed


def test_messages_in_sequence_have_no_note(tmp_path):
    icd = load([LINKS / "ccsds.yaml"]).icd
    link = link_of(icd, facts.of(icd, icd.nodes[0]))
    path = tmp_path / "packets"
    numbers = (16382, 16383, 0, 1)  # 14 bits: they begin again at 0
    path.write_bytes(
        b"".join(
            stream_encode(link, 0x64, bytes(6), "telemetry", sequence=number)
            for number in numbers
        )
    )
    assert "sequence numbers" not in icdgen(path, "--icd", LINKS / "ccsds.yaml").stdout


def test_the_notes_of_the_first_messages_are_about_the_bytes_up_to_them(
    capture, monkeypatch
):
    icd = load([UBX]).icd
    capture.write_bytes(b"noise" + capture.read_bytes())
    lost = []
    # Whether the file is read in one piece or in many makes no difference.
    for piece_bytes in (1 << 18, 64, 7, 1):
        monkeypatch.setattr("icdgen.logfile.recording._PIECE", piece_bytes)
        recording = Recording(icd, icd.nodes[0], capture)
        for head in (1, 2, 3, None):
            tally = recording.survey(head, lambda size: None)
            assert tally.cut == (9 if head is None else 0), "the end was not read"
            lost.append(tally.lost)
    between = len(ubx(OTHER)) + len(ubx(EPOCH)) + 5
    assert lost == [5, 5, 5 + between, 5 + between] * 4


@pytest.mark.parametrize("name", ["tsip", "hdlc", "sbp"])
def test_lost_bytes_before_the_first_messages_are_counted_in_all_framings(
    name, tmp_path
):
    icd = load([LINKS / f"{name}.yaml"]).icd
    node = icd.nodes[0]
    frames = {
        message.message.name: [row.frame for row in message.rows[:2]]
        for message in make_vectors(icd, node).messages
    }
    sent = recorded(icd, node, frames)["telemetry"]
    lost = []
    for data in (sent, sent[3:] + sent, sent[3:] + sent + sent[3:]):
        (tmp_path / "sent").write_bytes(data)
        tally = Recording(icd, node, tmp_path / "sent").survey(1, lambda size: None)
        lost.append(tally.lost)
    assert lost[0] == 0 and lost[1] == lost[2] > 0


def test_requests_and_packets_without_a_message_are_no_errors():
    tally = Tally()
    for event in ("request", "packet", "packet", "checksum"):
        tally.fault(StreamEvent(event, 3))
    assert tally.notes() == [
        "not taken: wrong checksum (1)",
        "requests of telemetry: 1",
        "packets without a message: 2",
    ]


def test_unknown_ids_beyond_the_limit_are_in_the_list_of_ids():
    tally = Tally()
    for id in range(100):
        tally.fault(StreamEvent("unknown_id", id))
    assert tally.notes() == [
        "ids that the ICD does not have: 0 (1), 1 (1), 2 (1), 3 (1), 4 (1), 5 (1), "
        "6 (1), 7 (1) and at least 57 others"
    ]
