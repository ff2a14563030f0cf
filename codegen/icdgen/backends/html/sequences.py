"""Who sends what when: acknowledges and procedures as diagrams of two lines with arrows between them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import BUSES, capitalized, clip
from icdgen.icd.model import Node
from icdgen.icd.rules.wording import count
from icdgen.protocol.declared import Kind, facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Download, Step

TOP, ROW = 40, 46
_TEXT, _NOTE = 50, 62  # characters that fit between the lines


@dataclass(frozen=True, slots=True)
class Arrow:
    """From the client if ``out``; ``text`` above the arrow leads to ``url``, ``note`` stands below it."""

    out: bool
    text: str
    note: str = ""
    url: str = ""


@dataclass(frozen=True, slots=True)
class Sequence:
    """``node`` is what the right line is called."""

    title: str
    node: str
    arrows: list[Arrow]
    remarks: list[str] = field(default_factory=list)

    @property
    def height(self) -> int:
        return TOP + ROW * len(self.arrows) + 14

    @property
    def placed(self) -> list[tuple[int, Arrow]]:
        """The arrows and where they are drawn."""
        short = [Arrow(one.out, clip(one.text, _TEXT), clip(one.note, _NOTE), one.url) for one in self.arrows]
        return [(TOP + ROW * (number + 1) - 16, arrow) for number, arrow in enumerate(short)]


def acknowledges(relations: Relations, node: Node, known: Facts) -> list[Sequence]:
    """How a telecommand is acknowledged, and telemetry is asked for, on each bus that the ICD describes."""
    waits = f"waits {known.client.reply_timeout} ms, tries again {known.client.retries} times"
    found = []
    if known.framing:
        answer = "acknowledge: id and error code" if known.acknowledge else ""
        told = [Arrow(True, "telecommand: id, parameters", waits)]
        found.append(Sequence("UART, telecommand", node.title, told + ([Arrow(False, answer)] if answer else [])))
        asked = [Arrow(True, "request: id of the telemetry", waits), Arrow(False, "reply: id, data")]
        found.append(Sequence("UART, telemetry", node.title, asked))
    if known.i2c_address is not None:
        told = [Arrow(True, f"write to {known.i2c_address:02X}: id, parameters")]
        if known.polled:
            one, url = known.polled, relations.links.message(known.polled.message)
            every = f"every {known.client.poll_interval} ms, for {known.client.poll_timeout} ms at most"
            told += [Arrow(True, one.message.name, every, url), Arrow(False, f"until {one.processed}", one.error, url)]
        found.append(Sequence("I²C, telecommand", node.title, told))
    if known.can:
        types = known.can.types
        told = list(_on_can(types, "telecommand", "acknowledge", "refusal"))
        asked = list(_on_can(types, "request", "reply", "request_refusal"))
        found += [Sequence("CAN, telecommand", node.title, told), Sequence("CAN, telemetry", node.title, asked)]
    return found


def _on_can(types: dict[str, int], sent: str, answer: str, refusal: str) -> Iterator[Arrow]:
    for out, kind, note in ((True, sent, ""), (False, answer, ""), (False, refusal, "if it is refused")):
        if kind in types:
            yield Arrow(out, f"{kind.replace('_', ' ')}: type {types[kind]}", note)


def procedures(relations: Relations, node: Node, known: Facts) -> list[Sequence]:
    """The steps of each procedure that the ICD describes, in their order."""
    found = []
    for name, one in (known.files.procedures if known.files else {}).items():
        arrows = [*_steps(relations, one), *(_packets(relations, known) if isinstance(one, Download) else [])]
        found.append(Sequence(f"File {name}", node.title, arrows, _limits(one)))
    for title, operation in (("Program copy", known.program_copy), ("Program information", known.program_information)):
        if operation is not None:
            found.append(Sequence(title, node.title, list(_steps(relations, operation)), _limits(operation)))
    return found


def _steps(relations: Relations, one: object) -> Iterator[Arrow]:
    for fact in facts_of(one):
        step = getattr(one, fact.name)
        if fact.kind is not Kind.STEP or not isinstance(step, Step):
            continue
        name, url = step.message.name, relations.links.message(step.message)
        is_asked = fact.direction == "telemetry"
        yield Arrow(True, f"request for {name}" if is_asked else name, fact.about, url)
        if is_asked:
            yield Arrow(False, name, ", ".join(step.fields.values()), url)


def _packets(relations: Relations, known: Facts) -> Iterator[Arrow]:
    """The packets of a download, whose id is another one on each bus where the ICD says so."""
    files = known.files
    assert files is not None
    buses: dict[int, list[str]] = defaultdict(list)
    for bus, id in files.packet_ids.items():
        buses[id].append(BUSES[bus])
    told = "; ".join(f"id {id} on {', '.join(names)}" for id, names in buses.items())
    message = next((known.telemetry[id] for id in buses if id in known.telemetry), None)
    url = relations.links.message(message) if message else ""
    counter = f"{count(files.counter_bytes, 'byte')} of counter, " if files.counter_bytes else ""
    yield Arrow(False, message.name if message else "packets of the file", told, url)
    note = f"{counter}{count(files.packet_bytes, 'byte')} of the file each"
    yield Arrow(False, "… one packet after another", note, url)


def _limits(one: object) -> list[str]:
    """Times and counts of a procedure, in words."""
    found = []
    for fact in facts_of(one):
        value = getattr(one, fact.name)
        if fact.kind is Kind.TIME:
            found.append(f"{fact.about}: {value} ms")
        elif fact.kind is Kind.NUMBER and value is not None:
            found.append(f"{fact.about}: {value}")
    return list(map(capitalized, found))
