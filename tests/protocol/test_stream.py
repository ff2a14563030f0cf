"""What the reference finds in a stream does not depend on how it was cut, and whole
messages after noise are found.
"""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import facts, stream
from icdgen.protocol.envelope import PACKET, Stream
from tests.conformance import ROOT
from tests.conformance.icds import LINKS, icd_of

FOLDERS = [ROOT / "examples" / "links", LINKS]


@cache
def forms() -> dict[str, Stream]:
    icd = icd_of(FOLDERS)
    found = {node.name: facts.of(icd, node).stream for node in icd.nodes}
    return {name: form for name, form in found.items() if form}


NAMES = sorted(forms())
STREAMS = [name for name in NAMES if forms()[name].delimited_by != PACKET]


def encoded(
    form: Stream, draw: st.DrawFn, count: int = 3
) -> tuple[bytes, list[tuple[int, bytes]]]:
    """Messages in a row, on the line and as they must come out."""
    line, sent = b"", []
    for number in range(count):
        row = draw(st.sampled_from(form.rows("telemetry")))
        data = draw(st.binary(min_size=row.most, max_size=row.most))
        line += stream.encode(
            form,
            "telemetry",
            row.id,
            data,
            {"sequence": number} if form.of("sequence") else None,
        )
        sent.append((row.id, data))
    return line, sent


@pytest.mark.parametrize("name", STREAMS)
@given(data=st.data())
def test_events_do_not_depend_on_how_the_stream_was_cut(name, data):
    form = forms()[name]
    line, _ = encoded(form, data.draw, 2)
    line = data.draw(st.binary(max_size=20)) + line
    cut = data.draw(st.integers(0, len(line)))
    whole, cuts = stream.Decoder(form, "telemetry"), stream.Decoder(form, "telemetry")
    assert cuts.feed(line[:cut]) + cuts.feed(line[cut:]) == whole.feed(line)
    assert (cuts.discarded, cuts.pending) == (whole.discarded, whole.pending)


@pytest.mark.parametrize("name", STREAMS)
@given(data=st.data())
def test_messages_come_out_as_they_were_put_in(name, data):
    form = forms()[name]
    line, sent = encoded(form, data.draw)
    decoder = stream.Decoder(form, "telemetry")
    found = [event for event in decoder.feed(line) if event.event != stream.GAP]
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
    form = forms()[name]
    decoder = stream.Decoder(form, "telemetry")
    line, _ = encoded(form, data.draw, 1)
    for byte in noise + line + noise:
        decoder.feed(bytes([byte]))
        assert len(decoder.buffer) <= form.longest
        assert decoder.discarded + decoder.pending <= len(noise + line + noise)


@pytest.mark.parametrize("name", ["receiver", "positioner", "autopilot"])
@given(noise=st.binary(max_size=40), data=st.data())
def test_a_message_after_noise_is_found_once_a_longest_one_has_passed(
    name, noise, data
):
    form = forms()[name]
    line, sent = encoded(form, data.draw, 1)
    decoder = stream.Decoder(form, "telemetry")
    found = decoder.feed(noise + line + bytes(form.longest))
    assert sent[0][0] in [event.id for event in found if event.event == stream.MESSAGE]


def test_a_packet_is_a_message_by_itself():
    form = forms()["datagram"]
    line = stream.encode(form, "telemetry", 0, b"\x07")
    decoder = stream.Decoder(form, "telemetry")
    assert [event.event for packet in (line, line + line, b"") for event in decoder.feed(packet)] == [
        stream.MESSAGE, stream.OVERRUN, stream.BAD_LENGTH,
    ]  # fmt: skip
