"""What the decoder finds in a stream does not depend on how it was cut, and whole
messages after noise are found.
"""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.stream import StreamDecoder, stream_encode

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conformance import ROOT
from tests.conformance.icds import LINKS, icd_of

FOLDERS = [ROOT / "examples" / "links", LINKS]


@cache
def links() -> dict[str, Link]:
    icd = icd_of(FOLDERS)
    found = {node.name: link_of(icd, facts.of(icd, node)) for node in icd.nodes}
    return {name: link for name, link in found.items() if link.stream}


STREAMS = sorted(
    name for name, link in links().items() if link.stream.delimited_by != "datagram"
)


def encoded(
    link: Link, draw: st.DrawFn, count: int = 3
) -> tuple[bytes, list[tuple[int, bytes]]]:
    """Messages in a row, on the line and as they must come out.

    A packet that does not tell its message comes out as a whole.
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
    whole, cuts = StreamDecoder(link), StreamDecoder(link)
    assert cuts.feed(line[:cut]) + cuts.feed(line[cut:]) == whole.feed(line)
    assert (cuts.discarded, cuts.pending) == (whole.discarded, whole.pending)


@pytest.mark.parametrize("name", STREAMS)
@given(data=st.data())
def test_messages_come_out_as_they_were_put_in(name, data):
    link = links()[name]
    line, sent = encoded(link, data.draw)
    decoder = StreamDecoder(link)
    found = [event for event in decoder.feed(line) if event.event != "gap"]
    assert [
        (event.id, event.data.ljust(len(data), b"\0"))
        for event, (_, data) in zip(found, sent, strict=True)
    ] == sent
    assert (decoder.discarded, decoder.pending) == (0, 0)


@pytest.mark.parametrize("name", STREAMS)
@given(noise=st.binary(max_size=60), data=st.data())
def test_every_byte_is_accounted_for_and_no_more_than_a_message_is_held(
    name, noise, data
):
    link = links()[name]
    decoder = StreamDecoder(link)
    line, _ = encoded(link, data.draw, 1)
    for byte in noise + line + noise:
        decoder.feed(bytes([byte]))
        assert len((decoder._line or decoder)._buffer) <= link.longest
        assert decoder.discarded + decoder.pending <= len(noise + line + noise)


@pytest.mark.parametrize("name", ["receiver", "positioner", "autopilot"])
@given(noise=st.binary(max_size=40), data=st.data())
def test_a_message_after_noise_is_found_once_a_longest_one_has_passed(
    name, noise, data
):
    link = links()[name]
    line, sent = encoded(link, data.draw, 1)
    decoder = StreamDecoder(link)
    found = decoder.feed(noise + line + bytes(link.longest))
    assert sent[0][0] in [event.id for event in found if event.event == "message"]


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
