"""CAN packets -> what they are, by the identifiers that the ICD describes."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.protocol import can
from icdgen.protocol.sections import CAN_WITH_DATA
from icdgen.recognize import match
from icdgen.recognize.packets import Printed
from icdgen.recognize.reading import ACKNOWLEDGE, REFUSAL, REQUEST, TELECOMMAND, TELEMETRY, Reading, Speaker
from icdgen.values.errors import BadLength, NotFound

_WHAT = {
    "telecommand": TELECOMMAND, "acknowledge": ACKNOWLEDGE, "refusal": REFUSAL, "request": REQUEST, "reply": TELEMETRY,
    "request_refusal": REFUSAL,
}  # fmt: skip


def readings(speakers: Sequence[Speaker], packets: Sequence[Printed]) -> list[Reading]:
    """The messages that the packets make, in their order. Raises `NotFound`, `BadLength` or `Ambiguous`."""
    if not all(packet.extended for packet in packets):
        raise NotFound(
            "a packet has an 11-bit identifier, those of the ICD have 29 bits", "candump prints them with 8 digits"
        )
    sent = [can.Packet(packet.id, packet.data) for packet in packets]
    able = [speaker for speaker in speakers if speaker.facts.can]
    found = [_of_speaker(speaker, sent) for speaker in able]
    most = max(len(one) for one in found)
    if most == 0:
        raise _why_none(able[0], sent)
    complete = [one for one in found if len(one) == most]
    chosen = [_chosen([one[number] for one in complete]) for number in range(most)]
    left = _left_out(complete[0][0].speaker, sent) - most
    return (
        [chosen[0].noted(f"{left} of the CAN messages are left out: no message, or not complete"), *chosen[1:]]
        if left
        else chosen
    )


def _of_speaker(speaker: Speaker, packets: list[can.Packet]) -> list[Reading]:
    joiner, found = can.Joiner(speaker.facts, senders=len(packets)), []
    for packet in packets:
        for event in joiner.feed(0, packet):
            read = _reading(speaker, event.message) if event.message else None
            if read:
                found.append(read)
    return found


def _reading(speaker: Speaker, told: can.Message) -> Reading | None:
    sends = told.kind in ("telecommand", "acknowledge", "refusal")
    message = (speaker.facts.telecommands if sends else speaker.facts.telemetry).get(told.id)
    if message is None or (told.kind in CAN_WITH_DATA and len(told.data) != message.length):
        return None
    way = f"CAN, from address {told.source} to {told.destination}"
    return Reading(speaker, _WHAT[told.kind], message, told.id, told.data, remarks=(way,))


def _left_out(speaker: Speaker, packets: list[can.Packet]) -> int:
    """All messages that the packets begin, known or not."""
    joiner = can.Joiner(speaker.facts, senders=len(packets))
    events = [event.event for packet in packets for event in joiner.feed(0, packet)]
    return len([e for e in events if e != can.DUPLICATE]) + sum(one.completed_by is None for one in joiner.open)


def _chosen(found: list[Reading]) -> Reading:
    own = [one for one in found if one.speaker.node.name == one.message.node]
    different = {one.key: one for one in [*found, *own]}
    return match.decided(list(different.values()), f"a CAN message with id {found[0].id}")


def _why_none(speaker: Speaker, packets: list[can.Packet]) -> BadLength | NotFound:
    joiner = can.Joiner(speaker.facts, senders=len(packets))
    events = [event for packet in packets for event in joiner.feed(0, packet)]
    event = events[0] if events else None
    if joiner.open and not any(e.message for e in events):
        waiting = joiner.open[0]
        missing = waiting.count - len(waiting.packets)
        text = f"{missing} of {waiting.count} packets of the message with id {waiting.key[1]} are missing"
        return BadLength(text, waiting.count, len(waiting.packets), "give all packets of the message")
    if event and event.message:
        return match.why_none([speaker], bytes([event.message.id]) + event.message.data)
    text = event.event.replace("_", " ") if event else "no message"
    id = packets[0].id
    return NotFound(
        f"the packet with identifier 0x{id:08X} is none of {speaker.node.name}: {text}",
        "see the `can` section of its ICD",
    )
