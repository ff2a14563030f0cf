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
    found: list[Reading] = []
    wrong: list[UserError] = []
    for item in items:
        try:
            found.append(read(item))
        except (Ambiguous, BadLength, NotFound) as error:
            wrong.append(error)
    if not found:
        raise wrong[0]
    return found, wrong


def around(lost: int, errors: Iterable[str]) -> list[str]:
    """Return remarks about unused bytes of a stream, and about errors of its decoder."""
    remarks = [f"{byte_count(lost)} around the frame belong to none"] if lost else []
    return remarks + [f"the stream has an error: {error.replace('_', ' ')}" for error in errors]


def by_id(speakers: Sequence[Speaker], body: bytes) -> list[Reading]:
    """Return all candidates for an id and the bytes after it."""
    return _each_once(found for speaker in speakers for found in _of_speaker(speaker, body))


def of_ids(known: Sequence[tuple[Speaker, int]], data: bytes) -> list[Reading]:
    """Return all candidates for data whose ids are not in front of it. Each speaker has its id."""
    return _each_once(found for speaker, id in known for found in _with_id(speaker, id, data))


def by_length(speakers: Sequence[Speaker], data: bytes) -> list[Reading]:
    """Return all candidates for bytes without an id, by length and by a matching checksum."""
    return _each_once(
        found
        for speaker in speakers
        for what, known in _directions(speaker)
        for id in known
        for found in _with_checksum(speaker, what, id, _message(speaker, known, id, data), data)
    )


def _of_speaker(speaker: Speaker, body: bytes) -> Iterator[Reading]:
    """Return the candidates of a node for an id and the bytes after it."""
    apart, facts = speaker.taken_apart(body), speaker.facts
    if apart is None:
        return
    yield from _with_id(speaker, *apart)
    form = facts.acknowledge
    if form and len(body) == form.length and apart[0] not in facts.telemetry:
        told, error = body[form.id_at], body[form.error_at]
        if told in facts.telecommands:
            yield Reading(speaker, ACKNOWLEDGE, facts.telecommands[told], told, error=error)


def _with_id(speaker: Speaker, id: int, data: bytes) -> Iterator[Reading]:
    """Return the candidates of a node for an id and separate data."""
    for what, known in _directions(speaker):
        message = _message(speaker, known, id, data)
        yield from _with_checksum(speaker, what, id, message, data)
        if message and what == TELEMETRY and not data and message.layout.shortest:
            yield Reading(speaker, REQUEST, message, id)


def message_of(icd: Icd, known: Sequence[Message], data: bytes) -> Message | None:
    """Return the message of an id.

    If several messages share the id, the data selects one. Return None if none matches.
    """
    if len(known) < 2:
        return known[0] if known else None
    try:
        return codec.message_of_frame(icd, known, data)
    except codec.LengthError:
        return None


def _directions(speaker: Speaker) -> tuple[tuple[str, dict[int, tuple[Variant, ...]]], ...]:
    return (TELECOMMAND, speaker.ids.telecommand), (TELEMETRY, speaker.ids.telemetry)


def _message(speaker: Speaker, known: Mapping[int, Sequence[Variant]], id: int, data: bytes) -> Message | None:
    return message_of(speaker.icd, [one.message for one in known.get(id, ())], data)


def _with_checksum(speaker: Speaker, what: str, id: int, message: Message | None, data: bytes) -> Iterator[Reading]:
    """Return the message if the data has its length, or is followed by the right checksum."""
    if message is None:
        return
    if len(data) in message.layout.lengths and miscounted(speaker, message, data) is None:
        yield Reading(speaker, what, message, id, data)
        return
    right = checksum(speaker, id, message, data)
    if right is not None and data[message.length :] == right:
        yield Reading(speaker, what, message, id, data[: message.length], checked=True, remarks=("CRC is right",))


def checksum(speaker: Speaker, id: int, message: Message, data: bytes) -> bytes | None:
    """Return the checksum of the data, or None if there is no room for one after it."""
    form = speaker.facts.checksum
    if form is None or message.layout.parts or len(data) != message.length + form.bytes:
        return None
    return i2c_write(speaker.link, id, data[: message.length], crc=True)[-form.bytes :]


def decided(found: Sequence[Reading], of: str, asked: Asked) -> Reading:
    """Return the most likely reading, with a remark about others. Raise `Ambiguous`.

    The message that the user has named has precedence, then a right checksum. An
    acknowledge is less likely than other messages. If the named message has equal
    frames in both directions, the direction remains open.
    """
    found = asked.of(found)
    likely = [one for one in found if one.checked] or [one for one in found if one.what != ACKNOWLEDGE] or list(found)
    if len(likely) > 1 and all(asked.is_of(one) and one.what in KINDS for one in likely):
        first, *others = likely
        if all(other.message is first.message and other.data == first.data for other in others):
            return replace(first, what=first.message.kind)
    if len(likely) > 1:
        wrong = f", not {asked.names}" if asked.messages and not any(map(asked.is_of, likely)) else ""
        raise Ambiguous(f"{of} can be {named(likely)}{wrong}", HELP)
    others = [one for one in found if one.key != likely[0].key]
    return likely[0].noted(f"it can also be {named(others)}") if others else likely[0]


def why_none(speakers: Sequence[Speaker], body: bytes) -> BadLength | NotFound:
    """Return the error for bytes whose id or length matches no message."""
    apart: list[Apart] = [(speaker, both) for speaker in speakers if (both := speaker.taken_apart(body)) is not None]
    if not apart:
        size = min(wire_ids.size(speaker.node.id_bits) for speaker in speakers)
        text = f"an id of {nodes_of(speakers)} has {size} bytes, {len(body)} given"
        return BadLength(text, size, len(body), "bytes are missing")
    ids = " or ".join(dict.fromkeys(f"{id} (0x{id:02X})" for _, (id, _) in apart))
    text = f"no message of {nodes_of(speakers)} has the id {ids}"
    return why_not(apart, NotFound(text, "`icdgen show NODE` lists what there is"))


def nodes_of(speakers: Sequence[Speaker]) -> str:
    """Return the names of the nodes."""
    return ", ".join(dict.fromkeys(speaker.node.name for speaker in speakers))


def why_not(apart: Sequence[Apart], unknown: NotFound) -> BadLength | NotFound:
    """Return the error for the data of these ids, or ``unknown`` if no message has them."""
    known = {
        (what, message.node, message.name): (speaker, message, id, data)
        for speaker, (id, data) in apart
        for what, messages in _directions(speaker)
        for message, *_ in messages.get(id, ())
    }
    if not known:
        return unknown
    for speaker, message, id, data in known.values():
        right = checksum(speaker, id, message, data)
        if right is not None:
            return wrong_checksum(message, right, data)
        wrong = miscounted(speaker, message, data) if len(data) in message.layout.lengths else None
        if wrong is not None:
            return wrong
    told = " or ".join(
        f"`{m.name}` ({describe(m, s.facts.stream)}) has {length_text(m)}" for s, m, _, _ in known.values()
    )
    _, first, id, data = next(iter(known.values()))
    if len(known) > 1 and any(len(data) in message.layout.lengths for _, message, _, data in known.values()):
        return none_of([message for _, message, _, _ in known.values()], f"the {len(data)} bytes after the id {id}")
    text = f"{told}, {len(data)} given after the id {id}"
    return BadLength(text, first.length, len(data), "bytes are missing, or too many")


def none_of(messages: Sequence[Message], data: str) -> NotFound:
    """Return the error for data that matches none of several messages that share an id."""
    told = ", ".join(f"`{message.name}` ({describe(message)}, {length_text(message)})" for message in messages)
    help = "a byte was damaged, or there are too many; name the message to have them read all the same"
    return NotFound(f"{data} are like none of {told}, by length and constants", help)


def miscounted(speaker: Speaker, message: Message, data: bytes) -> BadLength | None:
    """Return the error for data whose counters do not match its length, or None."""
    try:
        codec.decode(speaker.icd.node(message.node), message, data)
    except codec.LengthError as error:
        parts = message.layout.parts
        said = f"`{parts[0].counter}` says" if len(parts) == 1 else "they say"
        text = f"`{message.name}` of {error.actual} bytes: {error.expected} are needed for as many elements as {said}"
        return BadLength(text, error.expected, error.actual, "bytes are missing, or too many, or damaged")
    return None


def wrong_checksum(message: Message, right: bytes, data: bytes) -> BadLength:
    """Return the error for data with a wrong checksum."""
    text = f"`{message.name}` has {message.length} bytes; as CRC after them {right.hex().upper()} would be right, "
    help = "a byte was damaged, or there are too many"
    return BadLength(f"{text}not {data[message.length :].hex().upper()}", message.length, len(data), help)


def _each_once(found: Iterable[Reading]) -> list[Reading]:
    """Return one reading per message and direction, if several nodes have the message.

    A reading with a checksum has precedence, then the node that declares the message.
    """
    alike: dict[tuple[str, str, str], list[Reading]] = {}
    for one in found:
        alike.setdefault(one.key, []).append(one)
    return [max(those, key=lambda one: (one.checked, one.is_own)) for those in alike.values()]


def named(found: Sequence[Reading]) -> str:
    """Return the titles of the first readings, for a report. Each title is given once."""
    every = list(dict.fromkeys(one.title for one in found))
    titles, rest = every[:MOST_LISTED], len(every) - MOST_LISTED
    return ", or ".join(titles) + (f", or one of {rest} others" if rest > 0 else "")
