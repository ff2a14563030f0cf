"""Sequence diagrams of acknowledges and procedures: two lifelines with arrows between
them.

`acknowledges` and `procedures` return lists of arrows; a template draws them as SVG.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sized
from dataclasses import dataclass, field, replace

from icdgen.backends.html import responses
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import BUSES, capitalized, clip
from icdgen.icd.buses import I2C, bus_link
from icdgen.icd.model import Message, Node
from icdgen.icd.responses import ACK, BUSY, NAK, PROGRESS
from icdgen.protocol.facts import Facts
from icdgen.protocol.procedures import (
    Get,
    GetMap,
    NextBlock,
    NextPacket,
    NextRound,
    Poll,
    Procedure,
    Receive,
    Send,
    SendMap,
    SkipUnless,
    Test,
)
from icdgen.wording import count

TOP, ROW = 40, 46
_TEXT, _NOTE = 50, 62  # characters that fit between the lifelines


@dataclass(frozen=True, slots=True)
class Arrow:
    """Arrow of a diagram, from the client if ``out``.

    ``text`` is above the arrow and links to ``url``; ``note`` is below it.
    """

    out: bool
    text: str
    note: str = ""
    url: str = ""


@dataclass(frozen=True, slots=True)
class SequenceDiagram:
    """Sequence diagram.

    ``node``: label of the right lifeline.
    """

    title: str
    node: str
    arrows: list[Arrow]
    remarks: list[str] = field(default_factory=list)

    @property
    def height(self) -> int:
        return TOP + ROW * len(self.arrows) + 14

    @property
    def placed(self) -> list[tuple[int, Arrow]]:
        """Arrows with their vertical positions."""
        short = [
            Arrow(
                arrow.out, clip(arrow.text, _TEXT), clip(arrow.note, _NOTE), arrow.url
            )
            for arrow in self.arrows
        ]
        return [
            (TOP + ROW * (number + 1) - 16, arrow) for number, arrow in enumerate(short)
        ]


def acknowledges(
    relations: Relations, node: Node, node_facts: Facts
) -> list[SequenceDiagram]:
    """Return the acknowledge of a telecommand and the request of telemetry, for each
    bus of the ICD.
    """
    again = count(node_facts.client.retries, "time")
    waits = f"waits {node_facts.client.reply_timeout} ms, tries again {again}"
    sequences = list(_on_framed_link(relations, node, node_facts))
    if node_facts.framing:
        answer = "acknowledge: id and error code" if node_facts.acknowledge else ""
        arrows = [Arrow(True, "telecommand: id, parameters", waits)]
        sequences.append(
            SequenceDiagram(
                "UART, telecommand",
                node.title,
                arrows + ([Arrow(False, answer)] if answer else []),
            )
        )
        arrows = [
            Arrow(True, "request: id of the telemetry", waits),
            Arrow(False, "reply: id, data"),
        ]
        sequences.append(SequenceDiagram("UART, telemetry", node.title, arrows))
    if node_facts.i2c_address is not None:
        arrows = [Arrow(True, f"write to {node_facts.i2c_address:02X}: id, parameters")]
        if node_facts.polled:
            polled, url = node_facts.polled, relations.links.message(node_facts.polled)
            link = relations.icd.protocol_of(node)["link"]
            row = bus_link(link, I2C).commands[ACK]
            every = f"every {node_facts.client.poll_interval} ms, for {node_facts.client.poll_timeout} ms at most"
            arrows += [
                Arrow(True, polled.name, every, url),
                Arrow(False, f"until {row['until']}", row["status"], url),
            ]
        sequences.append(SequenceDiagram("I²C, telecommand", node.title, arrows))
    if node_facts.can:
        types = node_facts.can.types
        telecommand_arrows = list(
            _can_arrows(types, "telecommand", "acknowledge", "refusal")
        )
        telemetry_arrows = list(
            _can_arrows(types, "request", "reply", "request_refusal")
        )
        sequences += [
            SequenceDiagram("CAN, telecommand", node.title, telecommand_arrows),
            SequenceDiagram("CAN, telemetry", node.title, telemetry_arrows),
        ]
    return sequences


def _on_framed_link(
    relations: Relations, node: Node, node_facts: Facts
) -> Iterator[SequenceDiagram]:
    """Yield the outcomes of a telecommand on a framed link, and of a request of
    telemetry.
    """
    client = node_facts.client
    if not node_facts.stream:
        return
    notes = {
        ACK: "it is done",
        NAK: "it is refused",
        BUSY: f"sent again after {client.busy_pause} ms, {count(client.retries, 'time')} at most",
        PROGRESS: "the time-out starts again",
    }
    if rows := responses.general_responses(relations, node):
        waits = f"waits {client.reply_timeout} ms; if it may be repeated, {count(client.retries, 'more time')}"
        arrows = [Arrow(True, "telecommand", waits), *_response_arrows(rows, notes)]
        yield SequenceDiagram(
            "Framed link, telecommand", node.title, arrows, _remarks(arrows)
        )
    if request := responses.request_row(relations, node):
        timeout = request.timeout or f"{client.reply_timeout} ms"
        waits = f"waits {timeout}, tries again {count(client.retries, 'time')}"
        sent = "request: id of the telemetry"
        if request.packet.text:
            sent = f"packet {request.packet.text}: id of the telemetry"
        arrows = [
            Arrow(True, sent, waits, request.packet.url),
            _telemetry_arrow(request),
            *_response_arrows(request.rows, notes),
        ]
        yield SequenceDiagram(
            "Framed link, telemetry", node.title, arrows, _remarks(arrows)
        )


def _telemetry_arrow(request: responses.RequestRow) -> Arrow:
    """Return the arrow of the requested telemetry."""
    if request.response is None:
        return Arrow(False, "the telemetry")
    text = f"packet {request.response.text}: the telemetry"
    return Arrow(False, text, "", request.response.url)


def _response_arrows(
    rows: Iterable[responses.ResponseRow], notes: Mapping[str, str]
) -> Iterator[Arrow]:
    """Yield the arrow of each response, with its meaning by kind."""
    for row in rows:
        if row.kind in notes:
            text = f"{row.name}: {row.echo}" if row.echo else row.name
            # A status can say more than one thing.
            note = row.about if row.has_status else notes[row.kind]
            yield Arrow(False, text, note, row.url)


def _remarks(arrows: Sized) -> list[str]:
    return ["The device sends one of these responses."] if len(arrows) > 2 else []


def _can_arrows(
    types: dict[str, int], sent: str, answer: str, refusal: str
) -> Iterator[Arrow]:
    for out, kind, note in (
        (True, sent, ""),
        (False, answer, ""),
        (False, refusal, "if it is refused"),
    ):
        if kind in types:
            yield Arrow(out, f"{kind.replace('_', ' ')}: type {types[kind]}", note)


def procedures(
    relations: Relations, node: Node, node_facts: Facts
) -> list[SequenceDiagram]:
    """Return the steps of each procedure of the ICD, in order."""
    return [
        SequenceDiagram(
            capitalized(procedure.name.replace("_", " ")),
            node.title,
            list(_step_arrows(relations, node_facts, procedure)),
            list(_limit_texts(procedure)),
        )
        for procedure in node_facts.procedures
    ]


def _step_arrows(
    relations: Relations, node_facts: Facts, procedure: Procedure
) -> Iterator[Arrow]:
    """Yield the arrows of the steps.

    The note of the first arrow in a loop describes the loop: ``for each block``.
    """
    # Loops and tests have no arrow. Their words wait for the next step that has one.
    when: list[str] = []
    blocks = procedure.blocks
    for step in procedure.steps:
        arrows: list[Arrow] = []
        match step:
            case NextBlock():
                when.append("for each block")
            case NextRound():
                when.append("while packets are missing")
            case NextPacket():
                when.append("for each missing packet")
            case SkipUnless():
                when.append(f"if {_test_text(procedure, step.test)}")
            case Send():
                arrows = [_message_arrow(relations, True, step.message)]
            case Get() | Poll():
                request = f"request for {step.message.name}"
                note = until = ""
                if isinstance(step, Poll):
                    note = f"every {step.interval} ms, for {step.timeout} ms at most"
                    tests = (_test_text(procedure, test) for test in step.until)
                    until = f"until {', '.join(tests)}"
                arrows = [
                    _message_arrow(relations, True, step.message, request, note),
                    _message_arrow(relations, False, step.message, note=until),
                ]
            case Receive():
                note = f"until all are there, or none is new for {step.silence} ms"
                arrows = [
                    _message_arrow(
                        relations, False, step.message, note=_ways(node_facts, step)
                    ),
                    Arrow(False, "… one packet after another", note),
                ]
            case SendMap() if blocks and blocks.map:
                first = blocks.map.messages[0]
                about = "the map of received packets"
                arrows = [_message_arrow(relations, True, first, about)]
            case GetMap() if blocks and blocks.map:
                first = blocks.map.messages[0]
                about = "request for the map of received packets"
                arrows = [
                    _message_arrow(relations, True, first, about),
                    _message_arrow(relations, False, first, "the map"),
                ]
        if arrows and when:
            note = "; ".join([*when, arrows[0].note] if arrows[0].note else when)
            arrows[0], when = replace(arrows[0], note=note), []
        yield from arrows


def _ways(node_facts: Facts, step: Receive) -> str:
    """Return how packets come: under the id of another message, or on request."""
    ways = [
        f"under id {head} on {BUSES['uart']}"
        for head, id in node_facts.unsolicited.items()
        if id == step.message.telemetry_id
    ]
    if step.requested_on:
        buses = (BUSES[bus] for bus in step.requested_on)
        ways.append(f"requested one by one on {', '.join(buses)}")
    return "; ".join(ways)


def _message_arrow(
    relations: Relations, out: bool, message: Message, text: str = "", note: str = ""
) -> Arrow:
    """Return an arrow that links to a message, with its name or another text."""
    return Arrow(out, text or message.name, note, relations.links.message(message))


def _test_text(procedure: Procedure, test: Test) -> str:
    """Return a test as text, such as ``Busy = 0``."""
    value = test.value
    names = procedure.register_names
    wanted = names[value.number] if value.in_register else value.number
    return f"{names[test.register]} = {wanted}"


def _limit_texts(procedure: Procedure) -> Iterator[str]:
    """Yield the limits of a procedure as text."""
    if procedure.blocks:
        blocks = procedure.blocks
        yield f"Blocks of up to {blocks.size} bytes, in packets of {blocks.packet_bytes}"
        yield f"Rounds of a block: {blocks.rounds}"
        yield f"Bytes in all: {blocks.most}"
    if procedure.most_entries:
        yield f"Entries: {procedure.most_entries}"
    yield f"Longest duration: {procedure.time // 1000} s"
    yield f"Requests: {procedure.requests}"
