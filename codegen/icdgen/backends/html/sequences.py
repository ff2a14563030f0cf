"""Sequence diagrams of acknowledges and procedures: two lifelines with arrows between
them.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sized
from dataclasses import dataclass, field

from icdgen.backends.html import responses
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import BUSES, capitalized, clip
from icdgen.icd.model import Node
from icdgen.icd.responses import ACK, BUSY, NAK, PROGRESS
from icdgen.protocol.declared import Kind, facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Download, Step
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
class Sequence:
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


def acknowledges(relations: Relations, node: Node, node_facts: Facts) -> list[Sequence]:
    """Return the acknowledge of a telecommand and the request of telemetry, for each
    bus of the ICD.
    """
    waits = f"waits {node_facts.client.reply_timeout} ms, tries again {node_facts.client.retries} times"
    sequences = list(_on_framed_link(relations, node, node_facts))
    if node_facts.framing:
        answer = "acknowledge: id and error code" if node_facts.acknowledge else ""
        arrows = [Arrow(True, "telecommand: id, parameters", waits)]
        sequences.append(
            Sequence(
                "UART, telecommand",
                node.title,
                arrows + ([Arrow(False, answer)] if answer else []),
            )
        )
        arrows = [
            Arrow(True, "request: id of the telemetry", waits),
            Arrow(False, "reply: id, data"),
        ]
        sequences.append(Sequence("UART, telemetry", node.title, arrows))
    if node_facts.i2c_address is not None:
        arrows = [Arrow(True, f"write to {node_facts.i2c_address:02X}: id, parameters")]
        if node_facts.polled:
            polled, url = node_facts.polled, relations.links.message(
                node_facts.polled.message
            )
            every = f"every {node_facts.client.poll_interval} ms, for {node_facts.client.poll_timeout} ms at most"
            arrows += [
                Arrow(True, polled.message.name, every, url),
                Arrow(False, f"until {polled.processed}", polled.error, url),
            ]
        sequences.append(Sequence("I²C, telecommand", node.title, arrows))
    if node_facts.can:
        types = node_facts.can.types
        telecommand_arrows = list(
            _on_can(types, "telecommand", "acknowledge", "refusal")
        )
        telemetry_arrows = list(_on_can(types, "request", "reply", "request_refusal"))
        sequences += [
            Sequence("CAN, telecommand", node.title, telecommand_arrows),
            Sequence("CAN, telemetry", node.title, telemetry_arrows),
        ]
    return sequences


def _on_framed_link(
    relations: Relations, node: Node, node_facts: Facts
) -> Iterator[Sequence]:
    """Yield the outcomes of a telecommand on a framed link, and of a request of
    telemetry.
    """
    client = node_facts.client
    if not node_facts.stream:
        return
    notes = {
        ACK: "it is done",
        NAK: "it is refused",
        BUSY: f"sent again after {client.busy_pause} ms, {client.retries} times at most",
        PROGRESS: "the time-out begins anew",
    }
    if rows := responses.general(relations, node):
        waits = f"waits {client.reply_timeout} ms; if it may be repeated, {client.retries} more times"
        arrows = [Arrow(True, "telecommand", waits), *_responses(rows, notes)]
        yield Sequence("Framed link, telecommand", node.title, arrows, _remarks(arrows))
    if request := responses.request_row(relations, node):
        timeout = request.timeout or f"{client.reply_timeout} ms"
        waits = f"waits {timeout}, tries again {client.retries} times"
        sent = "request: id of the telemetry"
        if request.packet.text:
            sent = f"packet {request.packet.text}: id of the telemetry"
        arrows = [
            Arrow(True, sent, waits, request.packet.url),
            _telemetry_arrow(request),
            *_responses(request.rows, notes),
        ]
        yield Sequence("Framed link, telemetry", node.title, arrows, _remarks(arrows))


def _telemetry_arrow(request: responses.RequestRow) -> Arrow:
    """Return the arrow of the requested telemetry."""
    if request.response is None:
        return Arrow(False, "the telemetry")
    text = f"packet {request.response.text}: the telemetry"
    return Arrow(False, text, "", request.response.url)


def _responses(
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


def _on_can(
    types: dict[str, int], sent: str, answer: str, refusal: str
) -> Iterator[Arrow]:
    for out, kind, note in (
        (True, sent, ""),
        (False, answer, ""),
        (False, refusal, "if it is refused"),
    ):
        if kind in types:
            yield Arrow(out, f"{kind.replace('_', ' ')}: type {types[kind]}", note)


def procedures(relations: Relations, node: Node, node_facts: Facts) -> list[Sequence]:
    """Return the steps of each procedure of the ICD, in order."""
    sequences = []
    for name, procedure in (
        node_facts.files.procedures if node_facts.files else {}
    ).items():
        arrows = [
            *_steps(relations, procedure),
            *(
                _packets(relations, node_facts)
                if isinstance(procedure, Download)
                else []
            ),
        ]
        sequences.append(
            Sequence(f"File {name}", node.title, arrows, _limits(procedure))
        )
    for title, operation in (
        ("Program copy", node_facts.program_copy),
        ("Program information", node_facts.program_information),
    ):
        if operation is not None:
            sequences.append(
                Sequence(
                    title,
                    node.title,
                    list(_steps(relations, operation)),
                    _limits(operation),
                )
            )
    return sequences


def _steps(relations: Relations, procedure: object) -> Iterator[Arrow]:
    for fact in facts_of(procedure):
        step = getattr(procedure, fact.name)
        # Optional steps that the ICD does not describe are skipped.
        if fact.kind is not Kind.STEP or not isinstance(step, Step):
            continue
        name, url = step.message.name, relations.links.message(step.message)
        # Telemetry takes two arrows: the request and the reply.
        is_asked = fact.direction == "telemetry"
        yield Arrow(True, f"request for {name}" if is_asked else name, fact.about, url)
        if is_asked:
            yield Arrow(False, name, ", ".join(step.fields.values()), url)


def _packets(relations: Relations, node_facts: Facts) -> Iterator[Arrow]:
    """Yield the packets of a download, whose ids can differ between buses."""
    files = node_facts.files
    assert files is not None
    # Buses with equal ids share an arrow.
    buses: dict[int, list[str]] = defaultdict(list)
    for bus, id in files.packet_ids.items():
        buses[id].append(BUSES[bus])
    ids_by_bus = "; ".join(
        f"id {id} on {', '.join(names)}" for id, names in buses.items()
    )
    message = next(
        (node_facts.telemetry[id] for id in buses if id in node_facts.telemetry), None
    )
    url = relations.links.message(message) if message else ""
    counter = (
        f"{count(files.counter_bytes, 'byte')} of counter, "
        if files.counter_bytes
        else ""
    )
    yield Arrow(
        False, message.name if message else "packets of the file", ids_by_bus, url
    )
    note = f"{counter}{count(files.packet_bytes, 'byte')} of the file each"
    yield Arrow(False, "… one packet after another", note, url)


def _limits(procedure: object) -> list[str]:
    """Return times and counts of a procedure as text."""
    limits = []
    for fact in facts_of(procedure):
        value = getattr(procedure, fact.name)
        if fact.kind is Kind.TIME:
            limits.append(f"{fact.about}: {value} ms")
        elif fact.kind is Kind.NUMBER and value is not None:
            limits.append(f"{fact.about}: {value}")
    return list(map(capitalized, limits))
