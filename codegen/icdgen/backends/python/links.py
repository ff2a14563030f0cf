"""The protocol facts of a node -> the source of its ``LINK``."""

from __future__ import annotations

from icdgen.backends.python import names
from icdgen.backends.python.literals import Call, Verbatim, expression
from icdgen.backends.python.text import prose
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.protocol import facts as read
from icdgen.protocol.facts import Crc, Facts, Step

TYPES = "link"  # the module that declares the types of the facts


def values(icd: Icd, node: Node) -> dict[str, object]:
    """What the link template needs."""
    link = Maker(icd, read.of(icd, node)).link()
    return {"title": prose(node.title), "link": expression(link, 0, len("LINK = "))}


class Maker:
    """Makes the expression of one node's link."""

    def __init__(self, icd: Icd, facts: Facts) -> None:
        self.icd, self.facts = icd, facts

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
            "settings": made("Settings", facts.client),
            "errors": facts.errors,
            "commands": {id: sent(message) for id, message in sorted(facts.telecommands.items())},
            "frames": {id: message.length for id, message in sorted(facts.telemetry.items())},
            "TELECOMMANDS": Verbatim("TELECOMMANDS"),
            "TELEMETRY": Verbatim("TELEMETRY"),
        }
        optional = {
            "framing": facts.framing and made("Framing", facts.framing),
            "acknowledge": facts.acknowledge and made("Acknowledge", facts.acknowledge),
            "polled": self.polled(),
            "i2c_address": facts.i2c_address,
            "can": self.can(),
            "checksum": facts.checksum and made("Checksum", facts.checksum, crc=crc(facts.checksum.crc)),
            "crc16": facts.crc16 and crc(facts.crc16),
            "mask": self.mask(),
            "log_file": facts.log_file and made("LogFileForm", facts.log_file),
            "log_message": facts.log_message and made("LogMessageForm", facts.log_message),
            "time": {name: made("TimePart", part) for name, part in facts.time.items()} or None,
            "index_file": self.index(),
            "hole_map": self.hole_map(),
            "files": self.files(),
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

    def polled(self) -> Call | None:
        polled = self.facts.polled
        if polled is None:
            return None
        known = self.attributes(polled.message)
        fields = {key: known[getattr(polled, key)] for key in ("id", "processed", "error", "parameter")}
        return Call(f"{TYPES}.Polled", (), {"telemetry": polled.message.telemetry_id, **fields})

    def can(self) -> Call | None:
        can = self.facts.can
        if can is None:
            return None
        parts = {role: made("CanPart", part) for role, part in can.parts.items()}
        return made("Can", can, parts=parts, extended=can.extended and made("Extended", can.extended))

    def mask(self) -> Call | None:
        mask = self.facts.mask
        if mask is None:
            return None
        bits = {
            bit: Call(f"{TYPES}.LogBit", (row.bit, row.id, row.length, row.name or ""))
            for bit, row in sorted(mask.bits.items())
        }
        return made("LogMask", mask, bits=bits)

    def index(self) -> Call | None:
        index = self.facts.index
        if index is None:
            return None
        return made("Index", index, fields={role: (field.at, field.bytes) for role, field in index.fields.items()})

    def hole_map(self) -> Call | None:
        form = self.facts.hole_map
        if form is None:
            return None
        keys = ("bytes", "message_bytes", "msb0", "received", "beyond_end")
        parts: dict[str, object] = {key: getattr(form, key) for key in keys}
        parts["telecommands"] = tuple(message.telecommand_id for message in form.messages)
        parts["telemetry"] = tuple(message.telemetry_id for message in form.messages)
        parts["attribute"] = self.attributes(form.messages[0])[form.field]
        return Call(f"{TYPES}.HoleMapForm", (), parts)

    def files(self) -> Call | None:
        files = self.facts.files
        if files is None:
            return None
        return made("Files", files, steps={path: self.step(step) for path, step in files.steps.items()})

    def step(self, step: Step) -> Call:
        message, known = step.message, self.attributes(step.message)
        ids = {"telecommand": message.telecommand_id, "telemetry": message.telemetry_id}
        parts: dict[str, object] = {key: id for key, id in ids.items() if id is not None}
        parts["fields"] = {role: known[name] for role, name in step.fields.items()}
        return Call(f"{TYPES}.Step", (), parts)

    def attributes(self, message: Message) -> dict[str, str]:
        """Attributes of a message by the names of its fields."""
        owner = self.icd.node(message.node)
        return {field.name: names.attribute(field, owner) for field in message.fields}


def made(name: str, part: object, **instead: object) -> Call:
    """A part of the facts with all its members, of which those that are None stand at the end."""
    keys = part.__dataclass_fields__  # type: ignore[attr-defined]
    given = {key: instead.get(key, getattr(part, key)) for key in keys}
    return Call(f"{TYPES}.{name}", (), {key: value for key, value in given.items() if value is not None})


def crc(form: Crc) -> Call:
    return made("CrcForm", form)


def sent(message: Message) -> Call:
    parts: dict[str, object] = {}
    if not message.acknowledge:
        parts["acknowledged"] = False
    if message.kind == CONFIGURATION:
        parts["setting"] = True
    return Call(f"{TYPES}.Sent", (message.length,), parts)


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
