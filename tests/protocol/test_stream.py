"""The decoder of a stream finds complete messages after noise, and its events do not
depend on how the stream is cut into pieces.
"""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.stream import (
    StreamDecoder,
    stream_encode,
    stream_encode_request,
)

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conformance import ROOT
from tests.conformance.icds import LINKS, icd_of

FOLDERS = [ROOT / "examples" / "links", LINKS]


@cache
def links() -> dict[str, Link]:
    icd = icd_of(FOLDERS)
    links_by_node = {node.name: link_of(icd, facts.of(icd, node)) for node in icd.nodes}
    return {name: link for name, link in links_by_node.items() if link.stream}


STREAMS = sorted(
    name for name, link in links().items() if link.stream.delimited_by != "datagram"
)


def encoded(
    link: Link, draw: st.DrawFn, count: int = 3
) -> tuple[bytes, list[tuple[int, bytes]]]:
    """Return messages in a row: the bytes on the line, and the messages that must be
    decoded.

    A packet that does not identify its message is decoded as a packet.
    """
    line, sent = b"", []
    plain = link._replace(stream=link.stream._replace(delimited_by="datagram"))
    for number in range(count):
        row = draw(st.sampled_from(link.stream.rows("telemetry")))
        data = draw(st.binary(min_size=row.most, max_size=row.most))
        values = (
            {"sequence": number}
            if "sequence" in link.stream.chosen("telemetry")
            else {}
        )
        line += stream_encode(link, row.id, data, "telemetry", **values)
        if link.stream.packets[row.packet].tells_message:
            sent.append((row.id, data))
        else:
            packet = stream_encode(plain, row.id, data, "telemetry", **values)
            sent.append((0, packet))
    return line, sent


@pytest.mark.parametrize("name", STREAMS)
@given(data=st.data())
def test_events_do_not_depend_on_how_the_stream_was_cut(name, data):
    link = links()[name]
    line, _ = encoded(link, data.draw, 2)
    line = data.draw(st.binary(max_size=20)) + line
    cut = data.draw(st.integers(0, len(line)))
    uncut, cuts = StreamDecoder(link), StreamDecoder(link)
    assert cuts.feed(line[:cut]) + cuts.feed(line[cut:]) == uncut.feed(line)
    assert (cuts.discarded, cuts.pending) == (uncut.discarded, uncut.pending)


@pytest.mark.parametrize("name", STREAMS)
@given(data=st.data())
def test_encoded_messages_are_decoded_unchanged(name, data):
    link = links()[name]
    line, sent = encoded(link, data.draw)
    decoder = StreamDecoder(link)
    events = [event for event in decoder.feed(line) if event.event != "gap"]
    assert [
        (event.id, event.data.ljust(len(data), b"\0"))
        for event, (_, data) in zip(events, sent, strict=True)
    ] == sent
    assert (decoder.discarded, decoder.pending) == (0, 0)


@pytest.mark.parametrize("name", STREAMS)
@given(noise=st.binary(max_size=60), data=st.data())
def test_every_byte_is_counted_and_at_most_one_message_is_buffered(name, noise, data):
    link = links()[name]
    decoder = StreamDecoder(link)
    line, _ = encoded(link, data.draw, 1)
    for byte in noise + line + noise:
        decoder.feed(bytes([byte]))
        assert len((decoder._line or decoder)._buffer) <= link.longest
        assert decoder.discarded + decoder.pending <= len(noise + line + noise)


@pytest.mark.parametrize("name", ["receiver", "positioner", "autopilot"])
@given(noise=st.binary(max_size=40), data=st.data())
def test_a_message_after_noise_is_found_within_the_length_of_a_longest_message(
    name, noise, data
):
    link = links()[name]
    line, sent = encoded(link, data.draw, 1)
    decoder = StreamDecoder(link)
    events = decoder.feed(noise + line + bytes(link.longest))
    assert sent[0][0] in [event.id for event in events if event.event == "message"]


@pytest.mark.parametrize(
    ("numbers", "gaps"),
    [
        ([7], []),
        ([254, 255, 0, 1], []),
        ([255, 0, 0], [0]),
        ([255, 0, 2], [1]),
        ([3, 6], [2]),
        ([3, 2], [254]),
        ([255, 1, 2, 1], [1, 254]),
        ([0, 255, 0], [254]),
    ],
)
def test_a_gap_states_how_many_messages_of_the_sequence_are_missing(numbers, gaps):
    link = links()["rover"]
    line = b"".join(
        stream_encode(link, 2, bytes(12), "telemetry", sequence=number)
        for number in numbers
    )
    events = StreamDecoder(link).feed(line)
    assert [(event.id, event.missing) for event in events if event.event == "gap"] == [
        (2, missing) for missing in gaps
    ]


@pytest.mark.parametrize(
    ("node", "ids", "gaps"),
    [
        ("gauge", [(63, 0), (2, 7), (63, 1), (2, 9)], [(2, 1)]),
        ("rover", [(0, 0), (2, 1), (0, 1)], [(0, 0)]),
    ],
)
def test_messages_of_other_ids_count_unless_each_id_has_its_own_sequence(
    node, ids, gaps
):
    link = links()[node]
    lengths = {row.id: row.most for row in link.stream.rows("telemetry")}
    line = b"".join(
        stream_encode(link, id, bytes(lengths[id]), "telemetry", sequence=number)
        for id, number in ids
    )
    events = StreamDecoder(link).feed(line)
    assert [
        (event.id, event.missing) for event in events if event.event == "gap"
    ] == gaps


@pytest.mark.parametrize(
    "name",
    [
        name
        for name, link in links().items()
        if any(packet.content == "request" for packet in link.stream.packets)
    ],
)
def test_a_device_decodes_a_request_of_each_telemetry(name):
    link = links()[name]
    requests = {
        row.id: stream_encode_request(link, row.id)
        for row in link.stream.rows("telemetry")
        if row.is_requested
    }
    decoder = StreamDecoder(link, "telecommand")
    events = decoder.feed(b"".join(requests.values()))
    assert [
        (event.event, event.id, event.data) for event in events if event.event != "gap"
    ] == [("request", id, b"") for id in requests]
    assert requests and decoder.discarded == 0


SEEDED = """
icdgen: 1
node: {name: device, title: Device, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    packets:
      host:
        from: host
        header: [{bits: 8, role: id}]
        trailer: [{bits: 8, role: checksum, checksum: sent, covers: {from: id, to: data}}]
      device:
        from: device
        header: [{bits: 8, role: id}]
        trailer: [{bits: 8, role: checksum, checksum: received, covers: {from: id, to: data}}]
    checksums:
      sent: {kind: sum, width: 8, seeds: {Go: 1, Status: 2}}
      received: {kind: sum, width: 8, seeds: {Go: 3, Status: 4}}
messages:
  - {name: Go, id: 1, kind: telecommand, length: 1, fields: [{at: 0, bits: 8, name: Mode, type: uint}]}
  - {name: Status, id: 2, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Mode, type: uint}]}
"""


def test_a_message_has_the_seed_of_the_checksum_of_its_packet(tmp_path):
    (tmp_path / "device.yaml").write_text(SEEDED)
    icd = icd_of([tmp_path / "device.yaml"])
    link = link_of(icd, facts.of(icd, icd.node("device")))
    assert stream_encode(link, 1, b"\7", "telecommand").hex() == "010709"
    assert stream_encode(link, 2, b"\7", "telemetry").hex() == "02070d"


def test_a_packet_is_a_message_by_itself():
    link = links()["datagram"]
    line = stream_encode(link, 0, b"\x07", "telemetry")
    decoder = StreamDecoder(link)
    assert [event.event for packet in (line, line + line, b"") for event in decoder.feed(packet)] == [
        "message", "overrun", "length",
    ]  # fmt: skip
