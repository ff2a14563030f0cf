"""Bytes without framing of a message that the user has named."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from icdgen.describe.numbers import byte_count, length_text
from icdgen.icd.model import Icd, Message
from icdgen.recognize import match
from icdgen.recognize.reading import TELECOMMAND, TELEMETRY, Reading, Speaker, all_speakers
from icdgen.values.errors import BadLength


def of_asked(icd: Icd, speaker: Speaker, messages: Sequence[Message], data: bytes) -> Reading:
    """Return the message of the data, which may begin with the id.

    If several messages share the id, length and constants of the data distinguish them.
    Raise `BadLength` or `NotFound`.
    """
    if len(messages) == 1:
        return of_message(icd, speaker, messages[0], data)
    apart = speaker.taken_apart(data)
    found = match.message_of(icd, messages, data)
    if found is None and apart is not None and apart[0] in messages[0].ids:
        found = match.message_of(icd, messages, apart[1])
    if found is None:
        raise match.none_of(messages, byte_count(len(data)))
    return of_message(icd, speaker, found, data)


def of_message(icd: Icd, speaker: Speaker, message: Message, data: bytes) -> Reading:
    """Return the message, without its id and checksum if present. Raise `BadLength`."""
    plain = message.telecommand_id if message.telecommand_id is not None else message.telemetry_id
    assert plain is not None
    if len(data) in message.layout.lengths:
        wrong = match.miscounted(speaker, message, data)
        if wrong is not None:
            raise wrong
        return _reading(speaker, message, None, data)
    apart = speaker.taken_apart(data)
    for id, rest in [(None, data), *([apart] if apart and apart[0] in message.ids else [])]:
        taken = () if id is None else (f"id {id} removed",)
        for other in _talking(icd, speaker, message):
            right = match.checksum(other, plain if id is None else id, message, rest)
            if right is not None and rest[message.length :] == right:
                return _reading(speaker, message, id, rest[: message.length], *taken, "CRC is right")
        if id is not None and len(rest) in message.layout.lengths and match.miscounted(speaker, message, rest) is None:
            return _reading(speaker, message, id, rest, *taken)
    right = match.checksum(speaker, plain, message, data)
    if right is not None:
        raise match.wrong_checksum(message, right, data)
    help = f"`icdgen show {speaker.node.name} {shlex.quote(message.name)}` shows what it holds"
    text = f"{message.name} has {length_text(message)}, {len(data)} given"
    raise BadLength(text, message.length, len(data), help)


def _reading(speaker: Speaker, message: Message, id: int | None, data: bytes, *remarks: str) -> Reading:
    what = message.kind if id is None else TELECOMMAND if id == message.telecommand_id else TELEMETRY
    return Reading(speaker, what, message, id, data, remarks=remarks)


def _talking(icd: Icd, speaker: Speaker, message: Message) -> list[Speaker]:
    """Return the node and all nodes that include the message, which may add a checksum."""
    others = (one for one in all_speakers(icd) if one.node is not speaker.node)
    return [speaker, *(other for other in others if message in icd.messages_of(other.node))]
