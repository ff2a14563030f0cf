"""Bytes without framing of a message that the user has named.

The user names the message, so only an id in front and a checksum behind the data remain
to be recognized.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from icdgen.describe.numbers import byte_count, length_text
from icdgen.icd.model import Icd, Message
from icdgen.recognize import match
from icdgen.recognize.reading import (
    TELECOMMAND,
    TELEMETRY,
    Endpoint,
    FrameReading,
    all_endpoints,
)
from icdgen.values.errors import BadLength


def selected_message(
    icd: Icd, endpoint: Endpoint, messages: Sequence[Message], data: bytes
) -> FrameReading:
    """Return the message of the data, which may begin with the id.

    If several messages share the id, length and constants of the data distinguish them.
    Raise `BadLength` or `NotFound`.
    """
    if len(messages) == 1:
        return of_message(icd, endpoint, messages[0], data)
    parts = endpoint.split_id(data)
    message = match.message_of(icd, messages, data)
    if message is None and parts is not None and parts[0] in messages[0].ids:
        message = match.message_of(icd, messages, parts[1])
    if message is None:
        raise match.no_shared_message_error(messages, byte_count(len(data)))
    return of_message(icd, endpoint, message, data)


def of_message(
    icd: Icd, endpoint: Endpoint, message: Message, data: bytes
) -> FrameReading:
    """Return the message, without its id and checksum if present. Raise `BadLength`."""
    own_id = message.telecommand_id
    if own_id is None:
        own_id = message.telemetry_id
    assert own_id is not None
    # The user has named the message, so bytes of its length are its data, even if the
    # first one equals the id.
    if len(data) in message.layout.lengths:
        error = match.counter_error(endpoint, message, data)
        if error is not None:
            raise error
        return _reading(endpoint, message, None, data)
    parts = endpoint.split_id(data)
    # First as data without an id, then with the id in front.
    splits: list[tuple[int | None, bytes]] = [(None, data)]
    if parts and parts[0] in message.ids:
        splits.append(parts)
    for id, remaining in splits:
        notes = () if id is None else (f"id {id} removed",)
        for sender in _nodes_with_message(icd, endpoint, message):
            checked_id = own_id if id is None else id
            expected = match.checksum(sender, checked_id, message, remaining)
            if expected is not None and remaining[message.length :] == expected:
                return _reading(
                    endpoint,
                    message,
                    id,
                    remaining[: message.length],
                    *notes,
                    "CRC is right",
                )
        if (
            id is not None
            and len(remaining) in message.layout.lengths
            and match.counter_error(endpoint, message, remaining) is None
        ):
            return _reading(endpoint, message, id, remaining, *notes)
    expected = match.checksum(endpoint, own_id, message, data)
    if expected is not None:
        raise match.checksum_error(message, expected, data)
    help = f"`icdgen show {endpoint.node.name} {shlex.quote(message.name)}` shows what it holds"
    text = f"{message.name} has {length_text(message)}, {len(data)} given"
    raise BadLength(text, message.length, len(data), help)


def _reading(
    endpoint: Endpoint, message: Message, id: int | None, data: bytes, *remarks: str
) -> FrameReading:
    if id is None:
        what = message.kind
    else:
        what = TELECOMMAND if id == message.telecommand_id else TELEMETRY
    return FrameReading(endpoint, what, message, id, data, remarks=remarks)


def _nodes_with_message(
    icd: Icd, endpoint: Endpoint, message: Message
) -> list[Endpoint]:
    """Return the node and all nodes that include the message, which may add a checksum."""
    endpoints = [endpoint]
    for candidate in all_endpoints(icd):
        is_other_node = candidate.node is not endpoint.node
        if is_other_node and message in icd.messages_of(candidate.node):
            endpoints.append(candidate)
    return endpoints
