"""The protocol facts of a node -> the source of its ``LINK``."""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.backends.python.literals import Call, Noted, Verbatim, expression
from icdgen.backends.python.text import prose
from icdgen.describe import describe
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.protocol import facts as read
from icdgen.protocol.facts import Crc, Facts, Operation, Step

TYPES = "link"  # the module that declares the types of the facts


def values(icd: Icd, node: Node) -> dict[str, object]:
    """What the link template needs."""
    link = Maker(icd, read.of(icd, node)).link()
    return {"title": prose(node.title), "link": expression(link, 0, len("LINK = "))}


# Where a field of the facts and the key of the ICD have different names.
FRAMING = {"start": "start_of_message", "end": "end_of_message", "escaped": "escaped_data", "escapes_id": "escaped_in",
           "ignores_other": "other"}  # fmt: skip
CLIENT = {key: f"{key}_ms" for key in ("reply_timeout", "poll_interval", "poll_timeout")}
EXTENDED = {"left_at": "packets_left_byte", "left_in_last": "packets_left_in_last", "packets": "max_packets",
            "bytes": "max_bytes", "packet_timeout": "packet_timeout_ms"}  # fmt: skip
CAN = {"data_bytes": "max_data_bytes", "parts": "identifier"}
CHECKSUM = {"telecommand_buses": "telecommand", "telemetry_buses": "telemetry"}
MASK = {"size": "bytes", "msb0": "bit_order", "slot_bytes": "frame_bytes"}
LOG_MESSAGE = {"frames_at": "frames_byte"}
FILES = {"counter_bytes": "packet_counter_bytes"}
OPERATION = {"poll_interval": "poll_interval_ms", "timeout": "timeout_s"}
HOLE_MAP = {"msb0": "bit_order"}


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
            "settings": self.part("Settings", facts.client, "client", CLIENT),
            "errors": self.rest("errors", facts.errors),
            "commands": {id: self.sent(message) for id, message in sorted(facts.telecommands.items())},
            "frames": {id: message.length for id, message in sorted(facts.telemetry.items())},
            "TELECOMMANDS": Verbatim("TELECOMMANDS"),
            "TELEMETRY": Verbatim("TELEMETRY"),
        }
        optional = {
            "framing": self.part("Framing", facts.framing, "uart.framing", FRAMING),
            "acknowledge": self.part("Acknowledge", facts.acknowledge, "uart.acknowledge"),
            "polled": self.rest("i2c.acknowledge", self.polled()),
            "i2c_address": facts.i2c_address,
            "can": self.can(),
            "checksum": facts.checksum
            and self.part("Checksum", facts.checksum, "crc8", CHECKSUM, crc=self.crc("crc8", facts.checksum.crc)),
            "crc16": facts.crc16 and self.rest("crc16", self.crc("crc16", facts.crc16)),
            "mask": self.mask(),
            "log_file": self.part("LogFileForm", facts.log_file, "telemetry_log"),
            "log_message": self.part("LogMessageForm", facts.log_message, "unsolicited_log", LOG_MESSAGE),
            "time": self.rest(
                "msdos_time", {name: made("TimePart", part) for name, part in facts.time.items()} or None
            ),
            "index_file": self.index(),
            "hole_map": self.hole_map(),
            "files": self.files(),
            "program_copy": self.operation("program_copy", facts.program_copy),
            "program_information": self.operation("program_information", facts.program_information),
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

    def part(
        self, name: str, part: object, section: str, keys: Mapping[str, str] | None = None, **instead: object
    ) -> object:
        """A part of the facts with all its members that are not None."""
        if part is None:
            return None
        call = made(name, part, **instead)
        known = keys or {}
        given = {key: self.noted(value, section, known.get(key, key)) for key, value in call.keywords.items()}
        return self.rest(section, Call(call.name, (), given))

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
        extended = self.part("Extended", can.extended, "can.extended", EXTENDED)
        return self.part("Can", can, "can", CAN, parts=parts, extended=extended)

    def crc(self, section: str, form: Crc) -> Call:
        call = made("CrcForm", form)
        return Call(call.name, (), {key: self.noted(value, section, key) for key, value in call.keywords.items()})

    def mask(self) -> object:
        mask = self.facts.mask
        if mask is None:
            return None
        bits = {
            bit: Call(f"{TYPES}.LogBit", (row.bit, row.id, row.length, row.name or ""))
            for bit, row in sorted(mask.bits.items())
        }
        return self.part("LogMask", mask, "log_mask", MASK, bits=bits)

    def index(self) -> object:
        index = self.facts.index
        if index is None:
            return None
        fields = {role: (field.at, field.bytes) for role, field in index.fields.items()}
        return self.part("Index", index, "index_file", fields=fields)

    def hole_map(self) -> object:
        form, section = self.facts.hole_map, "file_transfer.hole_map"
        if form is None:
            return None
        keys = ("bytes", "message_bytes", "msb0", "received", "beyond_end")
        parts = {key: self.noted(getattr(form, key), section, HOLE_MAP.get(key, key)) for key in keys}
        parts["telecommands"] = tuple(message.telecommand_id for message in form.messages)
        parts["telemetry"] = tuple(message.telemetry_id for message in form.messages)
        parts["attribute"] = self.attributes(form.messages[0])[form.field]
        return self.rest(section, Call(f"{TYPES}.HoleMapForm", (), parts))

    def files(self) -> object:
        files = self.facts.files
        if files is None:
            return None
        steps = {path: self.in_procedure(path, self.step(step)) for path, step in files.steps.items()}
        counts = {path: self.in_procedure(path, number) for path, number in files.numbers.items()}
        ids = {bus: self.in_procedure(f"download.{bus}", id) for bus, id in files.packet_ids.items()}
        return self.part("Files", files, "file_transfer", FILES, steps=steps, numbers=counts, packet_ids=ids)

    def operation(self, section: str, form: Operation | None) -> object:
        if form is None:
            return None
        steps = {"request": self.step(form.request), "progress": self.step(form.progress)}
        return self.part("Operation", form, section, OPERATION, **steps)

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
        return {one.field.name: one.name for one in describe(self.icd).message(message).fields}


def made(name: str, part: object, **instead: object) -> Call:
    """A part of the facts with all its members, of which those that are None stand at the end."""
    keys = part.__dataclass_fields__  # type: ignore[attr-defined]
    given = {key: instead.get(key, getattr(part, key)) for key in keys}
    return Call(f"{TYPES}.{name}", (), {key: value for key, value in given.items() if value is not None})


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
