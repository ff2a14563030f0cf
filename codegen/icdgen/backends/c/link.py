"""The link of a node: its protocol facts as tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from icdgen import codec
from icdgen.backends.c.constants import Constant
from icdgen.backends.c.plan import Plan
from icdgen.backends.c.statement import STEP
from icdgen.backends.c.text import WIDTH, comment, plain
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.protocol.can import KINDS
from icdgen.protocol.facts import CAN, I2C, UART, Checksum, Crc, Facts, Files, Step

BUSES = (UART, I2C, CAN)
_ROLES = frozenset(
    "type counter offset length ready error checksum ignore_hole_map destination block_size busy number bytes all size "
    "time node_type interface_version id processed parameter".split()
)
_REASONS = {"none", "unknown_id", "length", "parameter", "checksum"}
_DATE = ("year", "month", "day", "hour", "minute", "second")
_INDEX = ("type", "counter", "checksum", "size", "time", "meta")
_CAN_BYTES = 8
_MOST_PACKETS = 256
_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF


class Table(NamedTuple):
    """A constant of the link."""

    comment: str
    type: str
    name: str
    rows: list[str]


class Alias(NamedTuple):
    """A macro that stands for the id of a message in one direction."""

    name: str
    value: str


def step_bytes(all_facts: Iterable[Facts]) -> int:
    """Bytes of the longest message that takes part in a procedure."""
    sizes = [1]
    for known in all_facts:
        sizes += [step.message.length for step in (known.files.steps.values() if known.files else ())]
        sizes += [message.length for message in (known.hole_map.messages if known.hole_map else ())]
    return max(sizes)


def sizes(known: Facts) -> list[Constant]:
    """Sizes of buffers."""
    upper, packet = known.node.name.upper(), known.can and known.can.extended
    rows = [("LONGEST", known.longest, "Bytes of the longest message of either direction, with id and checksum.")]
    slot = 0
    if known.can:
        slot = 1 + (-(-known.longest_data // packet.data_bytes) * packet.data_bytes if packet else 0)
        rows.append(("CAN_SLOT_BYTES", slot, "Bytes that joining CAN packets takes for each sender at once."))
    rows.append(("CLIENT_BYTES", known.longest_telecommand + max(slot, known.longest), "Bytes of a client's buffer."))
    if known.log_file and known.mask:
        most = known.mask.size + known.log_file.frames_at + known.mask.size * 8 * known.mask.slot_bytes
        rows.append(("LOG_BYTES", max(most, known.log_file.header_bytes), "Bytes of a log reader's buffer."))
    if known.files:
        files = known.files
        packets = known.packets_of(files.block_bytes)
        rows.append(("BLOCK_BYTES", packets * files.packet_bytes, "Bytes of the largest block of a file."))
        rows.append(("BLOCK_BITMAP_BYTES", -(-packets // 8), "Bytes of a bit for each packet of such a block."))
    return [Constant(comment([text]), f"{upper}_{end}", f"{value}u") for end, value, text in rows]


def aliases(plans: Iterable[Plan]) -> list[Alias]:
    """``DEMO_ANGLES_TELEMETRY``: the id under which a message is requested, whatever its kind."""
    found = []
    for plan in plans:
        if plan.message.telemetry_id is not None:
            upper = plan.stem.upper()
            end = "GET_ID" if plan.message.kind == CONFIGURATION else "ID"
            found.append(Alias(f"{upper}_TELEMETRY", f"{upper}_{end}"))
    return found


class LinkTables:
    """The tables of one node, in the order in which they are declared."""

    def __init__(self, known: Facts) -> None:
        self.known = known
        self.tables: list[Table] = []
        self.why = {(a.section, a.key): a.why for a in known.assumptions}

    def all(self) -> list[Table]:
        """Those of the parts, then the link itself."""
        known = self.known
        flag = lambda value: str(value).lower()  # noqa: E731
        files = known.files
        parts = [
            (flag(known.little), "byte order: little"),
            (flag(known.node.bit_order == "msb0"), "bit 0 is the most significant one"),
            (f"{known.telemetry_ids.first}u, {known.telemetry_ids.last}u", "ids of telemetry"),
            (self.messages("telecommands", known.telecommands), ""),
            (self.messages("telemetry", known.telemetry), ""),
            (f"{len(_short(known.telecommands))}u, {len(_short(known.telemetry))}u", "how many"),
            (
                f"{known.longest_telecommand}u, {known.longest_reply}u, {known.longest}u",
                "longest telecommand, reply, any",
            ),
            (f"{known.longest_data}u", "longest without id and checksum"),
            (_or_none(known.node.node_type), "node type"),
            (_or_none(known.node.interface_version), "interface version"),
            (self.client(), ""),
            (self.errors(), ""),
            (f"{len(self.reasons())}u, {known.errors.get('none', 0)}u", "how many; no error"),
            (self.framing(), ""),
            (self.acknowledge(), ""),
            (_or_none(known.i2c_address), "I2C address"),
            (self.polled(), ""),
            (self.can(), ""),
            (self.checksum(), ""),
            (self.crc16(), ""),
            (self.log_mask(), ""),
            (self.log_file(), ""),
            (self.log_message(), ""),
            (self.time(), ""),
            (self.index(), ""),
            (self.hole_map(), ""),
            (self.files(), ""),
            (self.list(files) if files else "NULL", "list"),
            (self.download(files) if files else "NULL", "download"),
            (self.upload(files) if files else "NULL", "upload"),
            (self.erase(files, "erase") if files else "NULL", "erase"),
            (self.erase(files, "format") if files else "NULL", "format"),
            (self.identification(), "identification"),
        ]
        self.add("link", "icd_link_t", [_row(value, text) for value, text in parts], self.section_notes("client"))
        return self.tables

    def add(self, name: str, type: str, rows: Sequence[str], about: str = "") -> str:
        """Declares a table; the expression that leads to it."""
        array = name.endswith("]")
        self.tables.append(Table(comment([about], STEP) if about else "", type, name, list(rows)))
        return name.removesuffix("[]") if array else f"&{name}"

    def messages(self, name: str, known: dict[int, Message]) -> str:
        rows = []
        for id, message in sorted(_short(known).items()):
            flags = []
            if name == "telecommands":
                flags += ["ICD_ACKNOWLEDGED"] if message.acknowledge else []
                flags += ["ICD_EXPECTS_RESET"] if message.expects_reset else []
                flags += ["ICD_SETTING"] if message.kind == CONFIGURATION else []
            text = plain(message.name)
            why = self.why.get((f"message {message.name}", "acknowledge"))
            text += f". Assumed acknowledge: {plain(why)}" if why and name == "telecommands" else ""
            rows += _wrapped(f"{{{id}u, {' | '.join(flags) or '0u'}, {message.length}u}},", text)
        return self.add(f"{name}[]", "icd_message_t", rows) if rows else "NULL"

    def client(self) -> str:
        one = self.known.client
        return f"{{{one.reply_timeout}u, {one.retries}u, {one.poll_interval}u, {one.poll_timeout}u}}"

    def reasons(self) -> list[tuple[str, int]]:
        return [(key, code) for key, code in self.known.errors.items() if key in _REASONS]

    def errors(self) -> str:
        rows = [f"{{ICD_REASON_{key.upper()}, {code}u}}," for key, code in self.reasons()]
        return self.add("errors[]", "icd_error_code_t", rows) if rows else "NULL"

    def framing(self) -> str:
        one = self.known.framing
        if one is None:
            return "NULL"
        rows = [
            _row(f"{one.escape:#04x}u", "escape"),
            _row(f"{one.start:#04x}u", "start"),
            _row(f"{one.end:#04x}u", "end"),
            _row(f"{one.escaped:#04x}u", "the escape byte as data"),
            _row(_bool(one.escapes_id), "the id is escaped"),
            _row(_bool(one.ignores_other), "an escape byte before any other byte is skipped"),
        ]
        return self.add("framing", "icd_framing_t", rows, self.section_notes("uart.framing"))

    def acknowledge(self) -> str:
        one = self.known.acknowledge
        if one is None:
            return "NULL"
        rows = [_row(f"{one.length}u", "length"), _row(f"{one.id_at}u", "id"), _row(f"{one.error_at}u", "error")]
        return self.add("acknowledge", "icd_acknowledge_t", rows, self.section_notes("uart.acknowledge"))

    def polled(self) -> str:
        one = self.known.polled
        if one is None:
            return "NULL"
        fields = {"id": one.id, "processed": one.processed, "error": one.error, "parameter": one.parameter}
        return self.add("polled", "icd_step_t", [self.step("polled", Step(one.message, fields), braces=False)])

    def can(self) -> str:
        one = self.known.can
        form = one and one.extended
        if one is None or one.data_bytes > _CAN_BYTES or (form and self.too_wide()):
            return "NULL"
        types = (", ".join(str(t.get(kind, -1)) for kind in KINDS) for t in (one.types, one.extended_types))
        rows = [
            _row(f"{{{one.parts[role].bits}u, {one.parts[role].shift}u}}", f"{role}: bits, shift")
            for role in ("type", "channel", "source", "destination")
        ]
        rows += [
            _row(f"{one.node_address}u", "address of the node"),
            _row(f"{one.data_bytes}u", "bytes of a packet"),
            _row(f"{{{next(types)}}}", "types"),
            _row(f"{{{next(types)}}}", "types of messages of several packets"),
        ]
        if form:
            rows += [
                _row("true, " + f"{form.data_bytes}u", "bytes of each of their packets"),
                _row(f"{form.left_at}u, {form.left_in_last}u", "the count of packets left, and in the last one"),
                _row(f"{form.fill:#04x}u", "fill"),
                _row(f"{form.bytes}u", "most bytes"),
                _row(f"{form.packet_timeout}u", "time-out"),
            ]
        else:
            rows.append(_row("false, 0u, 0u, 0u, 0u, 0u, 0u", "no messages of several packets"))
        return self.add("can", "icd_can_form_t", rows, self.section_notes("can.extended"))

    def too_wide(self) -> bool:
        form = self.known.can and self.known.can.extended
        assert form
        packets = -(-self.known.longest_data // form.data_bytes)
        return form.left_at >= _CAN_BYTES or form.data_bytes > form.left_at or packets > _MOST_PACKETS

    def crc(self, name: str, one: Crc) -> str:
        table = "NULL"
        if 8 <= one.width <= 16:
            entries = [f"{value:#0{2 + -(-one.width // 4)}x}u," for value in crc_table(one)]
            self.add(f"{name}_table[]", "uint16_t", _lines(entries), "")
            table = f"{name}_table"
        flags = (one.reflect_in, one.reflect_out, one.empty is not None)
        numbers = (one.polynomial, one.init, one.xor_out, one.empty or 0)
        return ", ".join([f"{one.width}u", *map(_bool, flags), *(f"{number:#x}u" for number in numbers), table])

    def checksum(self) -> str:
        one: Checksum | None = self.known.checksum
        if one is None:
            return "NULL"
        buses = (sum(1 << BUSES.index(bus) for bus in b) for b in (one.telecommand_buses, one.telemetry_buses))
        rows = [
            _row(f"{{{self.crc('crc8', one.crc)}}}", "CRC"),
            _row(_bool(one.covers_id), "covers the id"),
            _row(f"{next(buses)}u, {next(buses)}u", "buses of telecommands and of telemetry"),
            _row(f"{one.bytes}u", "bytes"),
        ]
        return self.add("checksum", "icd_checksum_form_t", rows, self.section_notes("crc8"))

    def crc16(self) -> str:
        one = self.known.crc16
        return "NULL" if one is None else self.add("crc16", "icd_crc_form_t", [self.crc("crc16", one)])

    def log_mask(self) -> str:
        one = self.known.mask
        if one is None:
            return "NULL"
        rows = []
        for bit in range(one.size * 8):
            row = one.bits.get(bit)
            text = f"bit {bit}" + (f": {plain(row.name)}" if row and row.name else "")
            id, length = (row.id, row.length) if row else (None, one.slot_bytes)
            rows.append(f"{{{_or_none(id)}, {length}u}}, /* {text} */")
        bits = self.add("log_bits[]", "icd_log_bit_t", rows)
        parts = [
            _row(f"{one.size}u", "bytes"),
            _row(_bool(one.msb0), "bit 0 of a byte is the most significant one"),
            _row(f"{one.fill:#04x}u", "fill"),
            _row(f"{one.slot_bytes}u", "bytes of a slot"),
            bits,
        ]
        return self.add("log_mask", "icd_log_mask_form_t", parts, self.section_notes("log_mask"))

    def log_file(self) -> str:
        one = self.known.log_file
        if one is None:
            return "NULL"
        rows = [
            _row(f"{one.mask_at}u, {one.header_bytes}u", "the mask, and the bytes of the header"),
            _row(f"{{{one.seconds[0]}u, {one.seconds[1]}u}}", "seconds"),
            _row(f"{{{one.milliseconds[0]}u, {one.milliseconds[1]}u}}", "milliseconds"),
            _row(f"{one.frames_at}u", "frames"),
        ]
        return self.add("log_file", "icd_log_file_form_t", rows, self.section_notes("telemetry_log"))

    def log_message(self) -> str:
        one = self.known.log_message
        if one is None or self.known.mask is None:
            return "NULL"
        rows = [_row(f"{one.id}u", "id"), _row(f"{one.mask_at}u, {one.frames_at}u", "mask and frames")]
        return self.add("log_message", "icd_log_message_form_t", rows, self.section_notes("unsolicited_log"))

    def section_notes(self, section: str) -> str:
        """What is assumed in a section, and why."""
        found = [f"{key}: {why}" for (where, key), why in self.why.items() if where == section]
        return " ".join(f"Assumed {plain(text)}" for text in found)

    def time(self) -> str:
        form = self.known.time
        if not all(name in form for name in _DATE):
            return "NULL"
        rows = []
        for name in _DATE:
            one = form[name]
            rows.append(_row(f"{{{one.at}u, {one.bits}u, {one.factor}u, {one.offset}u}}", name))
        return self.add("packed_time", "icd_time_form_t", rows)

    def index(self) -> str:
        form = self.known.index
        if form is None or not all(name in form.fields for name in _INDEX):
            return "NULL"
        rows = [_row(f"{form.entry_bytes}u", "bytes of an entry")]
        rows += [_row(f"{{{form.fields[n].at}u, {form.fields[n].bytes}u}}", n) for n in _INDEX]
        return self.add("index_entry", "icd_index_form_t", rows)

    def hole_map(self) -> str:
        one = self.known.hole_map
        if one is None:
            return "NULL"
        rows = []
        for message in one.messages:
            at = next(f.at // 8 for f in message.fields if f.name == one.field)
            ids = f"{_or_none(message.telecommand_id)}, {_or_none(message.telemetry_id)}"
            rows += _wrapped(f"{{{ids}, {message.length}u, {at}u}},", plain(message.name))
        pieces = self.add("hole_maps[]", "icd_hole_map_message_t", rows)
        parts = [
            _row(f"{one.bytes}u, {one.message_bytes}u", "bytes, and in each message"),
            _row(_bool(one.msb0), "bit 0 of a byte is the most significant one"),
            _row(_bool(bool(one.received)), "received"),
            _row(_bool(bool(one.beyond_end)), "beyond the end"),
            f"{len(one.messages)}u, {pieces},",
        ]
        return self.add("hole_map", "icd_hole_map_form_t", parts, self.section_notes("file_transfer.hole_map"))

    def files(self) -> str:
        one = self.known.files
        if one is None:
            return "NULL"
        ids = ", ".join(_or_none(one.packet_ids.get(bus)) for bus in BUSES)
        rows = [
            _row(f"{one.packet_bytes}u, {one.counter_bytes}u", "bytes of a packet, and of its number"),
            _row(f"{one.first_packet}u", "number of the first"),
            _row(f"{one.fill:#04x}u", "fill"),
            _row(f"{one.block_bytes}u", "bytes of a block"),
            _row(f"{{{ids}}}", "ids of download packets"),
        ]
        return self.add("files", "icd_files_form_t", rows, self.section_notes("file_transfer"))

    def step(self, name: str, step: Step, braces: bool = True) -> str:
        """The initialiser of a step; its places and its fresh frame are tables of their own."""
        message, rows = step.message, []
        fields = {field.name: field for field in message.fields}
        for role, field in step.fields.items():
            if role in _ROLES:
                one = fields[field]
                text = f"{{ICD_ROLE_{role.upper()}, {one.at}u, {one.bits}u}},"
                rows.append(f"{text} /* {plain(one.name)} */")
        stem = name.replace(".", "_")
        places = self.add(f"{stem}_places[]", "icd_place_t", rows) if rows else "NULL"
        fresh = "NULL"
        if any(field.const for field in message.fields):
            raw = {f.name: bytes(f.bits // 8) if f.type == "bytes" else f.const or 0 for f in message.fields}
            data = codec.encode(self.known.node, message, raw)
            fresh = self.add(f"{stem}_fresh[]", "uint8_t", _lines([f"{byte:#04x}u," for byte in data]))
        ids = f"{_or_none(message.telecommand_id)}, {_or_none(message.telemetry_id)}"
        text = f"{ids}, {message.length}u, {len(rows)}u, {places}, {fresh}"
        return f"{{{text}}}" if braces else text

    def steps(self, files: Files, part: str, names: Sequence[str], numbers: Sequence[str]) -> Iterator[str] | None:
        """Rows of a procedure's steps and numbers; None if the ICD lacks one."""
        found = [files.steps.get(f"{part}.{name}") for name in names]
        if not all(found) or any(f"{part}.{key}" not in files.numbers for key in numbers):
            return None
        rows = [
            _row(self.step(f"{part}.{name}", step), plain(step.message.name))
            for name, step in zip(names, found, strict=True)
            if step
        ]
        return iter([*rows, *(_row(f"{files.numbers[f'{part}.{key}']}u", key) for key in numbers)])

    def procedure(self, files: Files, part: str, type: str, names: str, numbers: str, *more: str) -> str:
        rows = self.steps(files, part, names.split(), numbers.split())
        if rows is None:
            return "NULL"
        return self.add(part, type, [*rows, *more], self.section_notes(f"file_transfer.{part}"))

    def list(self, files: Files) -> str:
        return self.procedure(
            files, "list", "icd_list_form_t", "reset advance information", "poll_interval_ms timeout_ms"
        )

    def download(self, files: Files) -> str:
        covers = _bool(bool(files.numbers.get("download.checksum_covers_fill")))
        return self.procedure(
            files, "download", "icd_download_form_t", "load ready burst",
            "message_length poll_interval_ms ready_timeout_ms silence_ms rounds",
            _row(covers, "the checksum covers the fill"),
        )  # fmt: skip

    def upload(self, files: Files) -> str:
        names = "initiate initiated begin packet checksum finalize finalized"
        keys = ("block_size", "poll_interval_ms", "erase_timeout_s", "finalize_timeout_ms", "rounds")
        numbers = [files.numbers.get(f"upload.{key}") for key in keys]
        rows = None if None in numbers else self.steps(files, "upload", names.split(), ())
        if rows is None:
            return "NULL"
        numbers[2] = (numbers[2] or 0) * 1000
        rest = [_row(f"{n}u", key.replace("timeout_s", "timeout_ms")) for n, key in zip(numbers, keys, strict=True)]
        rest.append(_row(_bool(bool(files.numbers.get("upload.checksum_covers_fill"))), "the checksum covers the fill"))
        return self.add("upload", "icd_upload_form_t", [*rows, *rest], self.section_notes("file_transfer.upload"))

    def erase(self, files: Files, part: str) -> str:
        return self.procedure(files, part, "icd_erase_form_t", "request progress", "poll_interval_ms timeout_ms")

    def identification(self) -> str:
        one = self.known.identification
        if one is None:
            return "NULL"
        return self.add("identification", "icd_step_t", [self.step("identification", one, braces=False)])


def crc_table(one: Crc) -> list[int]:
    """The register after each byte, begun with 0; bytes reflected already."""
    mask, table = (1 << one.width) - 1, []
    for byte in range(256):
        value = byte << (one.width - 8)
        for _ in range(8):
            value = (value << 1 & mask) ^ (one.polynomial if value >> (one.width - 1) else 0)
        table.append(value)
    return table


def _short(known: dict[int, Message]) -> dict[int, Message]:
    """Messages that can be told by an id of one byte."""
    return {id: m for id, m in known.items() if id <= _MOST_ID and m.length <= _MOST_LENGTH}


def _bool(value: bool) -> str:
    return "true" if value else "false"


def _or_none(value: int | None) -> str:
    return "-1" if value is None else str(value)


def _row(value: str, text: str) -> str:
    """``value, /* text */``; longer than a line: the comment before it."""
    line = f"{value}, /* {text} */" if text else f"{value},"
    if len(line) + 8 <= WIDTH:
        return line
    return "\n        ".join([f"/* {text} */", *_broken(f"{value},")] if text else _broken(f"{value},"))


def _broken(value: str) -> list[str]:
    """A long initialiser on several lines."""
    return _lines([f"{part}," for part in value.removesuffix(",").split(", ")])


def _wrapped(value: str, text: str) -> list[str]:
    line = f"{value} /* {text} */"
    return [line] if len(line) + 8 <= WIDTH else [comment([text], STEP * 2).lstrip().replace("/**", "/*", 1), value]


def _lines(items: Iterable[str]) -> list[str]:
    """The items, as many on a line as fit."""
    lines, line = [], ""
    for item in items:
        if line and len(line) + len(item) + 1 + 8 > WIDTH:
            lines.append(line)
            line = ""
        line += f" {item}" if line else item
    return [*lines, line] if line else lines
