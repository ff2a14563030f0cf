"""Links: the protocol facts of a node as tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from icdgen.backends.c.facts import TYPES, Row, boolean, or_none, spelled
from icdgen.backends.c.stream_rows import (
    field_row,
    message_row,
    number_place,
    only_id,
    stream_sizes,
    verdict_name,
)
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
from icdgen.icd.responses import ID_BYTES
from icdgen.protocol.declared import Kind, facts_of
from icdgen.protocol.envelope import (
    CRC,
    DIRECTIONS,
    NOTHING,
    PACKET,
    Stream,
)
from icdgen.protocol.exchange import Exchange, Response
from icdgen.protocol.sections import BUSES, CAN_KINDS, PROCEDURES, Crc, Step

_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF
_MOST_PACKETS = 256
_CRC = f"/* width, polynomial, init, reflected in, out, xor out, whether there is one of no bytes, which, tables */\n{STEP * 2}"


class Table(NamedTuple):
    """Constant of the link."""

    comment: str
    type: str
    name: str
    rows: Sequence[str]
    unless: str = ""  # macro that omits the table


def sizes(link: LinkDescription) -> list[tuple[str, int, str]]:
    """Return the sizes of buffers: name, bytes and comment."""
    facts = link.facts
    if facts.stream:
        return stream_sizes(facts.stream)
    rows = [
        (
            "LONGEST",
            facts.longest,
            "Size in bytes of the longest message in either direction, with id and checksum.",
        )
    ]
    slot = 1 + link.joined_bytes if facts.can else 0
    if facts.can:
        rows.append(
            ("CAN_SLOT_BYTES", slot, "Buffer size in bytes of a CAN joiner, per slot.")
        )
    rows.append(
        (
            "CLIENT_BYTES",
            facts.longest_telecommand + max(slot, facts.longest),
            "Buffer size of a client in bytes.",
        )
    )
    if facts.log_file and facts.mask:
        most = max(facts.mask.size + link.log_entry_bytes, facts.log_file.header_bytes)
        rows.append(("LOG_BYTES", most, "Buffer size of a log reader in bytes."))
    if facts.files:
        packets = facts.packets_of(facts.files.block_bytes)
        rows.append(
            (
                "BLOCK_BYTES",
                packets * facts.files.packet_bytes,
                "Size in bytes of the largest block of a file.",
            )
        )
        rows.append(
            (
                "BLOCK_BITMAP_BYTES",
                -(-packets // 8),
                "Size in bytes of a bitmap for the packets of this block.",
            )
        )
    return rows


def tables(link: LinkDescription) -> list[Table]:
    """Return the tables of a node, in the order of their declaration."""
    return _Tables(link).all()


class _Tables:
    """Tables of a node.

    Each method declares a table and returns the expression that refers to it.
    """

    def __init__(self, link: LinkDescription) -> None:
        self.link, self.facts_of_link, self.assumed = (
            link,
            link.facts,
            Assumptions(link.facts),
        )
        self.tables: list[Table] = []
        self._shared: dict[tuple[str, tuple[str, ...]], str] = {}

    def all(self) -> list[Table]:
        """Return the tables of the parts, then that of the link."""
        link, facts = self.link, self.facts_of_link
        telecommands, telemetry = _short(link.telecommands), _short(link.telemetry)
        codes = link.error_codes
        longest = (
            f"{facts.longest_telecommand}u, {facts.longest_reply}u, {facts.longest}u"
        )
        settings = f"{{{self.values('client', facts.client)}}}"
        rows = [
            Row(
                self.array(
                    "nodes", "char *const", (f'"{name}"' for name in facts.owners)
                ),
                "whose messages",
            ),
            Row(f"{len(facts.owners)}u", "how many"),
            Row(boolean(facts.little), "byte order: little"),
            Row(
                boolean(facts.node.bit_order == "msb0"),
                "bit 0 is the most significant one",
            ),
            Row(
                f"{facts.telemetry_ids.first}u, {facts.telemetry_ids.last}u",
                "ids of telemetry",
            ),
            Row(
                self.messages("telecommands", map(self.telecommand, telecommands)),
                "what can be sent",
            ),
            Row(
                self.messages(
                    "telemetry", (self.message(sent, "0u") for sent in telemetry)
                ),
                "what can be requested",
            ),
            Row(_count("telecommands", telecommands), "how many can be sent"),
            Row(_count("telemetry", telemetry), "how many can be requested"),
            Row(longest, "longest telecommand, reply, any"),
            Row(f"{facts.longest_data}u", "longest without id and checksum"),
            Row(or_none(facts.node.node_type), "node type"),
            Row(or_none(facts.node.interface_version), "interface version"),
            Row(settings, "times and limits: icd_client_settings_t"),
            Row(
                self.array("errors", "icd_error_code_t", map(_error_code, codes)),
                "error codes",
            ),
            Row(f"{len(codes)}u, {facts.errors.get('none', 0)}u", "how many; no error"),
            Row(self.part("framing", facts.framing), "framing of the UART"),
            Row(
                self.part("acknowledge", facts.acknowledge), "acknowledges on the UART"
            ),
            Row(or_none(facts.i2c_address), "I2C address"),
            Row(
                boolean(facts.i2c_repeated_start),
                "I2C: a read may follow its write without a stop",
            ),
            Row(or_none(facts.boot_ms), "boot time in ms"),
            Row(
                self.named_step("polled", link.polled),
                "what is polled for an acknowledge",
            ),
            Row(self.can(), "CAN"),
            Row(self.checksum(), "checksums of messages"),
            Row(self.crc16(), "CRC of files"),
            *self.optional("LOGS", self.logs()),
            *self.optional("FILES", self.of_files()),
            Row(
                self.named_step("identification", link.identification), "identification"
            ),
            Row(self.stream(), "envelope"),
        ]
        assumed = (
            (key, why)
            for section, key, why in self.assumed.others()
            if not section.startswith("message ")
        )
        self.add("link", "icd_link_t", rows, assumed)
        return self.tables

    def logs(self) -> Iterator[Row]:
        facts = self.facts_of_link
        yield Row(self.log_mask(), "mask of logs")
        yield Row(self.part("log_file", facts.log_file), "log files")
        yield Row(
            self.part("log_message", facts.mask and facts.log_message),
            "unsolicited logs",
        )

    def of_files(self) -> Iterator[Row]:
        facts = self.facts_of_link
        yield Row(self.time(), "packed times")
        yield Row(self.index(), "index of files")
        yield Row(self.hole_map(), "hole map")
        yield Row(self.files(), "file transfer")
        yield from (Row(self.procedure(name), name) for name in PROCEDURES)
        yield Row(self.part("program_copy", facts.program_copy), "program copy")
        information = self.part("program_information", facts.program_information)
        yield Row(information, "program information")

    def optional(self, what: str, rows: Iterable[Row]) -> Iterator[Row]:
        """List rows that a program can omit, together with their tables."""
        first = len(self.tables)
        for row in rows:
            yield (
                row
                if row.value == "NULL"
                else row._replace(value=f"ICDGEN_OF_{what}({row.value})")
            )
        self.tables[first:] = [
            table._replace(unless=f"ICDGEN_NO_{what}") for table in self.tables[first:]
        ]

    def messages(self, name: str, rows: Iterable[Row]) -> str:
        """Return the messages of a direction.

        A last row of zeros is there because a program can omit all others.
        """
        messages = list(rows)
        return self.array(
            name,
            "icd_message_t",
            [*messages, Row("{0u, 0u, 0u}", "the end")] if messages else (),
        )

    def message(self, sent: SentMessage, flags: str) -> Row:
        """Return the row of a message."""
        conditions = []
        if not any(sent.message is needed for needed in self.link.always_needed):
            node = self.facts_of_link.node.name.upper()
            conditions = [
                f"!defined({node}_CHOSEN)",
                f"defined({node}_WITH_{self.link.name_of(sent.message).upper()})",
            ]
            if any(sent.message is needed for needed in self.link.in_procedures):
                conditions.append("!defined(ICDGEN_NO_FILES)")
        return Row(
            f"{{{sent.id}u, {flags}, {sent.message.length}u}}",
            plain(sent.message.name),
            " || ".join(conditions),
        )

    def add(
        self,
        name: str,
        type: str,
        rows: Iterable[str | Row],
        assumed: Iterable[tuple[str, str]] = (),
    ) -> str:
        """Declare a table, with a comment on assumed facts: their keys and reasons."""
        about = " ".join(f"Assumed {plain(f'{key}: {why}')}" for key, why in assumed)
        self.tables.append(
            Table(
                comment([about], STEP) if about else "",
                type,
                name,
                list(map(str, rows)),
            )
        )
        return f"&{name}"

    def array(self, name: str, type: str, rows: Iterable[str | Row]) -> str:
        """Declare an array; return NULL if it is empty."""
        items = [row if isinstance(row, Row) else Row(row) for row in rows]
        return self.add(f"{name}[]", type, items).strip("&[]") if items else "NULL"

    def numbers(self, name: str, type: str, numbers: Iterable[str], count: int) -> str:
        """Declare an array of numbers, ``count`` per line; return NULL if it is empty."""
        rows = in_rows(numbers, count)
        return self.add(f"{name}[]", type, rows).strip("&[]") if rows else "NULL"

    def part(self, name: str, part: object, *further: Row) -> str:
        """Declare the table of a part: its facts, then further rows.

        Return NULL for None.
        """
        if part is None:
            return "NULL"
        return self.add(
            name,
            TYPES[type(part)],
            [*self.facts(name, part), *further],
            self.assumed.of_part(part),
        )

    def facts(self, name: str, part: object) -> list[Row]:
        """Return a row for each declared fact."""
        rows = []
        for fact in facts_of(part):
            value, text = getattr(part, fact.name), fact.name
            if isinstance(value, Step):
                step = self.step(f"{name}_{fact.name}", self.link.step(value))
                rows.append(Row(f"{{{step}}}", plain(value.message.name)))
            elif fact.kind is Kind.ALLOWED:
                allowed = self.numbers(
                    f"{name}_{fact.name}",
                    "uint8_t",
                    (f"{number}u" for number in value),
                    16,
                )
                rows.append(Row(f"{allowed}, {len(value)}u", text))
            else:
                rows.append(
                    Row(
                        spelled(fact, value),
                        f"{text} in ms" if fact.kind is Kind.TIME else text,
                    )
                )
        return rows

    def values(self, name: str, part: object) -> str:
        """Return the facts of a part as one row."""
        return ", ".join(row.value for row in self.facts(name, part))

    def step(self, name: str, step: StepDescription) -> str:
        """Return the initialiser of a step without braces; its places and its initial
        frame are separate tables.
        """
        rows = [
            Row(
                f"{{ICD_ROLE_{role.upper()}, {field.model.at}u, {field.model.bits}u}}",
                plain(field.model.name),
            )
            for role, field in step.places
        ]
        places = self.array(f"{name}_places", "icd_place_t", rows)
        initial_frame = "NULL"
        if any(step.initial_frame):
            initial_frame = self.numbers(
                f"{name}_fresh",
                "uint8_t",
                (f"{byte:#04x}u" for byte in step.initial_frame),
                16,
            )
        ids = f"{or_none(step.message.telecommand_id)}, {or_none(step.message.telemetry_id)}"
        return f"{ids}, {step.message.length}u, {len(rows)}u, {places}, {initial_frame}"

    def named_step(self, name: str, step: StepDescription | None) -> str:
        """Declare the table of a single step."""
        return (
            self.add(name, "icd_step_t", [Row(self.step(name, step))])
            if step
            else "NULL"
        )

    def telecommand(self, sent: SentMessage) -> Row:
        """Return the row of a telecommand, with a comment on assumed facts."""
        message = sent.message
        flags = ["ICD_ACKNOWLEDGED"] if message.acknowledge else []
        flags += ["ICD_EXPECTS_RESET"] if message.expects_reset else []
        flags += ["ICD_SETTING"] if sent.is_setting else []
        row = self.message(sent, " | ".join(flags) or "0u")
        why = self.assumed.why(f"message {message.name}", "acknowledge")
        about = (
            comment([f"Assumed acknowledge: {plain(why)}"], STEP * 2)
            .lstrip()
            .replace("/**", "/*", 1)
        )
        return row._replace(value=f"{about}\n{STEP * 2}{row.value}") if why else row

    def can(self) -> str:
        can = self.link.can
        form = can and can.extended
        if can is None or (
            form and self.link.joined_bytes > _MOST_PACKETS * form.data_bytes
        ):
            return "NULL"
        types, extended_types = (
            ", ".join(str(values.get(kind, -1)) for kind in CAN_KINDS)
            for values in (can.types, can.extended_types)
        )
        return self.part(
            "can",
            can,
            *(
                Row(
                    f"{{{can.parts[role].bits}u, {can.parts[role].shift}u}}",
                    f"{role}: bits, shift",
                )
                for role in CAN_PARTS
            ),
            Row(f"{{{types}}}", "types"),
            Row(f"{{{extended_types}}}", "types of messages of several packets"),
            Row(self.part("can_extended", form), "messages of several packets"),
        )

    def crc(self, name: str, parameters: Crc, is_crc: bool = True) -> str:
        """Return the initialiser of a CRC without braces; the table for whole bytes is
        separate.
        """
        tables = ["NULL", "NULL"]
        if is_crc and parameters.width <= 16:
            entries = (
                f"{value:#0{2 + -(-parameters.width // 4)}x}u"
                for value in byte_table(parameters)
            )
            bits = 8 if parameters.width <= 8 else 16
            tables[bits // 8 - 1] = (
                f"ICDGEN_TABLE({self.numbers(f'{name}_table', f'uint{bits}_t', entries, 8)})"
            )
            self.tables[-1] = self.tables[-1]._replace(unless="ICDGEN_NO_TABLES")
        return ", ".join((self.values(name, parameters), *tables))

    def checksum(self) -> str:
        checksum = self.facts_of_link.checksum
        return (
            self.part(
                "checksum", checksum, Row(f"{_CRC}{{{self.crc('crc8', checksum.crc)}}}")
            )
            if checksum
            else "NULL"
        )

    def crc16(self) -> str:
        crc = self.facts_of_link.crc16
        return (
            self.add("crc16", TYPES[Crc], [Row(f"{_CRC}{self.crc('crc16', crc)}")])
            if crc
            else "NULL"
        )

    def stream(self) -> str:
        form = self.facts_of_link.stream
        if form is None:
            return "NULL"
        packets = self.array(
            "packets",
            "icd_packet_form_t",
            [self.packet(form, number) for number in range(len(form.packets))],
        )
        directions = (("sent", form.telecommands), ("received", form.telemetry))
        exchanges = self.exchanges(form)
        rows = [
            self.array(
                name,
                "icd_stream_row_t",
                [message_row(form, row, exchanges.get(row.exchange)) for row in rows],
            )
            for name, rows in directions
        ]
        confirming = self.numbers(
            "confirming", "uint32_t", (f"{id:#x}u" for id in form.confirming), 8
        )
        request = "NULL"
        if form.request:
            zeros = ("0u" for _ in range(form.packets[form.request.packet].reserved))
            data = self.numbers("reserved", "uint8_t", zeros, 16)
            exchange = exchanges[form.request.exchange]
            row = Row(f"{exchange}, {data}, {form.request.packet}u")
            request = self.add("request", "icd_telemetry_request_t", [row])
        delimiter = "packet" if form.delimited_by == PACKET else form.delimited_by
        around = (
            max((packet.overhead for packet in form.packets_of(each)), default=-1)
            for each in DIRECTIONS
        )
        parts = [
            Row(
                f"ICD_DELIMITED_BY_{delimiter.upper()}, {boolean(form.per_id)}",
                "a sequence for each id",
            ),
            Row(
                f"{len(form.packets)}u, {{{', '.join(map(str, around))}}}, {packets}",
                "packet formats",
            ),
            Row(
                f"{{{rows[0]}, {rows[1]}}}, {{{len(form.telecommands)}u, {len(form.telemetry)}u}}",
                "messages",
            ),
            Row(
                f"{len(form.confirming)}u, {confirming}",
                "telemetry that only responds",
            ),
            Row(request, "request of telemetry"),
        ]
        return self.add(
            "stream", "icd_stream_form_t", parts, self.assumed.of_section("stream")
        )

    def packet(self, form: Stream, number: int) -> Row:
        """Return the row of a packet format; its fields and its checksum are separate
        tables.
        """
        packet = form.packets[number]
        suffix = f"_{number}" if len(form.packets) > 1 else ""
        fields = self.array(
            f"envelope{suffix}", "icd_envelope_field_t", map(field_row, packet.fields)
        )
        check = "NULL"
        if packet.check:
            name = f"check{suffix}"
            crc = self.crc(name, packet.check.crc, packet.check.kind == CRC)
            row = Row(f"ICD_CHECK_{packet.check.kind.upper()}, {{{crc}}}")
            covered = f"{packet.check.covered_from}u, {packet.check.covered_trailer}u, {boolean(packet.check.is_seeded)}"
            check = self.add(name, "icd_check_form_t", [row, Row(covered, "covered")])
        sizes = (
            f"{len(packet.fields)}u, {packet.header_bytes}u, {packet.trailer_bytes}u"
        )
        content = "NOTHING" if packet.content == NOTHING else packet.content.upper()
        # Without an id field, a decoder takes the id of the only message from here.
        has_id = packet.of("id") is not None
        ids = ", ".join(
            "0x0u" if has_id else f"{only_id(form, number, each):#x}u"
            for each in DIRECTIONS
        )
        sent = ", ".join(boolean(each in packet.directions) for each in DIRECTIONS)
        return Row(
            f"{{{{{ids}}}, {fields}, {check}, {sizes}, "
            f"ICD_PACKET_{content}, {{{sent}}}, {packet.reserved}u}}",
            plain(packet.name),
        )

    def exchanges(self, form: Stream) -> dict[Exchange | None, str]:
        """Declare the exchanges, and return the expression that refers to each."""
        rows = []
        for exchange in form.exchanges:
            sources = self.shared(
                "sources",
                "icd_number_place_t",
                (
                    number_place(place, ID_BYTES * exchange.is_in_header(source))
                    for source, place in enumerate(exchange.sources)
                ),
            )
            # The requested telemetry, whose id is that of the request, has no row.
            declared = [
                each
                for each in exchange.responses
                if each.telemetry is not None or each.packet is not None
            ]
            responses = self.shared(
                "responses", "icd_response_t", map(self.response, declared)
            )
            is_request = boolean(len(declared) < len(exchange.responses))
            counts = f"{len(exchange.sources)}u, {exchange.in_header}u, {len(declared)}u, {is_request}"
            rows.append(f"{{{sources}, {responses}, {counts}, {exchange.timeout}u}}")
        self.array("exchanges", "icd_exchange_t", rows)
        return {
            exchange: f"&exchanges[{number}]"
            for number, exchange in enumerate(form.exchanges)
        }

    def response(self, response: Response) -> str:
        """Return the initialiser of a response; its echoes and meanings are separate
        tables.
        """
        echoes = self.shared(
            "echoes",
            "icd_echo_t",
            (
                f"{{{number_place(echo.place, ID_BYTES)}, {echo.source}u}}"
                for echo in response.echoes
            ),
        )
        meanings = self.shared(
            "meanings",
            "icd_meaning_t",
            (
                f"{{{value:#x}u, {verdict_name(verdict)}}}"
                for value, verdict in response.meanings
            ),
        )
        is_packet = response.packet is not None
        source = response.packet if is_packet else response.telemetry
        numbers = (
            f"{source:#x}u, {verdict_name(response.verdict)}",
            f"{len(response.echoes)}u, {boolean(is_packet)}, {len(response.meanings)}u",
            f"{echoes}, {meanings}",
            number_place(response.status, ID_BYTES),
            number_place(response.reason, ID_BYTES),
        )
        return f"{{{', '.join(numbers)}}}"

    def shared(self, name: str, type: str, rows: Iterable[str]) -> str:
        """Declare an array with a number in its name, unless an array of these rows is
        declared; return NULL if it is empty.
        """
        items = tuple(rows)
        number = len([other for other, _ in self._shared if other == name])
        if items and (name, items) not in self._shared:
            self._shared[name, items] = self.array(f"{name}_{number}", type, items)
        return self._shared.get((name, items), "NULL")

    def log_mask(self) -> str:
        mask = self.facts_of_link.mask
        if mask is None:
            return "NULL"
        rows = []
        for bit in range(mask.size * 8):
            row = mask.bits.get(bit)
            id, length = (row.id, row.length) if row else (None, mask.slot_bytes)
            text = f"bit {bit}" + (f": {plain(row.name)}" if row and row.name else "")
            rows.append(Row(f"{{{or_none(id)}, {length}u}}", text))
        return self.part(
            "log_mask", mask, Row(self.array("log_bits", "icd_log_bit_t", rows))
        )

    def time(self) -> str:
        rows = [
            Row(f"{{{part.at}u, {part.bits}u, {part.factor}u, {part.offset}u}}", name)
            for name, part in self.link.time
        ]
        return self.add("packed_time", "icd_time_form_t", rows) if rows else "NULL"

    def index(self) -> str:
        form = self.link.index
        fields = [(name, form.fields[name]) for name in INDEX_PARTS] if form else []
        rows = (Row(f"{{{span.at}u, {span.bytes}u}}", name) for name, span in fields)
        return self.part("index_entry", form, *rows)

    def hole_map(self) -> str:
        rows = []
        for field in self.link.map_pieces:
            message = field.message.model
            ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
            rows.append(
                Row(
                    f"{{{ids}, {message.length}u, {field.model.at // 8}u}}",
                    plain(message.name),
                )
            )
        messages = self.array("hole_maps", "icd_hole_map_message_t", rows)
        further = Row(f"{len(rows)}u, {messages}", "messages")
        return self.part("hole_map", self.facts_of_link.hole_map, further)

    def files(self) -> str:
        files = self.facts_of_link.files
        ids = (
            ", ".join(or_none(files.packet_ids.get(bus)) for bus in BUSES)
            if files
            else ""
        )
        return self.part("files", files, Row(f"{{{ids}}}", "ids of download packets"))

    def procedure(self, name: str) -> str:
        """Declare the table of a procedure of file transfer."""
        return self.part(name, getattr(self.facts_of_link.files, name, None))


def _error_code(code: tuple[str, int]) -> str:
    return f"{{ICD_REASON_{code[0].upper()}, {code[1]}u}}"


def _short(messages: Iterable[SentMessage]) -> list[SentMessage]:
    """Return the messages that the tables of the wire layer can store."""
    return [
        sent
        for sent in messages
        if sent.id <= _MOST_ID and sent.message.length <= _MOST_LENGTH
    ]


def _count(name: str, messages: list[SentMessage]) -> str:
    return (
        f"ICDGEN_U16((sizeof({name}) / sizeof({name}[0])) - 1u)" if messages else "0u"
    )
