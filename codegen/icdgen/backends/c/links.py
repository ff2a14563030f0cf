"""Links: the protocol facts of a node as tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from icdgen.backends.c.facts import TYPES, Row, boolean, or_none
from icdgen.backends.c.stream_rows import (
    field_row,
    message_row,
    number_place,
    only_id,
    stream_sizes,
    verdict_name,
)
from icdgen.backends.c.tables import Table, TableSet
from icdgen.backends.c.text import comment, plain
from icdgen.backends.lines import STEP
from icdgen.describe.links import (
    CAN_PARTS,
    INDEX_PARTS,
    Assumptions,
    LinkDescription,
    ReportDescription,
    SentMessage,
)
from icdgen.icd.responses import ID_BYTES
from icdgen.protocol.envelope import (
    CRC,
    DIRECTIONS,
    NOTHING,
    Escaping,
    Stream,
)
from icdgen.protocol.exchange import Exchange, Response
from icdgen.protocol.sections import BUSES, CAN_KINDS, Crc

_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF
_MOST_PACKETS = 256
_CRC = f"/* width, polynomial, init, reflected in, out, xor out, whether there is one of no bytes, which, tables */\n{STEP * 2}"


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
            "Buffer size in bytes of a client with one slot.",
        )
    )
    rows.append(
        (
            "REQUEST_BYTES",
            facts.longest_telecommand,
            "Size in bytes that each further slot adds to CLIENT_BYTES.",
        )
    )
    if facts.log_file and facts.mask:
        most = max(facts.mask.size + link.log_entry_bytes, facts.log_file.header_bytes)
        rows.append(("LOG_BYTES", most, "Buffer size of a log reader in bytes."))
    return rows


def tables(link: LinkDescription, assumed: Assumptions) -> list[Table]:
    """Return the tables of a node, in the order of their declaration."""
    return _Tables(link, assumed).all()


class _Tables(TableSet):
    """Tables of a node.

    Each method declares a table and returns the expression that refers to it.
    """

    def all(self) -> list[Table]:
        """Return the tables of the parts, then that of the link."""
        link, facts = self.link, self.facts_of_link
        telecommands, telemetry = _short(link.telecommands), _short(link.telemetry)
        codes = link.error_codes
        telecommand = (
            facts.stream.longest_request if facts.stream else facts.longest_telecommand
        )
        longest = f"{telecommand}u, {facts.longest_reply}u, {facts.longest}u"
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
            Row(f"{self.unsolicited()}, {len(facts.unsolicited)}u", "unsolicited"),
            Row(or_none(facts.i2c_address), "I2C address"),
            Row(
                boolean(facts.i2c_repeated_start),
                "I2C: a read may follow its write without a stop",
            ),
            Row(or_none(facts.boot_ms), "boot time in ms"),
            Row(self.can(), "CAN"),
            Row(self.checksum(), "checksums of messages"),
            Row(self.crc16(), "CRC of files"),
            *self.optional("LOGS", self.logs()),
            *self.optional("FILES", self.of_files()),
            Row(self.report("identification", link.identification), "identification"),
            Row(self.buses(), "exchanges on UART, I2C, CAN"),
            Row(self.stream(), "framing"),
        ]
        assumed = (
            (key, why)
            for section, key, why in self.assumed.others()
            if not section.startswith("message ")
        )
        self.add("link", "icd_link_t", rows, assumed)
        return self.tables

    def unsolicited(self) -> str:
        telemetry = self.facts_of_link.telemetry
        return self.array(
            "unsolicited",
            "icd_unsolicited_t",
            (
                Row(
                    f"{{{id}u, {contained}u, {telemetry[contained].length}u}}",
                    plain(telemetry[contained].name),
                )
                for id, contained in self.facts_of_link.unsolicited.items()
            ),
        )

    def logs(self) -> Iterator[Row]:
        facts = self.facts_of_link
        yield Row(self.log_mask(), "mask of logs")
        yield Row(self.part("log_file", facts.log_file), "log files")
        yield Row(
            self.part("log_message", facts.mask and facts.log_message),
            "unsolicited logs",
        )

    def of_files(self) -> Iterator[Row]:
        yield Row(self.time(), "packed times")
        yield Row(self.index(), "index of files")

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
            f" || \\\n{STEP}".join(conditions),
        )

    def report(self, name: str, report: ReportDescription | None) -> str:
        """Declare the table of telemetry that the link reads; its places are a table of
        their own.
        """
        if report is None:
            return "NULL"
        rows = [
            Row(
                f"{{ICD_ROLE_{role.upper()}, {field.model.at}u, {field.model.bits}u}}",
                plain(field.model.name),
            )
            for role, field in report.places
        ]
        places = self.array(f"{name}_places", "icd_place_t", rows)
        message = report.message
        ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
        row = Row(f"{ids}, {message.length}u, {len(rows)}u, {places}")
        return self.add(name, "icd_report_t", [row])

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

    def checksum(self) -> str:
        checksum = self.facts_of_link.checksum
        return (
            self.part(
                "checksum",
                checksum,
                Row(f"{_CRC}{{{self.crc('crc8', checksum.algorithm.crc)}}}"),
            )
            if checksum
            else "NULL"
        )

    def crc16(self) -> str:
        files = self.facts_of_link.checksums.get("crc16")
        return (
            self.add(
                "crc16", TYPES[Crc], [Row(f"{_CRC}{self.crc('crc16', files.crc)}")]
            )
            if files
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
        exchanges = self.exchanges("exchanges", form.exchanges)
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
            exchange = exchanges[form.request.exchange]
            row = Row(f"{exchange}, {form.request.packet}u")
            request = self.add("request", "icd_telemetry_request_t", [row])
        escaping = "NULL"
        if form.escaping:
            escaping = self.add(
                "escaping", "icd_escaping_t", [Row(_escaping(form.escaping))]
            )
        around = (
            max((packet.overhead for packet in form.packets_of(each)), default=-1)
            for each in DIRECTIONS
        )
        parts = [
            Row(
                f"ICD_DELIMITED_BY_{form.delimited_by.upper()}, {boolean(form.per_id)}",
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
            Row(escaping, "escape characters"),
        ]
        return self.add(
            "stream", "icd_stream_form_t", parts, self.assumed.of_section("link")
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
            name, algorithm = f"check{suffix}", packet.check.algorithm
            crc = self.crc(name, algorithm.crc, algorithm.kind == CRC)
            row = Row(f"ICD_CHECK_{algorithm.kind.upper()}, {{{crc}}}")
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

    def buses(self) -> str:
        """Return the initialiser of the exchanges on each bus."""
        rows = []
        for bus in BUSES:
            exchanges = self.facts_of_link.bus_exchanges.get(bus)
            if exchanges is None:
                rows.append("NULL")
                continue
            given = [exchanges.request, exchanges.command]
            declared = [each for each in given if each]
            names = self.exchanges(f"{bus}_exchanges", declared)
            row = Row(", ".join(names.get(each, "NULL") for each in reversed(given)))
            rows.append(self.add(f"on_{bus}", "icd_bus_exchanges_t", [row]))
        return f"{{{', '.join(rows)}}}"

    def exchanges(
        self, name: str, exchanges: Sequence[Exchange]
    ) -> dict[Exchange | None, str]:
        """Declare exchanges, and return the expression that refers to each."""
        rows = []
        for exchange in exchanges:
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
            poll = "NULL"
            if exchange.poll:
                until = number_place(exchange.poll.until, ID_BYTES)
                row = Row(f"{exchange.poll.telemetry}u, {until}")
                poll = self.add("outcome_poll", "icd_outcome_poll_t", [row])
            rows.append(
                f"{{{sources}, {responses}, {counts}, {exchange.timeout}u, {poll}}}"
            )
        self.array(name, "icd_exchange_t", rows)
        return {
            exchange: f"&{name}[{number}]" for number, exchange in enumerate(exchanges)
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
        )
        places = (
            number_place(place, ID_BYTES)
            for place in (response.status, response.reason, response.detail)
        )
        return f"{{{', '.join(numbers)},\n{STEP * 3}{', '.join(places)}}}"

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


def _escaping(escaping: Escaping) -> str:
    start = escaping.start
    return (
        f"{escaping.escape:#04x}u, {start or 0:#04x}u, {escaping.end:#04x}u, {escaping.data:#04x}u,"
        f" {boolean(start is not None)}, {boolean(escaping.ignores_other)}"
    )
