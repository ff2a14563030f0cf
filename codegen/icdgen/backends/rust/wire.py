"""The protocol facts of a node -> the constant ``LINK`` of its module, and what the wire modules need to know of all nodes."""

from __future__ import annotations

import textwrap
from typing import NamedTuple

from icdgen.backends.rust.file_transfer import files, operation
from icdgen.backends.rust.literals import Optional, Part, Raw, Rows, Struct, flat, literal
from icdgen.backends.rust.text import WIDTH, doc, mask, prose
from icdgen.backends.rust.wire_steps import place, step
from icdgen.describe.comments import sentence
from icdgen.icd.model import CONFIGURATION, Icd, Message
from icdgen.protocol import facts
from icdgen.protocol.facts import Crc, Facts

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
            Part("client", _client(known)),
            Part("errors", _errors(known)),
            Part("framing", Optional(_framing(known))),
            Part("acknowledge", Optional(_acknowledge(known)), "uart.acknowledge.data"),
            Part("i2c_address", Optional(known.i2c_address)),
            Part("polled", Optional(_polled(known))),
            Part("can", Optional(_can(known))),
            Part("checksum", Optional(_checksum(known))),
            Part("crc16", Optional(_crc(known.crc16))),
            Part("mask", Optional(_mask(known))),
            Part("log_file", Optional(_log_file(known))),
            Part("log_message", Optional(_log_message(known)), "unsolicited_log.framed"),
            Part("time", Optional(_time(known))),
            Part("index", Optional(_index(known))),
            Part("files", Optional(files(known))),
            Part("program_copy", Optional(operation(known, "program_copy"))),
            Part("program_information", Optional(operation(known, "program_information"))),
            Part("identification", Optional(step(known, known.identification, "telemetry"))),
            Part("boot_ms", Optional(known.boot_ms)),
        ),
    )


def _ids(ids: facts.Direction) -> Struct:
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


def _client(known: Facts) -> Struct:
    given = known.client
    return Struct(
        "Settings",
        (
            Part("reply_timeout_ms", given.reply_timeout, "client.reply_timeout_ms"),
            Part("retries", given.retries, "client.retries"),
            Part("poll_interval_ms", given.poll_interval, "client.poll_interval_ms"),
            Part("poll_timeout_ms", given.poll_timeout, "client.poll_timeout_ms"),
        ),
    )


def _errors(known: Facts) -> Rows:
    return Rows((code, Raw(f"Reason::{REASONS[key]}")) for key, code in known.errors.items() if key in REASONS)


def _framing(known: Facts) -> Struct | None:
    form = known.framing
    if form is None:
        return None
    return Struct(
        "Framing",
        (
            Part("escape", Raw(f"0x{form.escape:02x}")),
            Part("start", Raw(f"0x{form.start:02x}")),
            Part("end", Raw(f"0x{form.end:02x}")),
            Part("escaped", Raw(f"0x{form.escaped:02x}")),
            Part("escapes_id", form.escapes_id, "uart.framing.escaped_in"),
            Part("ignores_other", form.ignores_other, "uart.framing.other"),
        ),
    )


def _acknowledge(known: Facts) -> Struct | None:
    form = known.acknowledge
    if form is None:
        return None
    return flat("Acknowledge", length=form.length, id_at=form.id_at, error_at=form.error_at)


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
    return Struct(
        "Can",
        (
            Part("kind", parts["type"]),
            Part("id", parts["channel"]),
            Part("source", parts["source"]),
            Part("destination", parts["destination"]),
            Part("node_address", form.node_address, "can.node_address"),
            Part("data_bytes", form.data_bytes, "can.max_data_bytes"),
            Part("types", _can_types(form.types)),
            Part("extended", Optional(_extended(form))),
        ),
    )


def _can_types(types: dict[str, int]) -> Struct:
    names = ("telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal")
    return Struct("CanTypes", tuple(Part(name, Optional(types.get(name))) for name in names))


def _extended(can: facts.Can) -> Struct | None:
    form = can.extended
    if form is None:
        return None
    return Struct(
        "Extended",
        (
            Part("types", _can_types(can.extended_types)),
            Part("data_bytes", form.data_bytes, "can.extended.data_bytes"),
            Part("left_at", form.left_at, "can.extended.packets_left_byte"),
            Part("left_in_last", form.left_in_last, "can.extended.packets_left_in_last"),
            Part("bytes", form.bytes, "can.extended.max_bytes"),
            Part("fill", form.fill, "can.extended.fill"),
            Part("packet_timeout_ms", form.packet_timeout, "can.extended.packet_timeout_ms"),
        ),
    )


def _checksum(known: Facts) -> Struct | None:
    form = known.checksum
    if form is None:
        return None
    return Struct(
        "Checksum",
        (
            Part("crc", _crc(form.crc)),
            Part("covers_id", form.covers_id, "crc8.covers_id"),
            Part("telecommands", _buses(form.telecommand_buses), "crc8.telecommand"),
            Part("telemetry", _buses(form.telemetry_buses), "crc8.telemetry"),
            Part("bytes", form.bytes),
        ),
    )


def _buses(buses: tuple[str, ...]) -> Struct:
    return flat("PerBus", **{bus: bus in buses for bus in ("uart", "i2c", "can")})


def _crc(form: Crc | None) -> Struct | None:
    if form is None:
        return None
    bits = -(-form.width // 4) * 4
    return Struct(
        "CrcForm",
        (
            Part("width", form.width),
            Part("polynomial", Raw(mask(form.polynomial, bits))),
            Part("init", Raw(mask(form.init, bits))),
            Part("reflect_in", form.reflect_in),
            Part("reflect_out", form.reflect_out),
            Part("xor_out", Raw(mask(form.xor_out, bits))),
            Part("empty", Optional(None if form.empty is None else Raw(mask(form.empty, bits)))),
        ),
    )


def _mask(known: Facts) -> Struct | None:
    form = known.mask
    if form is None:
        return None
    bits = Rows(
        flat("LogBit", bit=bit, id=row.id, length=row.length, name=row.name or "")
        for bit, row in sorted(form.bits.items())
        if row.id is not None
    )
    return Struct(
        "LogMask",
        (
            Part("bytes", form.size),
            Part("msb0", form.msb0, "log_mask.frame_order"),
            Part("slot_bytes", form.slot_bytes, "log_mask.short_frames"),
            Part("fill", form.fill, "log_mask.fill"),
            Part("bits", bits, "log_mask.unassigned_bits"),
        ),
    )


def span(at: int, size: int) -> Struct:
    """Some bytes."""
    return flat("Span", at=at, bytes=size)


def _log_file(known: Facts) -> Struct | None:
    form = known.log_file
    if form is None:
        return None
    return Struct(
        "LogFile",
        (
            Part("mask_at", form.mask_at),
            Part("header_bytes", form.header_bytes),
            Part("seconds", span(*form.seconds)),
            Part("milliseconds", span(*form.milliseconds)),
            Part("frames_at", form.frames_at),
            Part("file_type", Optional(form.file_type)),
        ),
    )


def _log_message(known: Facts) -> Struct | None:
    form = known.log_message
    if form is None:
        return None
    return flat("LogMessage", id=form.id, mask_at=form.mask_at, frames_at=form.frames_at)


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
    spans = (Part(name, span(form.fields[role].at, form.fields[role].bytes)) for name, role in names.items())
    return Struct(
        "IndexForm", (Part("entry_bytes", form.entry_bytes), *spans, Part("file_type", Optional(form.file_type)))
    )
