"""The link of a node: its protocol facts as tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from icdgen.backends.c.facts import TYPES, boolean, or_none, spelled
from icdgen.backends.c.text import comment, plain
from icdgen.backends.lines import STEP, in_rows
from icdgen.describe.links import (
    CAN_PARTS,
    INDEX_PARTS,
    Assumptions,
    LinkDescription,
    SentMessage,
    StepDescription,
    byte_table,
)
from icdgen.protocol.declared import Kind, facts_of
from icdgen.protocol.envelope import CRC, PACKET, EnvelopeField, Stream, StreamRow
from icdgen.protocol.sections import BUSES, CAN_KINDS, PROCEDURES, Crc, Step

_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF
_MOST_PACKETS = 256
_CRC = f"/* width, polynomial, init, reflected in, out, xor out, whether there is one of no bytes, which, tables */\n{STEP * 2}"


class Table(NamedTuple):
    """A constant of the link."""

    comment: str
    type: str
    name: str
    rows: Sequence[str]
    unless: str = ""  # the macro that leaves it out


class Row(NamedTuple):
    """A value of an initialiser, and what it is; it is there only if a condition of the preprocessor holds."""

    value: str
    text: str = ""
    condition: str = ""

    def __str__(self) -> str:
        row = f"{self.value}, /* {self.text} */" if self.text else f"{self.value},"
        return f"#if {self.condition}\n{STEP * 2}{row}\n#endif" if self.condition else row


def sizes(link: LinkDescription) -> list[tuple[str, int, str]]:
    """Sizes of buffers: name, bytes, what it is."""
    known = link.facts
    if known.stream:
        return _stream_sizes(known.stream)
    rows = [("LONGEST", known.longest, "Bytes of the longest message of either direction, with id and checksum.")]
    slot = 1 + link.joined_bytes if known.can else 0
    if known.can:
        rows.append(("CAN_SLOT_BYTES", slot, "Bytes that joining CAN packets takes for each sender at once."))
    rows.append(("CLIENT_BYTES", known.longest_telecommand + max(slot, known.longest), "Bytes of a client's buffer."))
    if known.log_file and known.mask:
        most = max(known.mask.size + link.log_entry_bytes, known.log_file.header_bytes)
        rows.append(("LOG_BYTES", most, "Bytes of a log reader's buffer."))
    if known.files:
        packets = known.packets_of(known.files.block_bytes)
        rows.append(("BLOCK_BYTES", packets * known.files.packet_bytes, "Bytes of the largest block of a file."))
        rows.append(("BLOCK_BITMAP_BYTES", -(-packets // 8), "Bytes of a bit for each packet of such a block."))
    return rows


def _stream_sizes(form: Stream) -> list[tuple[str, int, str]]:
    """Those of a node whose messages have an envelope."""
    return [
        ("LONGEST", form.longest, "Bytes of a decoder's buffer: the longest message with its envelope."),
        ("LINE_BYTES", form.longest_line, "Most bytes of a message on the line."),
        ("SEQUENCES", form.sequences, "Numbers that a decoder remembers to notice gaps."),
        (
            "REQUEST_BYTES",
            form.longest_request,
            "Bytes of a client's buffer per request, in addition to the longest message.",
        ),
    ]


def tables(link: LinkDescription) -> list[Table]:
    """The tables of a node, in the order in which they are declared."""
    return _Tables(link).all()


class _Tables:
    """Each method gives the expression that leads to the table that it declares."""

    def __init__(self, link: LinkDescription) -> None:
        self.link, self.known, self.assumed = link, link.facts, Assumptions(link.facts)
        self.tables: list[Table] = []

    def all(self) -> list[Table]:
        """Those of the parts, then the link itself."""
        link, known = self.link, self.known
        telecommands, telemetry = _short(link.telecommands), _short(link.telemetry)
        codes = link.error_codes
        longest = f"{known.longest_telecommand}u, {known.longest_reply}u, {known.longest}u"
        settings = f"{{{self.values('client', known.client)}}}"
        rows = [
            Row(self.array("nodes", "char *const", (f'"{name}"' for name in known.owners)), "whose messages"),
            Row(f"{len(known.owners)}u", "how many"),
            Row(boolean(known.little), "byte order: little"),
            Row(boolean(known.node.bit_order == "msb0"), "bit 0 is the most significant one"),
            Row(f"{known.telemetry_ids.first}u, {known.telemetry_ids.last}u", "ids of telemetry"),
            Row(self.messages("telecommands", map(self.telecommand, telecommands)), "what can be sent"),
            Row(self.messages("telemetry", (self.message(one, "0u") for one in telemetry)), "what can be requested"),
            Row(_count("telecommands", telecommands), "how many can be sent"),
            Row(_count("telemetry", telemetry), "how many can be requested"),
            Row(longest, "longest telecommand, reply, any"),
            Row(f"{known.longest_data}u", "longest without id and checksum"),
            Row(or_none(known.node.node_type), "node type"),
            Row(or_none(known.node.interface_version), "interface version"),
            Row(settings, "ms for a reply, retries, ms between polls, ms of polling"),
            Row(self.array("errors", "icd_error_code_t", map(_error_code, codes)), "error codes"),
            Row(f"{len(codes)}u, {known.errors.get('none', 0)}u", "how many; no error"),
            Row(self.part("framing", known.framing, "uart.framing"), "framing of the UART"),
            Row(self.part("acknowledge", known.acknowledge, "uart.acknowledge"), "acknowledges on the UART"),
            Row(or_none(known.i2c_address), "I2C address"),
            Row(boolean(known.i2c_repeated_start), "I2C: a read may follow its write without a stop"),
            Row(or_none(known.boot_ms), "boot time in ms"),
            Row(self.named_step("polled", link.polled), "what is polled for an acknowledge"),
            Row(self.can(), "CAN"),
            Row(self.checksum(), "checksums of messages"),
            Row(self.crc16(), "CRC of files"),
            *self.optional("LOGS", self.logs()),
            *self.optional("FILES", self.of_files()),
            Row(self.named_step("identification", link.identification), "identification"),
            Row(self.stream(), "envelope"),
        ]
        others = (f"{key}: {why}" for section, key, why in self.assumed.others() if not section.startswith("message "))
        self.add("link", "icd_link_t", rows, map(plain, others))
        return self.tables

    def logs(self) -> Iterator[Row]:
        known = self.known
        yield Row(self.log_mask(), "mask of logs")
        yield Row(self.part("log_file", known.log_file, "telemetry_log"), "log files")
        yield Row(self.part("log_message", known.mask and known.log_message, "unsolicited_log"), "unsolicited logs")

    def of_files(self) -> Iterator[Row]:
        known = self.known
        yield Row(self.time(), "packed times")
        yield Row(self.index(), "index of files")
        yield Row(self.hole_map(), "hole map")
        yield Row(self.files(), "file transfer")
        yield from (Row(self.procedure(name), name) for name in PROCEDURES)
        yield Row(self.part("program_copy", known.program_copy, "program_copy"), "program copy")
        information = self.part("program_information", known.program_information, "program_information")
        yield Row(information, "program information")

    def optional(self, what: str, rows: Iterable[Row]) -> Iterator[Row]:
        """Rows that a program may do without, and so without their tables."""
        first = len(self.tables)
        for row in rows:
            yield row if row.value == "NULL" else row._replace(value=f"ICDGEN_OF_{what}({row.value})")
        self.tables[first:] = [table._replace(unless=f"ICDGEN_NO_{what}") for table in self.tables[first:]]

    def messages(self, name: str, rows: Iterable[Row]) -> str:
        """The messages of a direction. The last one is none, for a program may leave out all others, but no table is empty."""
        found = list(rows)
        return self.array(name, "icd_message_t", [*found, Row("{0u, 0u, 0u}", "the end")] if found else ())

    def message(self, one: SentMessage, flags: str) -> Row:
        """The row of a message."""
        conditions = []
        if not any(one.message is needed for needed in self.link.always_needed):
            node = self.known.node.name.upper()
            conditions = [f"!defined({node}_CHOSEN)", f"defined({node}_WITH_{self.link.name_of(one.message).upper()})"]
            if any(one.message is needed for needed in self.link.in_procedures):
                conditions.append("!defined(ICDGEN_NO_FILES)")
        return Row(f"{{{one.id}u, {flags}, {one.message.length}u}}", plain(one.message.name), " || ".join(conditions))

    def add(self, name: str, type: str, rows: Iterable[str | Row], assumed: Iterable[str] = ()) -> str:
        """Declares a table; above it stands what is assumed in it."""
        about = " ".join(f"Assumed {text}" for text in assumed)
        self.tables.append(Table(comment([about], STEP) if about else "", type, name, list(map(str, rows))))
        return f"&{name}"

    def array(self, name: str, type: str, rows: Iterable[str | Row]) -> str:
        """Declares an array, NULL if it is empty."""
        found = [row if isinstance(row, Row) else Row(row) for row in rows]
        return self.add(f"{name}[]", type, found).strip("&[]") if found else "NULL"

    def numbers(self, name: str, type: str, numbers: Iterable[str], count: int) -> str:
        """Declares an array of numbers, ``count`` a line; NULL if it is empty."""
        rows = in_rows(numbers, count)
        return self.add(f"{name}[]", type, rows).strip("&[]") if rows else "NULL"

    def part(self, name: str, part: object, section: str, *made: Row) -> str:
        """The table of a part: its facts, then the rows that code ``made``. NULL if there is no such part."""
        if part is None:
            return "NULL"
        return self.add(name, TYPES[type(part)], [*self.facts(name, part), *made], self.assumed_in(section))

    def assumed_in(self, section: str) -> list[str]:
        """What is assumed in a section, and why."""
        return [plain(f"{key}: {why}") for key, why in self.assumed.of_section(section)]

    def facts(self, name: str, part: object) -> list[Row]:
        """A row for each declared fact."""
        rows = []
        for fact in facts_of(part):
            value, text = getattr(part, fact.name), fact.name
            if isinstance(value, Step):
                step = self.step(f"{name}_{fact.name}", self.link.step(value))
                rows.append(Row(f"{{{step}}}", plain(value.message.name)))
            elif fact.kind is Kind.ALLOWED:
                allowed = self.numbers(f"{name}_{fact.name}", "uint8_t", (f"{number}u" for number in value), 16)
                rows.append(Row(f"{allowed}, {len(value)}u", text))
            else:
                rows.append(Row(spelled(fact, value), f"{text} in ms" if fact.kind is Kind.TIME else text))
        return rows

    def values(self, name: str, part: object) -> str:
        """The facts of a part as one row."""
        return ", ".join(row.value for row in self.facts(name, part))

    def step(self, name: str, step: StepDescription) -> str:
        """The initialiser of a step without its braces; its places and its fresh frame are tables of their own."""
        rows = [
            Row(f"{{ICD_ROLE_{role.upper()}, {field.model.at}u, {field.model.bits}u}}", plain(field.model.name))
            for role, field in step.places
        ]
        places = self.array(f"{name}_places", "icd_place_t", rows)
        fresh = "NULL"
        if any(step.initial_frame):
            fresh = self.numbers(f"{name}_fresh", "uint8_t", (f"{byte:#04x}u" for byte in step.initial_frame), 16)
        ids = f"{or_none(step.message.telecommand_id)}, {or_none(step.message.telemetry_id)}"
        return f"{ids}, {step.message.length}u, {len(rows)}u, {places}, {fresh}"

    def named_step(self, name: str, step: StepDescription | None) -> str:
        """A step by itself."""
        return self.add(name, "icd_step_t", [Row(self.step(name, step))]) if step else "NULL"

    def telecommand(self, one: SentMessage) -> Row:
        """The row of a telecommand, with what is assumed of it."""
        message = one.message
        flags = ["ICD_ACKNOWLEDGED"] if message.acknowledge else []
        flags += ["ICD_EXPECTS_RESET"] if message.expects_reset else []
        flags += ["ICD_SETTING"] if one.is_setting else []
        row = self.message(one, " | ".join(flags) or "0u")
        why = self.assumed.why(f"message {message.name}", "acknowledge")
        about = comment([f"Assumed acknowledge: {plain(why)}"], STEP * 2).lstrip().replace("/**", "/*", 1)
        return row._replace(value=f"{about}\n{STEP * 2}{row.value}") if why else row

    def can(self) -> str:
        can = self.link.can
        form = can and can.extended
        if can is None or (form and self.link.joined_bytes > _MOST_PACKETS * form.data_bytes):
            return "NULL"
        types, extended_types = (
            ", ".join(str(known.get(kind, -1)) for kind in CAN_KINDS) for known in (can.types, can.extended_types)
        )
        return self.part(
            "can",
            can,
            "can",
            *(
                Row(f"{{{can.parts[role].bits}u, {can.parts[role].shift}u}}", f"{role}: bits, shift")
                for role in CAN_PARTS
            ),
            Row(f"{{{types}}}", "types"),
            Row(f"{{{extended_types}}}", "types of messages of several packets"),
            Row(self.part("can_extended", form, "can.extended"), "messages of several packets"),
        )

    def crc(self, name: str, one: Crc, is_crc: bool = True) -> str:
        """The initialiser of a CRC without its braces; the table for whole bytes is one of its own."""
        found = ["NULL", "NULL"]
        if is_crc and one.width <= 16:
            entries = (f"{value:#0{2 + -(-one.width // 4)}x}u" for value in byte_table(one))
            bits = 8 if one.width <= 8 else 16
            found[bits // 8 - 1] = f"ICDGEN_TABLE({self.numbers(f'{name}_table', f'uint{bits}_t', entries, 8)})"
            self.tables[-1] = self.tables[-1]._replace(unless="ICDGEN_NO_TABLES")
        return ", ".join((self.values(name, one), *found))

    def checksum(self) -> str:
        one = self.known.checksum
        return self.part("checksum", one, "crc8", Row(f"{_CRC}{{{self.crc('crc8', one.crc)}}}")) if one else "NULL"

    def crc16(self) -> str:
        one = self.known.crc16
        return self.add("crc16", TYPES[Crc], [Row(f"{_CRC}{self.crc('crc16', one)}")]) if one else "NULL"

    def stream(self) -> str:
        form = self.known.stream
        if form is None:
            return "NULL"
        fields = self.array("envelope", "icd_envelope_field_t", map(_field, form.fields))
        check = "NULL"
        if form.check:
            crc = self.crc("check", form.check.crc, form.check.kind == CRC)
            row = Row(f"ICD_CHECK_{form.check.kind.upper()}, {{{crc}}}")
            covered = f"{form.check.covered_from}u, {form.check.covered_trailer}u, {boolean(form.check.is_seeded)}"
            check = self.add("check", "icd_check_form_t", [row, Row(covered, "covered")])
        both = (("sent", form.telecommands), ("received", form.telemetry))
        rows = [self.array(name, "icd_stream_row_t", map(_enveloped, found)) for name, found in both]
        delimiter = "packet" if form.delimited_by == PACKET else form.delimited_by
        sizes = f"ICD_DELIMITED_BY_{delimiter.upper()}, {form.header_bytes}u, {form.trailer_bytes}u"
        parts = [
            Row(sizes, "bytes of header, trailer"),
            Row(f"{form.length_plus}, {boolean(form.per_id)}", "length outside the data, a sequence for each id"),
            Row(f"{fields}, {len(form.fields)}u", "fields"),
            Row(check, "checksum"),
            Row(f"{{{rows[0]}, {rows[1]}}}, {{{len(form.telecommands)}u, {len(form.telemetry)}u}}", "messages"),
        ]
        return self.add("stream", "icd_stream_form_t", parts, self.assumed_in("stream"))

    def log_mask(self) -> str:
        mask = self.known.mask
        if mask is None:
            return "NULL"
        rows = []
        for bit in range(mask.size * 8):
            one = mask.bits.get(bit)
            id, length = (one.id, one.length) if one else (None, mask.slot_bytes)
            text = f"bit {bit}" + (f": {plain(one.name)}" if one and one.name else "")
            rows.append(Row(f"{{{or_none(id)}, {length}u}}", text))
        return self.part("log_mask", mask, "log_mask", Row(self.array("log_bits", "icd_log_bit_t", rows)))

    def time(self) -> str:
        rows = [Row(f"{{{one.at}u, {one.bits}u, {one.factor}u, {one.offset}u}}", name) for name, one in self.link.time]
        return self.add("packed_time", "icd_time_form_t", rows) if rows else "NULL"

    def index(self) -> str:
        form = self.link.index
        fields = [(name, form.fields[name]) for name in INDEX_PARTS] if form else []
        rows = (Row(f"{{{one.at}u, {one.bytes}u}}", name) for name, one in fields)
        return self.part("index_entry", form, "index_file", *rows)

    def hole_map(self) -> str:
        rows = []
        for field in self.link.map_pieces:
            message = field.message.model
            ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
            rows.append(Row(f"{{{ids}, {message.length}u, {field.model.at // 8}u}}", plain(message.name)))
        messages = self.array("hole_maps", "icd_hole_map_message_t", rows)
        made = Row(f"{len(rows)}u, {messages}", "messages")
        return self.part("hole_map", self.known.hole_map, "file_transfer.hole_map", made)

    def files(self) -> str:
        one = self.known.files
        ids = ", ".join(or_none(one.packet_ids.get(bus)) for bus in BUSES) if one else ""
        return self.part("files", one, "file_transfer", Row(f"{{{ids}}}", "ids of download packets"))

    def procedure(self, name: str) -> str:
        """A procedure of file transfer."""
        return self.part(name, getattr(self.known.files, name, None), f"file_transfer.{name}")


def _error_code(code: tuple[str, int]) -> str:
    return f"{{ICD_REASON_{code[0].upper()}, {code[1]}u}}"


def _field(one: EnvelopeField) -> Row:
    """A field of the envelope."""
    values = ", ".join(f"{value:#x}u" for value in one.values)
    numbers = f"{one.at}u, {one.size}u, {one.shift}u, {one.bits}u, {boolean(one.little)}, {{{values}}}"
    return Row(f"{{ICD_ENVELOPE_{one.role.upper()}, {boolean(one.in_trailer)}, {numbers}}}")


def _enveloped(row: StreamRow) -> Row:
    """A message in an envelope."""
    numbers = f"{row.id:#x}u, {row.least}u, {row.most}u, {boolean(row.cuts_zeros)}, {row.seed}u, "
    numbers += f"{boolean(row.reply is not None)}, {row.reply or 0:#x}u"
    return Row(f"{{{numbers}}}", plain(row.name))


def _short(messages: Iterable[SentMessage]) -> list[SentMessage]:
    """Messages that can be told by an id of one byte."""
    return [one for one in messages if one.id <= _MOST_ID and one.message.length <= _MOST_LENGTH]


def _count(name: str, messages: list[SentMessage]) -> str:
    return f"ICDGEN_U16((sizeof({name}) / sizeof({name}[0])) - 1u)" if messages else "0u"
