"""What the frames in a text are: framing and checksums come off, node and message are found."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from icdgen_runtime.wire.uart import UartDecoder, UartEvent

from icdgen.describe.numbers import byte_count
from icdgen.icd.model import Icd
from icdgen.recognize import bus, envelopes, match
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
    if pasted.packets and any(one.facts.can for one in speakers):
        found = bus.readings(speakers, pasted.packets, asked)
    else:
        found = _framed(speakers, pasted.whole, asked) or _unframed(icd, speakers, pasted, asked)
    found = asked.of(found)
    if asked.messages and not any(map(asked.is_of, found)):
        text = f"the frame is not {asked.names} but {found[0].title}"
        raise NotFound(text, "leave the message out, or name that one")
    if asked.messages:
        found = [one for one in found if asked.is_of(one)]
    note = (f"read as {pasted.form}",) if pasted.form else ()
    return [_decoded(icd, one.noted(*note)) for one in found]


def _framed(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """The messages in a stream with framing; none if it has none, or its bytes are just those of the message asked for."""
    if asked.can_be(data):
        return _surely_enveloped(speakers, data, asked)
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
        unknown = [f"another frame of the stream is left out: {error}" for error in wrong]
        return [found[0].noted(*unknown, *match.around(decoder.discarded + decoder.pending, errors)), *found[1:]]
    return []


def _surely_enveloped(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """Of messages whose frames differ in length one in its envelope can be as long as another without: a checksum tells."""
    with suppress(Ambiguous, BadLength):
        return [one for one in envelopes.readings(speakers, data, asked) if one.checked and asked.is_of(one)]
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
    if asked.messages:
        return of_asked(icd, speakers[0], asked.messages, data)
    if not data:
        raise BadLength("there are no bytes", 1, 0, "give a frame")
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
