"""Bytes in the envelopes that an ICD describes -> the messages in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from icdgen_runtime.wire.envelope import Direction
from icdgen_runtime.wire.stream import StreamDecoder, StreamEvent

from icdgen.recognize import match
from icdgen.recognize.asked import Asked
from icdgen.recognize.reading import Reading, Speaker
from icdgen.values.errors import BadLength

DIRECTIONS: tuple[Direction, ...] = ("telecommand", "telemetry")


class Heard(NamedTuple):
    """What one direction of a link makes of the bytes; ``lost`` of them belong to no message."""

    speaker: Speaker
    readings: list[Reading]
    events: list[StreamEvent]
    lost: int


def readings(speakers: Sequence[Speaker], data: bytes, asked: Asked) -> list[Reading]:
    """The messages, of the direction that leaves the least, of those that have what is asked for if any has.

    There are none if nothing is in an envelope, or hardly by intent.

    Raises `BadLength` if there is one whose checksum is wrong, `Ambiguous`.
    """
    heard = [_heard(one, direction, data) for one in speakers if one.facts.stream for direction in DIRECTIONS]
    found = [one for one in heard if one.readings and (one.lost == 0 or _is_marked(one.speaker))]
    if not found:
        for one in heard:
            if one.events and one.events[0].event == "checksum" and _is_marked(one.speaker):
                raise BadLength(_wrong(one), 0, len(data), "a byte of it is damaged, or the frame is of another node")
        return []
    found = [one for one in found if any(map(asked.fits, one.readings))] or found
    least, fewer = min((one.lost, -len(one.readings)) for one in found)
    most = -fewer
    best = [one for one in found if (one.lost, len(one.readings)) == (least, most)]
    chosen = [match.decided([one.readings[at] for one in best], "a frame in an envelope", asked) for at in range(most)]
    wrong = dict.fromkeys(event.event for event in best[0].events if event.event not in ("message", "gap"))
    return [chosen[0].noted(*match.around(least, wrong)), *chosen[1:]]


def _is_marked(speaker: Speaker) -> bool:
    """Whether a message shows that it is one, by a constant or a checksum."""
    form = speaker.facts.stream
    return form is not None and (form.check is not None or form.of("constant") is not None)


def _heard(speaker: Speaker, direction: Direction, data: bytes) -> Heard:
    decoder = StreamDecoder(speaker.link, direction)
    events = decoder.feed(data)
    known = getattr(speaker.ids, direction)
    found = []
    for event in events:
        if event.event != "message" or event.id is None:
            continue
        message = match.message_of(speaker.icd, [one.message for one in known.get(event.id, ())], event.data)
        if message is not None and match.miscounted(speaker, message, event.data) is None:
            chosen = ", ".join(f"{role} {value}" for role, value in event.values.items())
            note = f"envelope with id {event.id} removed" + (f"; it has {chosen}" if chosen else "")
            checked = speaker.link.stream is not None and speaker.link.stream.check is not None
            found.append(Reading(speaker, direction, message, event.id, event.data, checked=checked, remarks=(note,)))
    return Heard(speaker, found, events, decoder.discarded + decoder.pending)


def _wrong(heard: Heard) -> str:
    id = heard.events[0].id
    return f"a message in an envelope{'' if id is None else f', with id {id},'} has a wrong checksum"
