"""What the frames in a text are: framing and checksums come off, node and message are found."""

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
    """What the frames in a text are, or in bytes as they came over a line.

    ``node`` and ``key`` say whose they are and which message, as `icdgen.values.find_message` takes them. Lines of which
    each is a frame of its own are read one by one. Raises `BadHex`, `BadLength`, `NotFound` or `Ambiguous`.
    """
    owner = find_node(icd, node) if node is not None else None
    asked = asked_for(icd, owner, key, kind)
    speakers = [speaker_of(icd, owner)] if owner else all_speakers(icd)
    if isinstance(text, bytes):
        return _readings(icd, speakers, Pasted(text), asked)
    lines = [line for line in text.splitlines() if line.strip()]
    apart = _line_by_line(icd, speakers, lines, asked)
    if apart and not asked.messages and all(one.id is not None for one in apart):
        return apart
    try:
        return _readings(icd, speakers, read(text), asked)
    except (Ambiguous, BadHex, BadLength, NotFound):
        if apart:
            return apart
        raise


def _line_by_line(icd: Icd, speakers: Sequence[Speaker], lines: Sequence[str], asked: Asked) -> list[Reading]:
    """The frames, if there are several lines and each is one."""
    if len(lines) < 2:
        return []
    with suppress(Ambiguous, BadHex, BadLength, NotFound):
        pasted = [read(line) for line in lines]
        if not any(one.packets or one.form for one in pasted):
            return [found for one in pasted for found in _readings(icd, speakers, one, asked)]
    return []


def _readings(icd: Icd, speakers: Sequence[Speaker], pasted: Pasted, asked: Asked) -> list[Reading]:
    if pasted.packets and any(speaker.facts.can for speaker in speakers):
        found = bus.readings(speakers, pasted.packets, asked)
    else:
        found = _framed(speakers, pasted.whole, asked) or _unframed(icd, speakers, pasted, asked)
    left_out = [text for one in found for text in one.left_out]
    found = asked.of(found)
    if asked.messages and not any(map(asked.is_of, found)):
        text = f"the frame is not {asked.names} but {found[0].title}"
        raise NotFound(text, "leave the message out, or name that one")
    if asked.messages:
        found = [one for one in found if asked.is_of(one)]
    if not found[0].left_out:  # the reading that had the reports is not of the message or kind
        found[0] = found[0].without(*left_out)
    note = (f"read as {pasted.form}",) if pasted.form else ()
    return [_decoded(icd, one.noted(*note)) for one in found]


def _framed(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """The messages in a stream with framing; none if it has none, or its bytes are just those of the message asked for."""
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
        found, wrong = match.each(bodies, partial(_of_body, talking, asked=asked))
        errors = [event.event for event in events if event.event != "message"]
        left = [str(error) for error in wrong] + [f"the stream has an error: {one.replace('_', ' ')}" for one in errors]
        if decoder.pending > 1:
            left.append(_broken([]))
        around = match.around(decoder.discarded + decoder.pending, ())
        return [found[0].without(*left).noted(*around), *found[1:]]
    return []


def _refuse_pieces(speakers: Sequence[Speaker], data: bytes) -> None:
    """Raises `BadLength` for bytes that are a piece of a frame with framing: its first byte, or all but its beginning."""
    for framing in dict.fromkeys(speaker.link.framing for speaker in speakers if speaker.link.framing):
        if data == bytes((framing.escape,)):
            raise BadLength(_broken([]), 0, len(data), "the frame is cut off")
        if len(data) > 2 and data.endswith(bytes((framing.escape, framing.end))):
            raise BadLength(
                "the framing ends, but the start of the message is missing", 0, len(data), "the frame is cut off"
            )


def _surely_enveloped(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """Of messages whose frames differ in length one in its envelope can be as long as another without: a checksum tells."""
    with suppress(Ambiguous, BadLength):
        return [
            reading for reading in envelopes.readings(speakers, data, asked) if reading.checked and asked.is_of(reading)
        ]
    return []


def _broken(events: list[UartEvent]) -> str:
    if any(event.event == "protocol_error" for event in events):
        return "the framing is broken: the escape byte is followed by neither itself nor an end of message"
    return "the framing is empty" if events else "the framing begins, but the end of the message is missing"


def _of_body(speakers: Sequence[Speaker], body: bytes, asked: Asked) -> Reading:
    found = match.by_id(speakers, body)
    if not found:
        raise match.why_none(speakers, body)
    one = match.decided(found, f"a frame with id {body[0]}", asked)
    return replace(one, remarks=(f"framing with id {body[0]} removed", *one.remarks))


def _unframed(icd: Icd, speakers: Sequence[Speaker], pasted: Pasted, asked: Asked) -> list[Reading]:
    """Packets of CAN by their identifiers; of a message that is asked for, whatever the identifier, if none has it."""
    if not pasted.packets:
        return [_bare(icd, speakers, pasted.data, asked)]
    try:
        return bus.by_identifier(speakers, pasted.packets, asked)
    except NotFound as error:
        if not asked.messages:
            raise
        return [_bare(icd, speakers, pasted.whole, asked).noted(str(error))]


def _bare(icd: Icd, speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Reading:
    if not data and not asked.messages:
        raise BadLength("there are no bytes", 1, 0, "give a frame")
    fault = envelopes.begun(speakers, data)
    if asked.messages:
        one = of_asked(icd, speakers[0], asked.messages, data)
        return one.noted(f"the data begin like a packet: {fault.text}") if fault else one
    if fault:
        raise fault.error
    _refuse_pieces(speakers, data)
    # Where packets are not recognized by their first bytes, any bytes may be a piece of one.
    plainly = [
        speaker
        for speaker in speakers
        if speaker.link.stream is None or (asked.kind and faults.has_sync(speaker.link.stream))
    ]
    if not plainly:
        raise _no_packet(speakers, data, asked)
    return _guessed(plainly, data, asked)


def _no_packet(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Ambiguous | NotFound:
    """Bytes without the framing that their node has: what they can be shows only if the message is named."""
    nodes, syncs = match.nodes_of(speakers), dict.fromkeys(map(envelopes.sync_of, speakers))
    begin = f", which begin with {' or '.join(filter(None, syncs))}" if any(syncs) else ""
    text = f"{byte_count(len(data))} are no packet of {nodes}{begin}"
    candidates = asked.of([*match.by_id(speakers, data), *match.by_length(speakers, data)])
    if candidates:
        return Ambiguous(f"{text}; as data alone they can be {match.named(candidates)}", match.HELP)
    return NotFound(text, f"check that the capture is complete; {match.HELP} reads the data of a message alone")


def _guessed(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> Reading:
    """A message without framing, by its id or its length. Raises `Ambiguous`, `BadLength` or `NotFound`."""
    given = byte_count(len(data))
    with_id, plain = match.by_id(speakers, data), match.by_length(speakers, data)
    if any(map(asked.fits, plain)) and not any(map(asked.fits, with_id)):
        with_id = []
    if with_id:
        one = match.decided(with_id, f"{given} beginning with the id {with_id[0].id}", asked)
        others = [other for other in plain if other.key != one.key]
        note = [f"without an id in front it could be {match.named(others)}"] if others else []
        return one.noted(f"id {one.id} removed", *note)
    if plain:
        one = match.decided(plain, f"{given} without an id", asked)
        return replace(one, id=None).noted("found by its length alone")
    raise match.why_none(speakers, data)


def _decoded(icd: Icd, one: Reading) -> Reading:
    if one.what not in KINDS:
        return one
    made = frame(icd, one.speaker.node, one.message, one.data)
    return replace(one, frame=replace(made, remarks=(*one.remarks, *made.remarks)))
