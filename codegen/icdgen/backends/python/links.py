"""The protocol facts of a node -> the source of its ``LINK``."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from icdgen.backends.python.literals import Call, Noted, Verbatim, expression
from icdgen.backends.python.text import prose
from icdgen.describe import describe
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.protocol import facts as read
from icdgen.protocol.declared import facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Crc, HoleMap, LogFile, LogMessage, Settings, Step

TYPES = "link"  # the module that declares the types of the facts


def values(icd: Icd, node: Node) -> dict[str, object]:
    """What the link template needs."""
    link = Maker(icd, read.of(icd, node)).link()
    return {"title": prose(node.title), "link": expression(link, 0, len("LINK = "))}


# Types whose names in generated code are not those of the facts.
_TYPES = {
    Settings: "Settings",
    Crc: "CrcForm",
    LogFile: "LogFileForm",
    LogMessage: "LogMessageForm",
    HoleMap: "HoleMapForm",
}


def type_name(part: type) -> str:
    """What the type of a part is called in the module of the types."""
    return _TYPES.get(part, part.__name__)


class Maker:
    """Makes the expression of one node's link. What is assumed has the reason in a comment above it."""

    def __init__(self, icd: Icd, facts: Facts) -> None:
        self.icd, self.facts = icd, facts
        self.why = {(one.section, one.key): one.why for one in facts.assumptions}  # what no comment told so far

    def link(self) -> Call:
        facts = self.facts
        parts: dict[str, object] = {
            "node": facts.node.name,
            "order": "little" if facts.little else "big",
            "node_type": facts.node.node_type,
            "interface_version": facts.node.interface_version,
            "longest": facts.longest,
            "longest_data": facts.longest_data,
            "telemetry_ids": (facts.telemetry_ids.first, facts.telemetry_ids.last),
            "settings": self.part(facts.client, "client"),
            "errors": self.rest("errors", facts.errors),
            "commands": {id: self.sent(message) for id, message in sorted(facts.telecommands.items())},
            "frames": {id: message.length for id, message in sorted(facts.telemetry.items())},
            "TELECOMMANDS": Verbatim("TELECOMMANDS"),
            "TELEMETRY": Verbatim("TELEMETRY"),
        }
        optional = {
            "framing": self.part(facts.framing, "uart.framing"),
            "acknowledge": self.part(facts.acknowledge, "uart.acknowledge"),
            "polled": self.rest("i2c.acknowledge", self.polled()),
            "i2c_address": facts.i2c_address,
            "can": self.can(),
            "checksum": facts.checksum
            and self.part(facts.checksum, "crc8", crc=self.facts_in(facts.checksum.crc, "crc8")),
            "crc16": self.part(facts.crc16, "crc16"),
            "mask": self.mask(),
            "log_file": self.part(facts.log_file, "telemetry_log"),
            "log_message": self.part(facts.log_message, "unsolicited_log"),
            "time": self.rest(
                "msdos_time", {name: made("TimePart", part) for name, part in facts.time.items()} or None
            ),
            "index_file": self.index(),
            "hole_map": self.hole_map(),
            "files": self.files(),
            "program_copy": self.part(facts.program_copy, "program_copy"),
            "program_information": self.part(facts.program_information, "program_information"),
            "identification": facts.identification and self.step(facts.identification),
            "statistics": facts.statistics and self.step(facts.statistics),
            "boot_time": facts.boot_ms,
        }
        parts.update({key: part for key, part in optional.items() if part is not None})
        if facts.assumptions:
            keys = ("section", "key", "value", "why")
            rows = [{key: plain(getattr(one, key)) for key in keys} for one in facts.assumptions]
            parts["assumptions"] = tuple(Call(f"{TYPES}.Assumption", (), row) for row in rows)
        return Call(f"{TYPES}.Link", (), parts)

    def noted(self, value: object, section: str, key: str) -> object:
        """The value, under the reason why it is assumed, if it is."""
        why = self.why.pop((section, key), None)
        return value if why is None else Noted(value, (f"Assumed: {why}",))

    def rest(self, section: str, value: object) -> object:
        """The value, under the reasons for what the section holds beside its fields."""
        keys = [key for where, key in self.why if where == section] if value is not None else []
        notes = tuple(f"Assumed, {key}: {self.why.pop((section, key))}" for key in keys)
        return Noted(value, notes) if notes else value

    def part(self, part: object, section: str, **made: object) -> object:
        """A part of the facts: those that are declared, and what code ``made`` beside them."""
        if part is None:
            return None
        call = self.facts_in(part, section)
        return self.rest(section, Call(call.name, (), {**call.keywords, **made}))

    def facts_in(self, part: object, section: str) -> Call:
        """The facts of a part as they are declared, without those that are None."""
        given: dict[str, object] = {}
        for fact in facts_of(part):
            value = getattr(part, fact.name)
            if isinstance(value, Step):
                value = self.step(value)
            if value is not None:
                given[fact.name] = self.noted(value, section, fact.key.partition(".")[0])
        return Call(f"{TYPES}.{type_name(type(part))}", (), given)

    def polled(self) -> Call | None:
        polled = self.facts.polled
        if polled is None:
            return None
        known = self.attributes(polled.message)
        fields = {key: known[getattr(polled, key)] for key in ("id", "processed", "error", "parameter")}
        return Call(f"{TYPES}.Polled", (), {"telemetry": polled.message.telemetry_id, **fields})

    def can(self) -> object:
        can = self.facts.can
        if can is None:
            return None
        parts = {role: made("CanPart", part) for role, part in can.parts.items()}
        made_here = {
            "parts": self.noted(parts, "can", "identifier"),
            "types": can.types,
            "extended_types": can.extended_types,
        }
        if can.extended:
            made_here["extended"] = self.part(can.extended, "can.extended")
        return self.part(can, "can", **made_here)

    def mask(self) -> object:
        mask = self.facts.mask
        if mask is None:
            return None
        bits = {
            bit: Call(f"{TYPES}.LogBit", (row.bit, row.id, row.length, row.name or ""))
            for bit, row in sorted(mask.bits.items())
        }
        return self.part(mask, "log_mask", bits=bits)

    def index(self) -> object:
        index = self.facts.index
        if index is None:
            return None
        return self.part(
            index, "index_file", fields={role: (field.at, field.bytes) for role, field in index.fields.items()}
        )

    def hole_map(self) -> object:
        form = self.facts.hole_map
        if form is None:
            return None
        return self.part(
            form,
            "file_transfer.hole_map",
            telecommands=tuple(message.telecommand_id for message in form.messages),
            telemetry=tuple(message.telemetry_id for message in form.messages),
            attribute=self.attributes(form.messages[0])[form.field],
        )

    def files(self) -> object:
        files = self.facts.files
        if files is None:
            return None
        steps = {path: self.in_procedure(path, self.step(step)) for path, step in files.steps.items()}
        counts = {path: self.in_procedure(path, number) for path, number in files.numbers.items()}
        ids = {bus: self.in_procedure(f"download.{bus}", id) for bus, id in files.packet_ids.items()}
        return self.part(
            files, "file_transfer", steps=steps, numbers=counts, packet_ids=ids, destinations=files.destinations
        )

    def in_procedure(self, path: str, value: object) -> object:
        """A value of a procedure of file transfer, by its path there."""
        procedure, _, key = path.partition(".")
        return self.noted(value, f"file_transfer.{procedure}", key)

    def step(self, step: Step) -> Call:
        message, known = step.message, self.attributes(step.message)
        ids = {"telecommand": message.telecommand_id, "telemetry": message.telemetry_id}
        parts: dict[str, object] = {key: id for key, id in ids.items() if id is not None}
        parts["fields"] = {role: known[name] for role, name in step.fields.items()}
        return Call(f"{TYPES}.Step", (), parts)

    def sent(self, message: Message) -> object:
        """How a telecommand is sent."""
        parts: dict[str, object] = {}
        if not message.acknowledge:
            parts["acknowledged"] = False
        if message.kind == CONFIGURATION:
            parts["setting"] = True
        return self.rest(f"message {message.name}", Call(f"{TYPES}.Sent", (message.length,), parts))

    def attributes(self, message: Message) -> dict[str, str]:
        """Attributes of a message by the names of its fields."""
        return {one.model.name: one.name for one in describe(self.icd).message(message).fields}


def made(name: str, part: Any) -> Call:
    """A small part with all its members."""
    return Call(f"{TYPES}.{name}", (), {one.name: getattr(part, one.name) for one in fields(part)})


def plain(value: object) -> object:
    """A value of the ICD without what the reader of YAML knows of it."""
    if isinstance(value, dict):
        return {plain(key): plain(item) for key, item in value.items() if key not in ("assumptions", "source")}
    if isinstance(value, list | tuple):
        return tuple(plain(item) for item in value)
    if isinstance(value, bool) or value is None:
        return value
    for kind in (str, int, float):
        if isinstance(value, kind):
            return kind(value)
    return str(value)
