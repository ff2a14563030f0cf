"""The link of a node: its protocol facts as the source of its ``LINK``."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from icdgen.backends.python.literals import Call, Noted, Verbatim, expression
from icdgen.describe.links import Assumptions, LinkDescription, SentMessage
from icdgen.protocol.declared import facts_of
from icdgen.protocol.envelope import Check, Stream, StreamRow
from icdgen.protocol.sections import Crc, Download, Erasure, HoleMap, Listing, LogFile, LogMessage, Step, Upload

# Types whose names in generated code are not those of the facts.
_TYPES = {
    Crc: "CrcForm", LogFile: "LogFileForm", LogMessage: "LogMessageForm", HoleMap: "HoleMapForm",
    Listing: "ListForm", Download: "DownloadForm", Upload: "UploadForm", Erasure: "ErasureForm",
}  # fmt: skip


def type_name(part: type) -> str:
    """What the type of a part is called in the module of the types."""
    return _TYPES.get(part, part.__name__)


def literal(link: LinkDescription) -> str:
    """The source of the link."""
    return expression(call(link))


def call(link: LinkDescription) -> Call:
    """The call that makes the link. What is assumed has the reason in a comment above it."""
    return _Maker(link).link()


def _call(name: str, **keywords: object) -> Call:
    """Makes something of the module of the types."""
    return Call(f"link.{name}", (), keywords)


def _row(name: str, *positional: object, **keywords: object) -> Call:
    """The same on one line."""
    return Call(f"link.{name}", positional, keywords, is_flat=True)


class _Maker:
    def __init__(self, link: LinkDescription) -> None:
        self.description, self.facts, self.assumed = link, link.facts, Assumptions(link.facts)

    def link(self) -> Call:
        facts, node = self.facts, self.facts.node
        parts: dict[str, object] = {
            "node": node.name,
            "order": "little" if facts.little else "big",
            "node_type": node.node_type,
            "interface_version": node.interface_version,
            "longest": facts.longest,
            "longest_data": facts.longest_data,
            "telemetry_ids": (facts.telemetry_ids.first, facts.telemetry_ids.last),
            "settings": self.part(facts.client, "client"),
            "errors": self.noted_rest(facts.errors, "errors"),
            "commands": {one.id: self.sent(one) for one in self.description.telecommands},
            "frames": {one.id: one.message.length for one in self.description.telemetry},
            "TELECOMMANDS": Verbatim("TELECOMMANDS"),
            "TELEMETRY": Verbatim("TELEMETRY"),
        }
        time = {name: _flat("TimePart", part) for name, part in facts.time.items()}
        optional = {
            "framing": self.part(facts.framing, "uart.framing"),
            "acknowledge": self.part(facts.acknowledge, "uart.acknowledge"),
            "polled": self.noted_rest(self.polled(), "i2c.acknowledge"),
            "i2c_address": facts.i2c_address,
            "i2c_repeated_start": None if facts.i2c_repeated_start else False,
            "can": self.can(),
            "checksum": self.checksum(),
            "crc16": self.part(facts.crc16, "crc16"),
            "mask": self.mask(),
            "log_file": self.part(facts.log_file, "telemetry_log"),
            "log_message": self.part(facts.log_message, "unsolicited_log"),
            "time": self.noted_rest(time or None, "msdos_time"),
            "index_file": self.index(),
            "hole_map": self.hole_map(),
            "files": self.files(),
            "program_copy": self.part(facts.program_copy, "program_copy"),
            "program_information": self.part(facts.program_information, "program_information"),
            "identification": facts.identification and self.step(facts.identification),
            "statistics": facts.statistics and self.step(facts.statistics),
            "boot_time": facts.boot_ms,
            "stream": self.noted_rest(facts.stream and _stream(facts.stream), "stream"),
            "assumptions": self.assumptions() or None,
        }
        return _call("Link", **parts, **{key: part for key, part in optional.items() if part is not None})

    def noted(self, value: object, section: str, key: str) -> object:
        """The value, under the reason why it is assumed, if it is."""
        why = self.assumed.why(section, key)
        return Noted(value, (f"Assumed: {why}",)) if why else value

    def noted_rest(self, value: object, section: str) -> object:
        """The value, under the reasons for what the section holds beside its fields."""
        rest = self.assumed.of_section(section) if value is not None else []
        return Noted(value, tuple(f"Assumed, {key}: {why}" for key, why in rest)) if rest else value

    def part(self, part: object, section: str, **made: object) -> object:
        """A part of the facts: those that are declared, and what code ``made`` beside them."""
        if part is None:
            return None
        return self.noted_rest(_call(type_name(type(part)), **self.declared(part, section), **made), section)

    def declared(self, part: object, section: str) -> dict[str, object]:
        """The facts of a part as they are declared, without those that are None."""
        found: dict[str, object] = {}
        for fact in facts_of(part):
            value = getattr(part, fact.name)
            if isinstance(value, Step):
                value = self.step(value)
            if value is not None:
                found[fact.name] = self.noted(value, section, fact.key.partition(".")[0])
        return found

    def polled(self) -> Call | None:
        step = self.description.polled
        if step is None:
            return None
        return _call("Polled", telemetry=step.message.telemetry_id, **{role: field.name for role, field in step.fields})

    def can(self) -> object:
        can = self.facts.can
        if can is None:
            return None
        parts = {role: _flat("CanPart", part) for role, part in can.parts.items()}
        made = {
            "parts": self.noted(parts, "can", "identifier"),
            "types": can.types,
            "extended_types": can.extended_types,
        }
        made |= {"extended": self.part(can.extended, "can.extended")} if can.extended else {}
        return self.part(can, "can", **made)

    def checksum(self) -> object:
        form = self.facts.checksum
        return self.part(form, "crc8", crc=_call("CrcForm", **self.declared(form.crc, "crc8"))) if form else None

    def mask(self) -> object:
        mask = self.facts.mask
        if mask is None:
            return None
        bits = {
            bit: _row("LogBit", row.bit, row.id, row.length, row.name or "") for bit, row in sorted(mask.bits.items())
        }
        return self.part(mask, "log_mask", bits=bits)

    def index(self) -> object:
        index = self.facts.index
        fields = {role: (field.at, field.bytes) for role, field in index.fields.items()} if index else {}
        return self.part(index, "index_file", fields=fields)

    def hole_map(self) -> object:
        pieces = self.description.map_pieces
        if not pieces:
            return None
        return self.part(
            self.facts.hole_map,
            "file_transfer.hole_map",
            telecommands=tuple(field.message.model.telecommand_id for field in pieces),
            telemetry=tuple(field.message.model.telemetry_id for field in pieces),
            attribute=pieces[0].name,
        )

    def files(self) -> object:
        files = self.facts.files
        if files is None:
            return None
        return self.part(
            files,
            "file_transfer",
            packet_ids={bus: self.noted(id, "file_transfer.download", bus) for bus, id in files.packet_ids.items()},
            **{name: self.part(one, f"file_transfer.{name}") for name, one in files.procedures.items()},
        )

    def step(self, step: Step) -> Call:
        message = step.message
        ids = {"telecommand": message.telecommand_id, "telemetry": message.telemetry_id}
        fields = {role: field.name for role, field in self.description.step(step).fields}
        return _call("Step", **{key: id for key, id in ids.items() if id is not None}, fields=fields)

    def sent(self, one: SentMessage) -> object:
        """How a telecommand is sent."""
        flags = {} if one.message.acknowledge else {"acknowledged": False}
        flags |= {"setting": True} if one.is_setting else {}
        return self.noted_rest(_row("Sent", one.message.length, **flags), f"message {one.message.name}")

    def assumptions(self) -> tuple[Call, ...]:
        """All of them once more, for programs."""
        return tuple(
            _call("Assumption", section=one.section, key=one.key, value=_plain(one.value), why=str(one.why))
            for one in self.facts.assumptions
        )


def _stream(form: Stream) -> Call:
    """The envelope."""
    parts = _members(form)
    parts["fields"] = tuple(_row("EnvelopeField", *_members(one).values()) for one in form.fields)
    parts["telecommands"], parts["telemetry"] = map(_stream_rows, (form.telecommands, form.telemetry))
    check = parts.pop("check")
    if isinstance(check, Check):
        crc = {fact.name: getattr(check.crc, fact.name) for fact in facts_of(check.crc)}
        known = _row("CrcForm", **{key: value for key, value in crc.items() if value is not None})
        parts["check"] = _row("CheckForm", *{**_members(check), "crc": known}.values())
    return _call("Stream", **parts)


def _stream_rows(rows: tuple[StreamRow, ...]) -> tuple[Call, ...]:
    found = ((row.id, row.least, row.most, row.cuts_zeros, row.seed, row.reply) for row in rows)
    return tuple(_row("StreamRow", *(one if one[-1] is not None else one[:-1])) for one in found)


def _flat(name: str, part: Any) -> Call:
    """A small part with all its members."""
    return _row(name, **_members(part))


def _members(part: Any) -> dict[str, object]:
    """All that an object of a dataclass holds."""
    return {one.name: getattr(part, one.name) for one in fields(part)}


def _plain(value: object) -> object:
    """A value of the ICD without what the reader of YAML knows of it."""
    if isinstance(value, dict):
        return {_plain(key): _plain(item) for key, item in value.items() if key not in ("assumptions", "source")}
    if isinstance(value, list | tuple):
        return tuple(_plain(item) for item in value)
    if isinstance(value, bool) or value is None:
        return value
    for kind in (str, int, float):
        if isinstance(value, kind):
            return kind(value)
    return str(value)
