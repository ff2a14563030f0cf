"""Recognition of all frames in a text or in received bytes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from icdgen_runtime.wire.uart import UartDecoder, UartEvent

from icdgen.describe.numbers import byte_count
from icdgen.icd.model import Icd
from icdgen.recognize import bus, envelopes, faults, match
from icdgen.recognize.asked import Asked, asked_for
from icdgen.recognize.given import of_asked
from icdgen.recognize.pasted import Pasted, read
from icdgen.recognize.reading import Reading, Speaker, all_speakers, speaker_of
from icdgen.values.errors import Ambiguous, BadHex, BadLength, NotFound
from icdgen.values.find import KINDS, find_node
from icdgen.values.frame import frame


def recognize(
    icd: Icd, text: str | bytes, node: str | None = None, key: str | None = None, kind: str | None = None
) -> list[Reading]:
    """Return the frames in a text, or in bytes as received.

    ``node``, ``key`` and ``kind`` restrict the messages, as for
    `icdgen.values.find_message`. If each line is a complete frame, the lines are
    recognized separately. Raise `BadHex`, `BadLength`, `NotFound` or `Ambiguous`.
    """
    owner = find_node(icd, node) if node is not None else None
    asked = asked_for(icd, owner, key, kind)
    speakers = [speaker_of(icd, owner)] if owner else all_speakers(icd)
    if isinstance(text, bytes):
        return _readings(icd, speakers, Pasted(text), asked)
    lines = [line for line in text.splitlines() if line.strip()]
    by_line = _line_by_line(icd, speakers, lines, asked)
    if by_line and not asked.messages and all(reading.id is not None for reading in by_line):
        return by_line
    try:
        return _readings(icd, speakers, read(text), asked)
    except (Ambiguous, BadHex, BadLength, NotFound):
        if by_line:
            return by_line
        raise


def _line_by_line(icd: Icd, speakers: Sequence[Speaker], lines: Sequence[str], asked: Asked) -> list[Reading]:
    """Return the frames if there are several lines and each is a complete frame."""
    if len(lines) < 2:
        return []
    with suppress(Ambiguous, BadHex, BadLength, NotFound):
        pasted = [read(line) for line in lines]
        if not any(pasted_line.packets or pasted_line.form for pasted_line in pasted):
            return [reading for pasted_line in pasted for reading in _readings(icd, speakers, pasted_line, asked)]
    return []


def _readings(icd: Icd, speakers: Sequence[Speaker], pasted: Pasted, asked: Asked) -> list[Reading]:
    if pasted.packets and any(speaker.facts.can for speaker in speakers):
        results = bus.readings(speakers, pasted.packets, asked)
    else:
        results = _framed(speakers, pasted.whole, asked) or _unframed(icd, speakers, pasted, asked)
    left_out = [text for reading in results for text in reading.left_out]
    results = asked.of(results)
    if asked.messages and not any(map(asked.is_of, results)):
        text = f"the frame is not {asked.names} but {results[0].title}"
        raise NotFound(text, "leave the message out, or name that one")
    if asked.messages:
        results = [reading for reading in results if asked.is_of(reading)]
    # The first reading has the reports. Restore them if the selection dropped it.
    if not results[0].left_out:
        results[0] = results[0].without(*left_out)
    note = (f"read as {pasted.form}",) if pasted.form else ()
    return [_decoded(icd, reading.noted(*note)) for reading in results]


def _framed(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """Return the messages in a stream with framing.

    Return no messages if there is no framing, or if a named message has exactly these
    bytes.
    """
    if asked.can_be(data):
        if enveloped := _surely_enveloped(speakers, data, asked):
            return enveloped
        if (fault := envelopes.begun(speakers, data)) and fault.is_certain:
            raise fault.error
        return []
    if enveloped := envelopes.readings(speakers, data, asked):
        return enveloped
    for framing in dict.fromkeys(speaker.link.framing for speaker in speakers if speaker.link.framing):
        if bytes((framing.escape, framing.start)) not in data:
            continue
        talking = [speaker for speaker in speakers if speaker.link.framing == framing]
        decoder = UartDecoder(talking[0].link, max(len(data), 1))
        events = decoder.feed(data)
        bodies = [event.message for event in events if event.event == "message"]
        if not bodies:
            if data[:2] == bytes((framing.escape, framing.start)):
                raise BadLength(_broken(events), 0, len(data), "the frame is cut off, or a byte of it is damaged")
            continue
        matches, failures = match.each(bodies, partial(_of_body, talking, asked=asked))
        errors = [event.event for event in events if event.event != "message"]
        left = [str(error) for error in failures] + [
            f"the stream has an error: {error_name.replace('_', ' ')}" for error_name in errors
        ]
        if decoder.pending > 1:
            left.append(_broken([]))
        around = match.around(decoder.discarded + decoder.pending, ())
        return [matches[0].without(*left).noted(*around), *matches[1:]]
    return []


def _refuse_pieces(speakers: Sequence[Speaker], data: bytes) -> None:
    """Raise `BadLength` for a frame that is cut off: its first byte, or its end only."""
    for framing in dict.fromkeys(speaker.link.framing for speaker in speakers if speaker.link.framing):
        if data == bytes((framing.escape,)):
            raise BadLength(_broken([]), 0, len(data), "the frame is cut off")
        if len(data) > 2 and data.endswith(bytes((framing.escape, framing.end))):
            raise BadLength(
                "the framing ends, but the start of the message is missing", 0, len(data), "the frame is cut off"
            )


def _surely_enveloped(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """Return messages with header and trailer whose checksum is right.

    A message of variable length can be as long as another one with header and trailer.
    The checksum distinguishes them.
    """
    with suppress(Ambiguous, BadLength):
        return [
            reading for reading in envelopes.readings(speakers, data, asked) if reading.checked and asked.is_of(reading)
        ]
    return []


def _broken(events: list[UartEvent]) -> str:
    """Return the error of a stream with framing but without a message."""
    if any(event.event == "protocol_error" for event in events):
        return "the framing is broken: the escape byte is followed by neither itself nor an end of message"
    return "the framing is empty" if events else "the framing begins, but the end of the message is missing"


def _of_body(speakers: Sequence[Speaker], body: bytes, asked: Asked) -> Reading:
    candidates = match.by_id(speakers, body)
    if not candidates:
        raise match.why_none(speakers, body)
    reading = match.decided(candidates, f"a frame with id {body[0]}", asked)
    return replace(reading, remarks=(f"framing with id {body[0]} removed", *reading.remarks))


def _unframed(icd: Icd, speakers: Sequence[Speaker], pasted: Pasted, asked: Asked) -> list[Reading]:
    """Return the messages of CAN packets by their identifiers, or the message of bytes.

    If no identifier matches, the bytes are those of a message that the user has named.
    """
    if not pasted.packets:
        return [_bare(icd, speakers, pasted.data, asked)]
    try:
        return bus.by_identifier(speakers, pasted.packets, asked)
    except NotFound as error:
        if not asked.messages:
            raise
        return [_bare(icd, speakers, pasted.whole, asked).noted(str(error))]


def _bare(icd: Icd, speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Reading:
    """Return the message of bytes without framing. Raise `BadLength`, `NotFound` or `Ambiguous`."""
    if not data and not asked.messages:
        raise BadLength("there are no bytes", 1, 0, "give a frame")
    fault = envelopes.begun(speakers, data)
    if asked.messages:
        reading = of_asked(icd, speakers[0], asked.messages, data)
        return reading.noted(f"the data begin like a packet: {fault.text}") if fault else reading
    if fault:
        raise fault.error
    _refuse_pieces(speakers, data)
    # Without constant first bytes, any data may be a piece of a packet.
    plainly = [
        speaker
        for speaker in speakers
        if speaker.link.stream is None or (asked.kind and faults.has_sync(speaker.link.stream))
    ]
    if not plainly:
        raise _no_packet(speakers, data, asked)
    return _guessed(plainly, data, asked)


def _no_packet(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Ambiguous | NotFound:
    """Return the error for bytes without the framing that all messages of the node have."""
    nodes, syncs = match.nodes_of(speakers), dict.fromkeys(map(envelopes.sync_of, speakers))
    begin = f", which begin with {' or '.join(filter(None, syncs))}" if any(syncs) else ""
    text = f"{byte_count(len(data))} are no packet of {nodes}{begin}"
    candidates = asked.of([*match.by_id(speakers, data), *match.by_length(speakers, data)])
    if candidates:
        return Ambiguous(f"{text}; as data alone they can be {match.named(candidates)}", match.HELP)
    return NotFound(text, f"check that the capture is complete; {match.HELP} reads the data of a message alone")


def _guessed(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Reading:
    """Return a message without framing, by its id or its length.

    Raise `Ambiguous`, `BadLength` or `NotFound`.
    """
    given = byte_count(len(data))
    with_id, plain = match.by_id(speakers, data), match.by_length(speakers, data)
    if any(map(asked.fits, plain)) and not any(map(asked.fits, with_id)):
        with_id = []
    if with_id:
        reading = match.decided(with_id, f"{given} beginning with the id {with_id[0].id}", asked)
        alternatives = [alternative for alternative in plain if alternative.key != reading.key]
        note = [f"without an id in front it could be {match.named(alternatives)}"] if alternatives else []
        return reading.noted(f"id {reading.id} removed", *note)
    if plain:
        reading = match.decided(plain, f"{given} without an id", asked)
        return replace(reading, id=None).noted("found by its length alone")
    raise match.why_none(speakers, data)


def _decoded(icd: Icd, reading: Reading) -> Reading:
    """Return a reading with its decoded frame, if it has data."""
    if reading.what not in KINDS:
        return reading
    decoded = frame(icd, reading.speaker.node, reading.message, reading.data)
    return replace(reading, frame=replace(decoded, remarks=(*reading.remarks, *decoded.remarks)))
