"""Bytes without framing of a message that the user has named."""

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
    Reading,
    all_endpoints,
)
from icdgen.values.errors import BadLength


def selected_message(
    icd: Icd, endpoint: Endpoint, messages: Sequence[Message], data: bytes
) -> Reading:
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


def of_message(icd: Icd, endpoint: Endpoint, message: Message, data: bytes) -> Reading:
    """Return the message, without its id and checksum if present. Raise `BadLength`."""
    plain = (
        message.telecommand_id
        if message.telecommand_id is not None
        else message.telemetry_id
    )
    assert plain is not None
    # The user has named the message, so bytes of its length are its data, even if the
    # first one equals the id.
    if len(data) in message.layout.lengths:
        error = match.counter_error(endpoint, message, data)
        if error is not None:
            raise error
        return _reading(endpoint, message, None, data)
    parts = endpoint.split_id(data)
    # First as data without an id, then with the id in front.
    for id, remaining in [
        (None, data),
        *([parts] if parts and parts[0] in message.ids else []),
    ]:
        notes = () if id is None else (f"id {id} removed",)
        for sender in _nodes_with_message(icd, endpoint, message):
            expected = match.checksum(
                sender, plain if id is None else id, message, remaining
            )
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
    expected = match.checksum(endpoint, plain, message, data)
    if expected is not None:
        raise match.checksum_error(message, expected, data)
    help = f"`icdgen show {endpoint.node.name} {shlex.quote(message.name)}` shows what it holds"
    text = f"{message.name} has {length_text(message)}, {len(data)} given"
    raise BadLength(text, message.length, len(data), help)


def _reading(
    endpoint: Endpoint, message: Message, id: int | None, data: bytes, *remarks: str
) -> Reading:
    what = (
        message.kind
        if id is None
        else TELECOMMAND
        if id == message.telecommand_id
        else TELEMETRY
    )
    return Reading(endpoint, what, message, id, data, remarks=remarks)


def _nodes_with_message(
    icd: Icd, endpoint: Endpoint, message: Message
) -> list[Endpoint]:
    """Return the node and all nodes that include the message, which may add a checksum."""
    endpoints = (
        candidate
        for candidate in all_endpoints(icd)
        if candidate.node is not endpoint.node
    )
    return [
        endpoint,
        *(
            including
            for including in endpoints
            if message in icd.messages_of(including.node)
        ),
    ]
