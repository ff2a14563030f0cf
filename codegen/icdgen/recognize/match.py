"""Candidate messages of an id and bytes, and the error without a candidate.

Other modules call `by_id`, `of_ids` or `by_length` for all candidates, and
`most_likely` to choose one of them or to raise `Ambiguous`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from icdgen_runtime.wire.i2c import i2c_write

from icdgen import codec
from icdgen.describe.numbers import byte_count, length_text
from icdgen.errors import UserError
from icdgen.icd import wire_ids
from icdgen.icd.buses import UART
from icdgen.icd.model import Icd, Message
from icdgen.icd.variants import Variant
from icdgen.recognize.reading import (
    ACKNOWLEDGE,
    REQUEST,
    TELECOMMAND,
    TELEMETRY,
    Endpoint,
    FrameReading,
)
from icdgen.recognize.selection import Selection
from icdgen.runtime_objects.links import responses_on
from icdgen.values.errors import Ambiguous, BadLength, NotFound
from icdgen.values.find import KINDS, kind_and_ids

T = TypeVar("T")
SplitId = tuple[Endpoint, tuple[int, bytes]]  # an id, and the bytes after it
MOST_LISTED = 8
HELP = "name the node and the message: `icdgen decode NODE MESSAGE FRAME`"


def read_each(
    items: Iterable[T], read: Callable[[T], FrameReading]
) -> tuple[list[FrameReading], list[UserError]]:
    """Return the readings of all items, and the errors of the others.

    Raise the first error if there are no readings.
    """
    readings: list[FrameReading] = []
    errors: list[UserError] = []
    for item in items:
        try:
            readings.append(read(item))
        except (Ambiguous, BadLength, NotFound) as error:
            errors.append(error)
    if not readings:
        raise errors[0]
    return readings, errors


def stream_remarks(lost: int, errors: Iterable[str]) -> list[str]:
    """Return remarks about unused bytes of a stream, and about errors of its decoder."""
    remarks = [f"{byte_count(lost)} around the frame belong to none"] if lost else []
    return remarks + [
        f"the stream has an error: {error.replace('_', ' ')}" for error in errors
    ]


def by_id(endpoints: Sequence[Endpoint], body: bytes) -> list[FrameReading]:
    """Return all candidates for an id and the bytes after it."""
    return _unique(
        reading for endpoint in endpoints for reading in _of_endpoint(endpoint, body)
    )


def of_ids(ids: Sequence[tuple[Endpoint, int]], data: bytes) -> list[FrameReading]:
    """Return all candidates for data whose ids are not in front of it.

    Each endpoint has its id.
    """
    return _unique(
        reading for endpoint, id in ids for reading in _with_id(endpoint, id, data)
    )


def by_length(endpoints: Sequence[Endpoint], data: bytes) -> list[FrameReading]:
    """Return all candidates for bytes without an id, by length and by a matching
    checksum.
    """
    readings: list[FrameReading] = []
    for endpoint in endpoints:
        for what, variants in _directions(endpoint):
            for id in variants:
                message = _message(endpoint, variants, id, data)
                readings += _with_checksum(endpoint, what, id, message, data)
    return _unique(readings)


def _of_endpoint(endpoint: Endpoint, body: bytes) -> Iterator[FrameReading]:
    """Return the candidates of a node for an id and the bytes after it."""
    parts, facts = endpoint.split_id(body), endpoint.facts
    if parts is None:
        return
    yield from _with_id(endpoint, *parts)
    packet = facts.acknowledge
    # The bytes of an acknowledge have no mark of their own, so an id of telemetry has
    # precedence.
    if packet and len(body) == packet.overhead and parts[0] not in facts.telemetry:
        for response in responses_on(endpoint.link, UART):
            id = response.echoes[0].place.of(body)
            if response.reason and id in facts.telecommands:
                message, code = facts.telecommands[id], response.reason.of(body)
                yield FrameReading(endpoint, ACKNOWLEDGE, message, id, error=code)


def _with_id(endpoint: Endpoint, id: int, data: bytes) -> Iterator[FrameReading]:
    """Return the candidates of a node for an id and separate data."""
    for what, variants in _directions(endpoint):
        message = _message(endpoint, variants, id, data)
        yield from _with_checksum(endpoint, what, id, message, data)
        # A request of telemetry is its id alone. A message that can be empty would look
        # the same.
        if message and what == TELEMETRY and not data and message.layout.shortest:
            yield FrameReading(endpoint, REQUEST, message, id)


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


def _directions(
    endpoint: Endpoint,
) -> tuple[tuple[str, dict[int, tuple[Variant, ...]]], ...]:
    return (TELECOMMAND, endpoint.ids.telecommand), (TELEMETRY, endpoint.ids.telemetry)


def _message(
    endpoint: Endpoint, variants: Mapping[int, Sequence[Variant]], id: int, data: bytes
) -> Message | None:
    return message_of(
        endpoint.icd, [variant.message for variant in variants.get(id, ())], data
    )


def _with_checksum(
    endpoint: Endpoint, what: str, id: int, message: Message | None, data: bytes
) -> Iterator[FrameReading]:
    """Return the message if the data has its length, or is followed by the right
    checksum.
    """
    if message is None:
        return
    if (
        len(data) in message.layout.lengths
        and counter_error(endpoint, message, data) is None
    ):
        yield FrameReading(endpoint, what, message, id, data)
        return
    expected = checksum(endpoint, id, message, data)
    if expected is not None and data[message.length :] == expected:
        yield FrameReading(
            endpoint,
            what,
            message,
            id,
            data[: message.length],
            checked=True,
            remarks=("CRC is right",),
        )


def checksum(
    endpoint: Endpoint, id: int, message: Message, data: bytes
) -> bytes | None:
    """Return the checksum of the data, or None if there is no room for one after it."""
    form = endpoint.facts.checksum
    if form is None or message.layout.parts or len(data) != message.length + form.bytes:
        return None
    # The checksum covers the id, which is not in the data. The runtime computes it for
    # a write on I2C.
    return i2c_write(endpoint.link, id, data[: message.length], crc=True)[-form.bytes :]


def most_likely(
    candidates: Sequence[FrameReading], of: str, selection: Selection
) -> FrameReading:
    """Return the most likely reading, with a remark about others. Raise `Ambiguous`.

    The message that the user has named has precedence, then a right checksum. An
    acknowledge is less likely than other messages. If the named message has equal
    frames in both directions, the direction remains open.
    """
    candidates = selection.matching_or_all(candidates)
    # An acknowledge is short and has few fixed bits, so other data often looks like
    # one.
    likely = (
        [reading for reading in candidates if reading.checked]
        or [reading for reading in candidates if reading.what != ACKNOWLEDGE]
        or list(candidates)
    )
    if len(likely) > 1 and all(
        selection.is_of(reading) and reading.what in KINDS for reading in likely
    ):
        first, *alternatives = likely
        if all(
            alternative.message is first.message and alternative.data == first.data
            for alternative in alternatives
        ):
            # The kind of a configuration message leaves the direction open.
            return replace(first, what=first.message.kind)
    if len(likely) > 1:
        text = f"{of} can be {titles_text(likely)}"
        if selection.messages and not any(map(selection.is_of, likely)):
            text += f", not {selection.names}"
        raise Ambiguous(text, HELP)
    alternatives = [reading for reading in candidates if reading.key != likely[0].key]
    if alternatives:
        remark = f"it can also be {titles_text(alternatives)}"
        return likely[0].with_remarks(remark)
    return likely[0]


def no_match_error(endpoints: Sequence[Endpoint], body: bytes) -> BadLength | NotFound:
    """Return the error for bytes whose id or length matches no message."""
    parts: list[SplitId] = [
        (endpoint, part)
        for endpoint in endpoints
        if (part := endpoint.split_id(body)) is not None
    ]
    if not parts:
        size = min(wire_ids.size(endpoint.node.id_bits) for endpoint in endpoints)
        text = f"an id of {nodes_of(endpoints)} has {size} bytes, {len(body)} given"
        return BadLength(text, size, len(body), "bytes are missing")
    ids = " or ".join(dict.fromkeys(f"{id} (0x{id:02X})" for _, (id, _) in parts))
    text = f"no message of {nodes_of(endpoints)} has the id {ids}"
    return data_error(parts, NotFound(text, "`icdgen show NODE` lists what there is"))


def nodes_of(endpoints: Sequence[Endpoint]) -> str:
    """Return the names of the nodes."""
    return ", ".join(dict.fromkeys(endpoint.node.name for endpoint in endpoints))


def data_error(parts: Sequence[SplitId], unknown: NotFound) -> BadLength | NotFound:
    """Return the error for the data of these ids, or ``unknown`` if no message has
    them.
    """
    # By direction, node and name, so that a message of several nodes counts once
    candidates: dict[tuple[str, str, str], tuple[Endpoint, Message, int, bytes]] = {}
    for endpoint, (id, data) in parts:
        for what, messages in _directions(endpoint):
            for message, *_ in messages.get(id, ()):
                key = what, message.node, message.name
                candidates[key] = endpoint, message, id, data
    if not candidates:
        return unknown
    for endpoint, message, id, data in candidates.values():
        expected = checksum(endpoint, id, message, data)
        if expected is not None:
            return checksum_error(message, expected, data)
        if len(data) in message.layout.lengths:
            error = counter_error(endpoint, message, data)
            if error is not None:
                return error
    listed = " or ".join(
        f"`{m.name}` ({kind_and_ids(m, s.facts.stream)}) has {length_text(m)}"
        for s, m, _, _ in candidates.values()
    )
    _, first, id, data = next(iter(candidates.values()))
    if len(candidates) > 1 and any(
        len(data) in message.layout.lengths
        for _, message, _, data in candidates.values()
    ):
        return no_shared_message_error(
            [message for _, message, _, _ in candidates.values()],
            f"the {len(data)} bytes after the id {id}",
        )
    text = f"{listed}, {len(data)} given after the id {id}"
    return BadLength(text, first.length, len(data), "bytes are missing, or too many")


def no_shared_message_error(messages: Sequence[Message], data: str) -> NotFound:
    """Return the error for data that matches none of several messages that share an id."""
    listed = ", ".join(
        f"`{message.name}` ({kind_and_ids(message)}, {length_text(message)})"
        for message in messages
    )
    help = "a byte was damaged, or there are too many; name the message to have them read all the same"
    return NotFound(f"{data} are like none of {listed}, by length and constants", help)


def counter_error(
    endpoint: Endpoint, message: Message, data: bytes
) -> BadLength | None:
    """Return the error for data whose counters do not match its length, or None."""
    try:
        codec.decode(endpoint.icd.node(message.node), message, data)
    except codec.LengthError as error:
        parts = list(message.layout.counted_parts)
        source = f"`{parts[0].counter}` says" if len(parts) == 1 else "they say"
        text = f"`{message.name}` of {error.actual} bytes: {error.expected} are needed for as many elements as {source}"
        return BadLength(
            text,
            error.expected,
            error.actual,
            "bytes are missing, or too many, or damaged",
        )
    return None


def checksum_error(message: Message, expected: bytes, data: bytes) -> BadLength:
    """Return the error for data with a wrong checksum."""
    text = f"`{message.name}` has {message.length} bytes; as CRC after them {expected.hex().upper()} would be right, "
    help = "a byte was damaged, or there are too many"
    return BadLength(
        f"{text}not {data[message.length :].hex().upper()}",
        message.length,
        len(data),
        help,
    )


def _unique(readings: Iterable[FrameReading]) -> list[FrameReading]:
    """Return one reading per message and direction, if several nodes have the message.

    A reading with a checksum has precedence, then the node that declares the message.
    """
    by_key: dict[tuple[str, str, str], list[FrameReading]] = {}
    for reading in readings:
        by_key.setdefault(reading.key, []).append(reading)
    return [
        max(group, key=lambda reading: (reading.checked, reading.is_own))
        for group in by_key.values()
    ]


def titles_text(readings: Sequence[FrameReading]) -> str:
    """Return the titles of the first readings, for a report.

    Each title is given once.
    """
    titles = list(dict.fromkeys(reading.title for reading in readings))
    text = ", or ".join(titles[:MOST_LISTED])
    remaining = len(titles) - MOST_LISTED
    return f"{text}, or one of {remaining} others" if remaining > 0 else text
