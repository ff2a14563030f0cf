"""What the frames in a text are: framing and checksums come off, node and message are found."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from icdgen_runtime.wire.uart import UartDecoder, UartEvent

from icdgen.errors import UserError
from icdgen.icd.model import Icd, Message, Node
from icdgen.recognize import bus, envelopes, match
from icdgen.recognize.given import of_message
from icdgen.recognize.pasted import Pasted, read
from icdgen.recognize.reading import Reading, Speaker, all_speakers, speaker_of
from icdgen.values.errors import Ambiguous, BadHex, BadLength, NotFound
from icdgen.values.find import KINDS, find_message, find_node, find_sharing
from icdgen.values.frame import frame


def recognize(
    icd: Icd, text: str | bytes, node: str | None = None, key: str | None = None, kind: str | None = None
) -> list[Reading]:
    """What the frames in a text are, or in bytes as they came over a line.

    ``node`` and ``key`` say whose they are and which message, as `icdgen.values.find_message` takes them. Lines of which
    each is a frame of its own are read one by one. Raises `BadHex`, `BadLength`, `NotFound` or `Ambiguous`.
    """
    asked = find_node(icd, node) if node is not None else None
    message = _named(icd, asked, key, kind, text) if asked and key is not None else None
    if isinstance(text, bytes):
        return _readings(icd, Pasted(text), asked, message, kind)
    lines = [line for line in text.splitlines() if line.strip()]
    apart = _line_by_line(icd, lines, asked, message, kind)
    if apart and message is None and all(one.id is not None for one in apart):
        return apart
    try:
        return _readings(icd, read(text), asked, message, kind)
    except (Ambiguous, BadHex, BadLength, NotFound):
        if apart:
            return apart
        raise


def _named(icd: Icd, node: Node, key: str, kind: str | None, text: str | bytes) -> Message:
    """The message that is asked for; of those that share an id the one that the frame is, which may have the id in front."""
    try:
        return find_message(icd, node.name, key, kind)
    except Ambiguous:
        known = find_sharing(icd, node.name, key, kind)
        data = b"" if not known else text if isinstance(text, bytes) else read(text).data
        both = speaker_of(icd, node).taken_apart(data) if known else None
        found = match.message_of(icd, known, data) if known else None
        if found is None and both is not None and both[0] in known[0].ids:
            found = match.message_of(icd, known, both[1])
        if found is None and known:
            raise match.none_of(known, f"{len(data)} byte{'' if len(data) == 1 else 's'}") from None
        if found is None:
            raise
        return found


def _line_by_line(
    icd: Icd, lines: Sequence[str], asked: Node | None, message: Message | None, kind: str | None
) -> list[Reading]:
    """The frames, if there are several lines and each is one."""
    if len(lines) < 2:
        return []
    with suppress(Ambiguous, BadHex, BadLength, NotFound):
        pasted = [read(line) for line in lines]
        if not any(one.packets or one.form for one in pasted):
            return [found for one in pasted for found in _readings(icd, one, asked, message, kind)]
    return []


def _readings(icd: Icd, pasted: Pasted, asked: Node | None, message: Message | None, kind: str | None) -> list[Reading]:
    speakers = [speaker_of(icd, asked)] if asked else all_speakers(icd)
    if pasted.packets and any(one.facts.can for one in speakers):
        found = bus.readings(speakers, pasted.packets)
    else:
        data = b"".join(packet.data for packet in pasted.packets) or pasted.data
        found = _framed(speakers, data, message) or [_bare(icd, speakers, data, message)]
    if kind is not None:
        found = [one for one in found if one.what == kind or one.message.kind == kind] or found
    if message is not None:
        others = [one for one in found if one.message is not message]
        if others and len(others) == len(found):
            raise NotFound(
                f"the frame is not `{message.name}` but {others[0].title}", "leave the message out, or name that one"
            )
        found = [one for one in found if one.message is message]
    note = (f"read as {pasted.form}",) if pasted.form else ()
    return [_decoded(icd, one.noted(*note)) for one in found]


def _framed(speakers: Sequence[Speaker], data: bytes, message: Message | None) -> list[Reading]:
    """The messages in a stream with framing; none if it has none, or its bytes are just those of the message asked for."""
    if message is not None and len(data) in message.lengths:
        return []
    if enveloped := envelopes.readings(speakers, data):
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
        found, unknown = _of_bodies(talking, bodies)
        lost = decoder.discarded + decoder.pending
        around = [f"{lost} byte{'' if lost == 1 else 's'} around the frame belong to none"] if lost else []
        around += [f"the stream has an error: {e.event.replace('_', ' ')}" for e in events if e.event != "message"]
        return [found[0].noted(*unknown, *around), *found[1:]]
    return []


def _of_bodies(speakers: Sequence[Speaker], bodies: Sequence[bytes]) -> tuple[list[Reading], list[str]]:
    """What the messages are, and what is wrong with the others. Raises the first error if it is wrong with all."""
    found: list[Reading] = []
    wrong: list[UserError] = []
    for body in bodies:
        try:
            found.append(_of_body(speakers, body))
        except (Ambiguous, BadLength, NotFound) as error:
            wrong.append(error)
    if not found:
        raise wrong[0]
    return found, [f"another frame of the stream is left out: {error}" for error in wrong]


def _broken(events: list[UartEvent]) -> str:
    if any(event.event == "protocol_error" for event in events):
        return "the framing is broken: the escape byte is followed by neither itself nor an end of message"
    return "the framing is empty" if events else "the framing begins, but the end of the message is missing"


def _of_body(speakers: Sequence[Speaker], body: bytes) -> Reading:
    found = match.by_id(speakers, body)
    if not found:
        raise match.why_none(speakers, body)
    one = match.decided(found, f"a frame with id {body[0]}")
    return replace(one, remarks=(f"framing with id {body[0]} removed", *one.remarks))


def _bare(icd: Icd, speakers: Sequence[Speaker], data: bytes, message: Message | None) -> Reading:
    if message is not None:
        return of_message(icd, speakers[0], message, data)
    if not data:
        raise BadLength("there are no bytes", 1, 0, "give a frame")
    given = f"{len(data)} byte{'' if len(data) == 1 else 's'}"
    with_id, plain = match.by_id(speakers, data), match.by_length(speakers, data)
    if with_id:
        one = match.decided(with_id, f"{given} beginning with the id {with_id[0].id}")
        others = [other for other in plain if other.key != one.key]
        note = [f"without an id in front it could be {match.named(others)}"] if others else []
        return one.noted(f"id {one.id} removed", *note)
    if plain:
        one = match.decided(plain, f"{given} without an id")
        return replace(one, id=None).noted("found by its length alone")
    raise match.why_none(speakers, data)


def _decoded(icd: Icd, one: Reading) -> Reading:
    if one.what not in KINDS:
        return one
    made = frame(icd, one.speaker.node, one.message, one.data)
    return replace(one, frame=replace(made, remarks=(*one.remarks, *made.remarks)))
