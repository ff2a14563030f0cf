"""Candidate messages of an id and bytes, and the error if there are none."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from icdgen_runtime.wire.i2c import i2c_write

from icdgen import codec
from icdgen.describe.numbers import byte_count, length_text
from icdgen.errors import UserError
from icdgen.icd import wire_ids
from icdgen.icd.model import Icd, Message
from icdgen.icd.variants import Variant
from icdgen.recognize.asked import Asked
from icdgen.recognize.reading import ACKNOWLEDGE, REQUEST, TELECOMMAND, TELEMETRY, Reading, Speaker
from icdgen.values.errors import Ambiguous, BadLength, NotFound
from icdgen.values.find import KINDS, describe

T = TypeVar("T")
Apart = tuple[Speaker, tuple[int, bytes]]  # an id, and the bytes after it
MOST_LISTED = 8
HELP = "name the node and the message: `icdgen decode NODE MESSAGE FRAME`"


def each(items: Iterable[T], read: Callable[[T], Reading]) -> tuple[list[Reading], list[UserError]]:
    """Return the readings of all items, and the errors of the others.

    Raise the first error if there are no readings.
    """
    readings: list[Reading] = []
    errors: list[UserError] = []
    for item in items:
        try:
            readings.append(read(item))
        except (Ambiguous, BadLength, NotFound) as error:
            errors.append(error)
    if not readings:
        raise errors[0]
    return readings, errors


def around(lost: int, errors: Iterable[str]) -> list[str]:
    """Return remarks about unused bytes of a stream, and about errors of its decoder."""
    remarks = [f"{byte_count(lost)} around the frame belong to none"] if lost else []
    return remarks + [f"the stream has an error: {error.replace('_', ' ')}" for error in errors]


def by_id(speakers: Sequence[Speaker], body: bytes) -> list[Reading]:
    """Return all candidates for an id and the bytes after it."""
    return _each_once(reading for speaker in speakers for reading in _of_speaker(speaker, body))


def of_ids(ids: Sequence[tuple[Speaker, int]], data: bytes) -> list[Reading]:
    """Return all candidates for data whose ids are not in front of it. Each speaker has its id."""
    return _each_once(reading for speaker, id in ids for reading in _with_id(speaker, id, data))


def by_length(speakers: Sequence[Speaker], data: bytes) -> list[Reading]:
    """Return all candidates for bytes without an id, by length and by a matching checksum."""
    return _each_once(
        reading
        for speaker in speakers
        for what, variants in _directions(speaker)
        for id in variants
        for reading in _with_checksum(speaker, what, id, _message(speaker, variants, id, data), data)
    )


def _of_speaker(speaker: Speaker, body: bytes) -> Iterator[Reading]:
    """Return the candidates of a node for an id and the bytes after it."""
    parts, facts = speaker.taken_apart(body), speaker.facts
    if parts is None:
        return
    yield from _with_id(speaker, *parts)
    form = facts.acknowledge
    if form and len(body) == form.length and parts[0] not in facts.telemetry:
        acknowledged, error = body[form.id_at], body[form.error_at]
        if acknowledged in facts.telecommands:
            yield Reading(speaker, ACKNOWLEDGE, facts.telecommands[acknowledged], acknowledged, error=error)


def _with_id(speaker: Speaker, id: int, data: bytes) -> Iterator[Reading]:
    """Return the candidates of a node for an id and separate data."""
    for what, variants in _directions(speaker):
        message = _message(speaker, variants, id, data)
        yield from _with_checksum(speaker, what, id, message, data)
        if message and what == TELEMETRY and not data and message.layout.shortest:
            yield Reading(speaker, REQUEST, message, id)


def message_of(icd: Icd, messages: Sequence[Message], data: bytes) -> Message | None:
    """Return the message of an id.

    If several messages share the id, the data selects one. Return None if none matches.
    """
    if len(messages) < 2:
        return messages[0] if messages else None
    try:
        return codec.message_of_frame(icd, messages, data)
    except codec.LengthError:
        return None


def _directions(speaker: Speaker) -> tuple[tuple[str, dict[int, tuple[Variant, ...]]], ...]:
    return (TELECOMMAND, speaker.ids.telecommand), (TELEMETRY, speaker.ids.telemetry)


def _message(speaker: Speaker, variants: Mapping[int, Sequence[Variant]], id: int, data: bytes) -> Message | None:
    return message_of(speaker.icd, [variant.message for variant in variants.get(id, ())], data)


def _with_checksum(speaker: Speaker, what: str, id: int, message: Message | None, data: bytes) -> Iterator[Reading]:
    """Return the message if the data has its length, or is followed by the right checksum."""
    if message is None:
        return
    if len(data) in message.layout.lengths and miscounted(speaker, message, data) is None:
        yield Reading(speaker, what, message, id, data)
        return
    expected = checksum(speaker, id, message, data)
    if expected is not None and data[message.length :] == expected:
        yield Reading(speaker, what, message, id, data[: message.length], checked=True, remarks=("CRC is right",))


def checksum(speaker: Speaker, id: int, message: Message, data: bytes) -> bytes | None:
    """Return the checksum of the data, or None if there is no room for one after it."""
    form = speaker.facts.checksum
    if form is None or message.layout.parts or len(data) != message.length + form.bytes:
        return None
    return i2c_write(speaker.link, id, data[: message.length], crc=True)[-form.bytes :]


def decided(candidates: Sequence[Reading], of: str, asked: Asked) -> Reading:
    """Return the most likely reading, with a remark about others. Raise `Ambiguous`.

    The message that the user has named has precedence, then a right checksum. An
    acknowledge is less likely than other messages. If the named message has equal
    frames in both directions, the direction remains open.
    """
    candidates = asked.of(candidates)
    likely = (
        [reading for reading in candidates if reading.checked]
        or [reading for reading in candidates if reading.what != ACKNOWLEDGE]
        or list(candidates)
    )
    if len(likely) > 1 and all(asked.is_of(reading) and reading.what in KINDS for reading in likely):
        first, *alternatives = likely
        if all(alternative.message is first.message and alternative.data == first.data for alternative in alternatives):
            return replace(first, what=first.message.kind)
    if len(likely) > 1:
        contrast = f", not {asked.names}" if asked.messages and not any(map(asked.is_of, likely)) else ""
        raise Ambiguous(f"{of} can be {named(likely)}{contrast}", HELP)
    alternatives = [reading for reading in candidates if reading.key != likely[0].key]
    return likely[0].noted(f"it can also be {named(alternatives)}") if alternatives else likely[0]


def why_none(speakers: Sequence[Speaker], body: bytes) -> BadLength | NotFound:
    """Return the error for bytes whose id or length matches no message."""
    parts: list[Apart] = [(speaker, part) for speaker in speakers if (part := speaker.taken_apart(body)) is not None]
    if not parts:
        size = min(wire_ids.size(speaker.node.id_bits) for speaker in speakers)
        text = f"an id of {nodes_of(speakers)} has {size} bytes, {len(body)} given"
        return BadLength(text, size, len(body), "bytes are missing")
    ids = " or ".join(dict.fromkeys(f"{id} (0x{id:02X})" for _, (id, _) in parts))
    text = f"no message of {nodes_of(speakers)} has the id {ids}"
    return why_not(parts, NotFound(text, "`icdgen show NODE` lists what there is"))


def nodes_of(speakers: Sequence[Speaker]) -> str:
    """Return the names of the nodes."""
    return ", ".join(dict.fromkeys(speaker.node.name for speaker in speakers))


def why_not(parts: Sequence[Apart], unknown: NotFound) -> BadLength | NotFound:
    """Return the error for the data of these ids, or ``unknown`` if no message has them."""
    candidates = {
        (what, message.node, message.name): (speaker, message, id, data)
        for speaker, (id, data) in parts
        for what, messages in _directions(speaker)
        for message, *_ in messages.get(id, ())
    }
    if not candidates:
        return unknown
    for speaker, message, id, data in candidates.values():
        expected = checksum(speaker, id, message, data)
        if expected is not None:
            return wrong_checksum(message, expected, data)
        error = miscounted(speaker, message, data) if len(data) in message.layout.lengths else None
        if error is not None:
            return error
    listed = " or ".join(
        f"`{m.name}` ({describe(m, s.facts.stream)}) has {length_text(m)}" for s, m, _, _ in candidates.values()
    )
    _, first, id, data = next(iter(candidates.values()))
    if len(candidates) > 1 and any(len(data) in message.layout.lengths for _, message, _, data in candidates.values()):
        return none_of(
            [message for _, message, _, _ in candidates.values()], f"the {len(data)} bytes after the id {id}"
        )
    text = f"{listed}, {len(data)} given after the id {id}"
    return BadLength(text, first.length, len(data), "bytes are missing, or too many")


def none_of(messages: Sequence[Message], data: str) -> NotFound:
    """Return the error for data that matches none of several messages that share an id."""
    listed = ", ".join(f"`{message.name}` ({describe(message)}, {length_text(message)})" for message in messages)
    help = "a byte was damaged, or there are too many; name the message to have them read all the same"
    return NotFound(f"{data} are like none of {listed}, by length and constants", help)


def miscounted(speaker: Speaker, message: Message, data: bytes) -> BadLength | None:
    """Return the error for data whose counters do not match its length, or None."""
    try:
        codec.decode(speaker.icd.node(message.node), message, data)
    except codec.LengthError as error:
        parts = message.layout.parts
        source = f"`{parts[0].counter}` says" if len(parts) == 1 else "they say"
        text = f"`{message.name}` of {error.actual} bytes: {error.expected} are needed for as many elements as {source}"
        return BadLength(text, error.expected, error.actual, "bytes are missing, or too many, or damaged")
    return None


def wrong_checksum(message: Message, expected: bytes, data: bytes) -> BadLength:
    """Return the error for data with a wrong checksum."""
    text = f"`{message.name}` has {message.length} bytes; as CRC after them {expected.hex().upper()} would be right, "
    help = "a byte was damaged, or there are too many"
    return BadLength(f"{text}not {data[message.length :].hex().upper()}", message.length, len(data), help)


def _each_once(readings: Iterable[Reading]) -> list[Reading]:
    """Return one reading per message and direction, if several nodes have the message.

    A reading with a checksum has precedence, then the node that declares the message.
    """
    by_key: dict[tuple[str, str, str], list[Reading]] = {}
    for reading in readings:
        by_key.setdefault(reading.key, []).append(reading)
    return [max(group, key=lambda reading: (reading.checked, reading.is_own)) for group in by_key.values()]


def named(readings: Sequence[Reading]) -> str:
    """Return the titles of the first readings, for a report. Each title is given once."""
    all_titles = list(dict.fromkeys(reading.title for reading in readings))
    titles, remaining = all_titles[:MOST_LISTED], len(all_titles) - MOST_LISTED
    return ", or ".join(titles) + (f", or one of {remaining} others" if remaining > 0 else "")
