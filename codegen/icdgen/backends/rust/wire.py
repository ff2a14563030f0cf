"""The protocol facts of a node -> the constant ``LINK`` of its module, and what the wire modules need to know of all nodes."""

from __future__ import annotations

import textwrap
from typing import NamedTuple

from icdgen.backends.rust.facts import struct
from icdgen.backends.rust.file_transfer import files
from icdgen.backends.rust.literals import Optional, Part, Raw, Rows, Struct, flat, literal
from icdgen.backends.rust.text import WIDTH, doc, prose
from icdgen.backends.rust.wire_steps import place, step
from icdgen.describe.comments import sentence
from icdgen.icd.model import CONFIGURATION, Icd, Message
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Direction

REASONS = {
    "none": "NoError",
    "unknown_id": "UnknownId",
    "length": "Length",
    "parameter": "Parameter",
    "checksum": "Checksum",
}


class LinkRow(NamedTuple):
    """What the template of a node's link is given."""

    node: str
    doc: str
    imports: str
    literal: str
    longest: str


class Sizes(NamedTuple):
    """What the buffers of the procedures hold, for every node."""

    step: int
    map: int
    packets: int


class Wire:
    """The wire layer of an ICD."""

    def __init__(self, icd: Icd) -> None:
        self.facts = {node.name: facts.of(icd, node) for node in icd.nodes if icd.protocol_of(node)}
        self.links = [link(known) for known in self.facts.values()]
        self.sizes = sizes(list(self.facts.values()))


def sizes(known: list[Facts]) -> Sizes:
    """The most that any node needs."""
    transfers = [one.files for one in known if one.files]
    maps = [one.hole_map for one in known if one.hole_map]
    messages = [step.message.length for one in transfers for step in one.steps.values()]
    messages += [message.length for one in maps for message in one.messages]
    operations = [form for one in known for form in (one.program_copy, one.program_information) if form]
    messages += [step.message.length for form in operations for step in (form.request, form.progress)]
    return Sizes(
        max(messages, default=1),
        max((one.bytes for one in maps), default=1),
        max((one.block_packets for one in transfers), default=1),
    )


def link(known: Facts) -> LinkRow:
    """The link of a node."""
    reasons = {f"{one.section}.{one.key}": one.why for one in known.assumptions}
    used: set[str] = set()

    def why(source: str) -> str | None:
        used.add(source)
        return reasons.get(source)

    text = literal(_link(known), why)
    rest = [
        f"Assumed (`{one.section}`, `{one.key}`): {prose(sentence(one.why))}"
        for one in known.assumptions
        if f"{one.section}.{one.key}" not in used
    ]
    about = [f"The protocol of node `{known.node.name}`. What the manual leaves open is marked as assumed.", *rest]
    names = sorted({name for name in TYPES if f"{name} {{" in text or f"{name}::" in text} | {"Link"})
    return LinkRow(known.node.name, doc(about), imports(names), text, f"{longest(known):_}")


def imports(names: list[str]) -> str:
    """The ``use`` of some types, in lines of a readable width."""
    start = "use crate::wire::link::"
    line = f"{start}{{{', '.join(names)}}};"
    if len(line) <= WIDTH:
        return line
    rows = textwrap.wrap(", ".join(names) + ",", WIDTH - 4)
    return f"{start}{{\n" + "".join(f"    {row}\n" for row in rows) + "};"


TYPES = (
    "Acknowledge", "Can", "CanPart", "CanTypes", "Checksum", "CrcForm", "DownloadForm", "ErasureForm", "Extended", "Files",
    "Form", "Framing", "HoleMapForm", "Ids", "IndexForm", "ListForm", "LogBit", "LogFile", "LogMask", "LogMessage",
    "MapMessage", "OperationForm", "PerBus", "Piece", "Polled", "Reason", "Role", "Settings", "Span", "Step", "TimeForm",
    "TimePart", "UploadForm",
)  # fmt: skip


def longest(known: Facts) -> int:
    """What every buffer of the wire layer needs: the longest message, all packets of one on CAN, an entry of a log."""
    found = [known.longest]
    if known.can and known.can.extended:
        size = known.can.extended.data_bytes
        found.append(-(-known.longest_data // size) * size)
    if known.log_file and known.mask:
        found.append(known.log_file.frames_at + known.mask.size * 8 * known.mask.slot_bytes)
        found.append(known.log_file.header_bytes)
    return max(found)


def _link(known: Facts) -> Struct:
    node = known.node
    return Struct(
        "Link",
        (
            Part("node", node.name),
            Part("nodes", Rows(known.owners)),
            Part("node_type", Optional(node.node_type)),
            Part("interface_version", Optional(node.interface_version)),
            Part("longest", known.longest),
            Part("longest_data", known.longest_data),
            Part("little", known.little),
            Part("telecommand_ids", _ids(known.telecommand_ids)),
            Part("telemetry_ids", _ids(known.telemetry_ids)),
            Part("telecommands", _forms(known.telecommands)),
            Part("telemetry", _forms(known.telemetry)),
            Part("client", struct(known, known.client, "client")),
            Part("errors", _errors(known)),
            Part("framing", Optional(struct(known, known.framing, "uart.framing"))),
            Part(
                "acknowledge", Optional(struct(known, known.acknowledge, "uart.acknowledge")), "uart.acknowledge.data"
            ),
            Part("i2c_address", Optional(known.i2c_address)),
            Part("polled", Optional(_polled(known))),
            Part("can", Optional(_can(known))),
            Part("checksum", Optional(_checksum(known))),
            Part("crc16", Optional(struct(known, known.crc16, "crc16"))),
            Part("mask", Optional(_mask(known))),
            Part("log_file", Optional(struct(known, known.log_file, "telemetry_log"))),
            Part(
                "log_message", Optional(struct(known, known.log_message, "unsolicited_log")), "unsolicited_log.framed"
            ),
            Part("time", Optional(_time(known))),
            Part("index", Optional(_index(known))),
            Part("files", Optional(files(known))),
            Part("program_copy", Optional(struct(known, known.program_copy, "program_copy"))),
            Part("program_information", Optional(struct(known, known.program_information, "program_information"))),
            Part("identification", Optional(step(known, known.identification, "telemetry"))),
            Part("boot_ms", Optional(known.boot_ms)),
        ),
    )


def _ids(ids: Direction) -> Struct:
    return flat("Ids", first=ids.first, last=ids.last)


def _forms(messages: dict[int, Message]) -> Rows:
    return Rows(
        flat(
            "Form",
            id=id,
            length=message.length,
            acknowledged=message.acknowledge,
            repeatable=message.kind == CONFIGURATION,
        )
        for id, message in sorted(messages.items())
    )


def _errors(known: Facts) -> Rows:
    return Rows((code, Raw(f"Reason::{REASONS[key]}")) for key, code in known.errors.items() if key in REASONS)


def _polled(known: Facts) -> Struct | None:
    form = known.polled
    if form is None:
        return None
    names = ("id", "processed", "error", "parameter")
    places = (Part(name, place(known, form.message, getattr(form, name))) for name in names)
    return Struct("Polled", (Part("frame", form.message.ids[0]), *places))


def _can(known: Facts) -> Struct | None:
    form = known.can
    if form is None or not {"type", "channel", "source", "destination"} <= set(form.parts):
        return None
    parts = {role: flat("CanPart", bits=part.bits, shift=part.shift) for role, part in form.parts.items()}
    types = _can_types(form.extended_types)
    return struct(
        known,
        form,
        "can",
        Part("kind", parts["type"]),
        Part("id", parts["channel"]),
        Part("source", parts["source"]),
        Part("destination", parts["destination"]),
        Part("types", _can_types(form.types)),
        Part("extended", Optional(struct(known, form.extended, "can.extended", Part("types", types)))),
    )


def _can_types(types: dict[str, int]) -> Struct:
    names = ("telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal")
    return Struct("CanTypes", tuple(Part(name, Optional(types.get(name))) for name in names))


def _checksum(known: Facts) -> Struct | None:
    form = known.checksum
    return struct(known, form, "crc8", Part("crc", struct(known, form.crc, "crc8"))) if form else None


def _mask(known: Facts) -> Struct | None:
    form = known.mask
    if form is None:
        return None
    bits = Rows(
        flat("LogBit", bit=bit, id=row.id, length=row.length, name=row.name or "")
        for bit, row in sorted(form.bits.items())
        if row.id is not None
    )
    return struct(known, form, "log_mask", Part("bits", bits, "log_mask.unassigned_bits"))


def _time(known: Facts) -> Struct | None:
    names = ("year", "month", "day", "hour", "minute", "second")
    if not set(names) <= set(known.time):
        return None
    parts = []
    for name in names:
        part = known.time[name]
        parts.append(Part(name, flat("TimePart", at=part.at, bits=part.bits, factor=part.factor, offset=part.offset)))
    return Struct("TimeForm", tuple(parts))


def _index(known: Facts) -> Struct | None:
    names = {"kind": "type", **{name: name for name in ("counter", "checksum", "size", "time", "meta")}}
    form = known.index
    if form is None or not set(names.values()) <= set(form.fields):
        return None
    spans = (
        Part(name, flat("Span", at=form.fields[role].at, bytes=form.fields[role].bytes)) for name, role in names.items()
    )
    return struct(known, form, "index_file", *spans)
