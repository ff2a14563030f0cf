"""Links: the protocol facts of a node as tables of the wire layer.

Input is the `LinkDescription` of a node; output are the tables of ``link.c``, in the
order of their declaration. Each row has the member order of a struct in the C runtime
(``runtime/c/wire``), which is initialised by position.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from icdgen.backends.c.facts import TableRow, boolean, or_none
from icdgen.backends.c.stream_rows import (
    content_name,
    field_row,
    message_row,
    number_place,
    only_id,
    stream_sizes,
    verdict_mask,
    verdict_name,
)
from icdgen.backends.c.tables import NODE_PREFIX, Table, TableSet, algorithm_table_name
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
from icdgen.frozen import NamedTuple
from icdgen.icd.buses import BUSES, CAN, UART
from icdgen.icd.responses import ID_BYTES
from icdgen.protocol.exchange import Exchange, NumberPlace, Response
from icdgen.protocol.packet_formats import CRC, DIRECTIONS, Escaping, Stream
from icdgen.protocol.sections import CAN_KINDS

_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF
_MOST_PACKETS = 256
_CRC = f"/* width, polynomial, init, reflected in, out, xor out, whether there is one of no bytes, which, tables */\n{STEP * 2}"


def buffer_sizes(link: LinkDescription) -> list[tuple[str, int, str]]:
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
    if facts.can:
        slot = _can_slot_bytes(link)
        rows.append(
            ("CAN_SLOT_BYTES", slot, "Buffer size in bytes of a CAN joiner, per slot.")
        )
    rows.append(
        (
            "CLIENT_BYTES",
            facts.longest_telecommand + received_bytes(link),
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


def received_bytes(link: LinkDescription) -> int:
    """Return the buffer size of a client for what it receives on any bus."""
    slot = _can_slot_bytes(link) if link.facts.can else 0
    return max(slot, link.facts.longest)


def _can_slot_bytes(link: LinkDescription) -> int:
    # The joiner stores the id of a message in front of its data.
    return 1 + link.joined_bytes


class LinkTable(NamedTuple):
    """Description of a protocol, or of its part on one bus, that a function returns."""

    function: str
    bus: str | None
    table: Table


class LinkCode(NamedTuple):
    """Links of a node, and the tables to which they refer in the order of their
    declaration.
    """

    tables: list[Table]
    links: list[LinkTable]


def link_code(link: LinkDescription, assumptions: Assumptions) -> LinkCode:
    """Return the links of a node, and their tables."""
    tables = _LinkTables(link, assumptions)
    links = tables.link_tables()
    return LinkCode(tables.tables, links)


class _LinkMember(NamedTuple):
    """Member of a link, which is absent in that of a bus where no client needs it."""

    value: str
    text: str
    buses: Collection[str] = BUSES
    absent: str = "NULL"

    def row_on(self, bus: str | None) -> TableRow:
        """Return the member in the link of a bus, or in that of the node (None)."""
        is_needed = bus is None or bus in self.buses
        return TableRow(self.value if is_needed else self.absent, self.text)


class _LinkTables(TableSet):
    """Tables of a node."""

    def __init__(self, link: LinkDescription, assumptions: Assumptions) -> None:
        super().__init__(link, assumptions, f"{NODE_PREFIX}{link.facts.node.name}_")

    def link_tables(self) -> list[LinkTable]:
        """Return the link of the node, and one for the clients on each bus: with these,
        the linker of a program can drop the tables of everything else.
        """
        self.declare_algorithms()
        exchanges = self.declare_bus_exchanges()
        before, after = self.members_before_exchanges(), self.members_after_exchanges()
        reasons = (
            (key, why)
            for section, key, why in self.assumptions.remaining()
            if not section.startswith("message ")
        )
        links = []
        for bus in (None, *self.link.buses):
            on = [each for each in BUSES if bus is None or bus == each]
            every = _in_lines(
                exchanges.get(each, "NULL") if each in on else "NULL" for each in BUSES
            )
            table = self.table_of_rows(
                "link",
                "icd_link_t",
                [
                    *(each.row_on(bus) for each in before),
                    TableRow(f"{{{every}}}", "exchanges on UART, I2C, CAN"),
                    *(each.row_on(bus) for each in after),
                ],
                reasons if bus is None else (),
            )
            links.append(LinkTable(f"{bus}_link" if bus else "link", bus, table))
        return links

    def members_before_exchanges(self) -> list[_LinkMember]:
        """Return the members of a link up to the exchanges. Members that small clients
        use come first: a processor reaches these with shorter instructions.
        """
        link, facts = self.link, self.facts
        telecommands = _storable_messages(link.telecommands)
        telemetry = _storable_messages(link.telemetry)
        telecommand = (
            facts.stream.longest_request if facts.stream else facts.longest_telecommand
        )
        longest = f"{telecommand}u, {facts.longest_reply}u, {facts.longest}u"
        nodes = (f'"{name}"' for name in facts.owners)
        sent = self.declare_messages(
            "telecommands", map(self.row_of_telecommand, telecommands)
        )
        requested = self.declare_messages(
            "telemetry", (self.row_of_message(sent, "0u") for sent in telemetry)
        )
        return [
            _LinkMember(
                self.declare_array("nodes", "char *const", nodes), "whose messages"
            ),
            _LinkMember(f"{len(facts.owners)}u", "how many"),
            _LinkMember(boolean(facts.little), "byte order: little"),
            _LinkMember(
                boolean(facts.node.bit_order == "msb0"),
                "bit 0 is the most significant one",
            ),
            _LinkMember(
                f"{facts.telemetry_ids.first}u, {facts.telemetry_ids.last}u",
                "ids of telemetry",
            ),
            _LinkMember(
                f"{len(link.reasons)}u",
                "how many codes of refusals",
                self.buses_with_refusals(),
                "0u",
            ),
            _LinkMember(
                f"{len(facts.unsolicited)}u", "how many unsolicited", {UART}, "0u"
            ),
            _LinkMember(_row_count(sent), "how many can be sent"),
            _LinkMember(_row_count(requested), "how many can be requested"),
            _LinkMember(sent, "what can be sent"),
            _LinkMember(requested, "what can be requested"),
            _LinkMember(longest, "longest telecommand, reply, any"),
            _LinkMember(f"{facts.longest_data}u", "longest without id and checksum"),
            _LinkMember(f"{received_bytes(link)}u", "buffer for what is received"),
            _LinkMember(self.declare_stream(), "framing", ()),
        ]

    def members_after_exchanges(self) -> list[_LinkMember]:
        """Return the members of a link after the exchanges."""
        link, facts = self.link, self.facts
        settings = f"{{{self.values_of_facts(facts.client)}}}"
        checked = {
            *(facts.checksum.telecommand_buses if facts.checksum else ()),
            *(facts.checksum.telemetry_buses if facts.checksum else ()),
        }
        codes = (f"{code}u" for code in link.reasons)
        packet = facts.acknowledge
        log_mask, log_file, log_message = self.optional_members(
            "LOGS", self.log_members()
        )
        return [
            _LinkMember(self.declare_checksum(), "checksums of messages", checked),
            _LinkMember(
                self.declare_numbers("reasons", "uint32_t", codes, 8),
                "codes of refusals",
                self.buses_with_refusals(),
            ),
            _LinkMember(
                self.declare_section("framing", facts.framing),
                "framing of the UART",
                {UART},
            ),
            _LinkMember(
                f"{packet.overhead if packet else 0}u",
                "bytes of an acknowledge",
                {UART},
                "0u",
            ),
            _LinkMember(self.declare_unsolicited(), "unsolicited", {UART}),
            log_message,
            _LinkMember(self.declare_can(), "CAN", {CAN}),
            _LinkMember(settings, "times and limits: icd_client_settings_t"),
            _LinkMember(or_none(facts.node.node_type), "node type"),
            _LinkMember(or_none(facts.node.interface_version), "interface version"),
            _LinkMember(or_none(facts.i2c_address), "I2C address"),
            _LinkMember(
                boolean(facts.i2c_repeated_start),
                "I2C: a read may follow its write without a stop",
            ),
            _LinkMember(or_none(facts.boot_ms), "boot time in ms"),
            log_mask,
            log_file,
            *self.optional_members("FILES", self.file_members()),
            _LinkMember(
                self.declare_report("identification", link.identification),
                "identification",
                (),
            ),
        ]

    def buses_with_refusals(self) -> list[str]:
        """Return the buses on which a refusal has an error code."""
        return [
            bus
            for bus, exchanges in self.facts.bus_exchanges.items()
            if exchanges.command
            and any(each.reason for each in exchanges.command.responses)
        ]

    def declare_unsolicited(self) -> str:
        telemetry = self.facts.telemetry
        return self.declare_array(
            "unsolicited",
            "icd_unsolicited_t",
            (
                TableRow(
                    f"{{{id}u, {contained}u, {telemetry[contained].length}u}}",
                    plain(telemetry[contained].name),
                )
                for id, contained in self.facts.unsolicited.items()
            ),
        )

    def log_members(self) -> Iterator[_LinkMember]:
        facts = self.facts
        yield _LinkMember(self.declare_log_mask(), "mask of logs", ())
        yield _LinkMember(
            self.declare_section("log_file", facts.log_file), "log files", ()
        )
        yield _LinkMember(self.declare_log_message(), "unsolicited logs", {UART})

    def file_members(self) -> Iterator[_LinkMember]:
        yield _LinkMember(self.declare_packed_time(), "packed times", ())
        yield _LinkMember(self.declare_index(), "index of files", ())

    def optional_members(
        self, what: str, parts: Iterable[_LinkMember]
    ) -> Iterator[_LinkMember]:
        """List members that a program can omit, together with their tables."""
        first = len(self.tables)
        for part in parts:
            # The macro becomes NULL if a program omits these tables, so that no member
            # refers to them.
            if part.value != "NULL":
                part = part._replace(value=f"ICDGEN_OF_{what}({part.value})")
            yield part
        self.tables[first:] = [
            table._replace(unless=f"ICDGEN_NO_{what}") for table in self.tables[first:]
        ]

    def declare_messages(self, name: str, rows: Iterable[TableRow]) -> str:
        """Return the messages of a direction.

        A last row of zeros is there because a program can omit all others.
        """
        messages = list(rows)
        return self.declare_array(
            name,
            "icd_message_t",
            [*messages, TableRow("{0u, 0u, 0u}", "the end")] if messages else (),
        )

    def row_of_message(self, sent: SentMessage, flags: str) -> TableRow:
        """Return the row of a message."""
        conditions = []
        if not any(sent.message is needed for needed in self.link.always_needed):
            # A program that defines `DEMO_CHOSEN` has only the messages that it
            # selects. Without it, all messages are there.
            node = self.facts.node.name.upper()
            conditions = [
                f"!defined({node}_CHOSEN)",
                f"defined({node}_WITH_{self.link.name_of(sent.message).upper()})",
            ]
            if any(sent.message is needed for needed in self.link.in_procedures):
                conditions.append("!defined(ICDGEN_NO_FILES)")
        return TableRow(
            f"{{{sent.id}u, {flags}, {sent.message.length}u}}",
            plain(sent.message.name),
            f" || \\\n{STEP * 2}".join(conditions),
        )

    def declare_report(self, name: str, report: ReportDescription | None) -> str:
        """Declare the table of telemetry that the link reads; its places are a table of
        their own.
        """
        if report is None:
            return "NULL"
        rows = [
            TableRow(
                f"{{ICD_ROLE_{role.upper()}, {field.model.at}u, {field.model.bits}u}}",
                plain(field.model.name),
            )
            for role, field in report.places
        ]
        places = self.declare_array(f"{name}_places", "icd_place_t", rows)
        message = report.message
        ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
        row = TableRow(f"{ids}, {message.length}u, {len(rows)}u, {places}")
        return self.declare(name, "icd_report_t", [row])

    def row_of_telecommand(self, sent: SentMessage) -> TableRow:
        """Return the row of a telecommand, with a comment on assumed facts."""
        message = sent.message
        flags = ["ICD_ACKNOWLEDGED"] if message.acknowledge else []
        flags += ["ICD_EXPECTS_RESET"] if message.expects_reset else []
        flags += ["ICD_SETTING"] if sent.is_setting else []
        row = self.row_of_message(sent, " | ".join(flags) or "0u")
        why = self.assumptions.why(f"message {message.name}", "acknowledge")
        about = (
            comment([f"Assumed acknowledge: {plain(why)}"], STEP * 2)
            .lstrip()
            .replace("/**", "/*", 1)
        )
        return row._replace(value=f"{about}\n{STEP * 2}{row.value}") if why else row

    def declare_can(self) -> str:
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
        return self.declare_section(
            "can",
            can,
            *(
                TableRow(
                    f"{{{can.parts[role].bits}u, {can.parts[role].shift}u}}",
                    f"{role}: bits, shift",
                )
                for role in CAN_PARTS
            ),
            TableRow(f"{{{types}}}", "types"),
            TableRow(f"{{{extended_types}}}", "types of messages of several packets"),
            TableRow(
                self.declare_section("can_extended", form),
                "messages of several packets",
            ),
        )

    def declare_checksum(self) -> str:
        checksum = self.facts.checksum
        if checksum is None:
            return "NULL"
        algorithm = TableRow(self.pointer_to_algorithm(checksum.algorithm), "algorithm")
        return self.declare_section("checksum", checksum, algorithm)

    def declare_algorithms(self) -> None:
        """Declare the algorithms of all checksums."""
        for each in self.facts.checksums.values():
            name = algorithm_table_name(each.name)
            crc = self.declare_crc(name, each.crc, each.kind == CRC)
            rows = [
                TableRow(f"ICD_CHECK_{each.kind.upper()}"),
                TableRow(f"{_CRC}{{{crc}}}"),
            ]
            self.declare(name, "icd_checksum_algorithm_t", rows)

    def declare_stream(self) -> str:
        form = self.facts.stream
        if form is None:
            return "NULL"
        packets = self.declare_array(
            "packets",
            "icd_packet_form_t",
            [self.row_of_packet(form, number) for number in range(len(form.packets))],
        )
        directions = (("sent", form.telecommands), ("received", form.telemetry))
        exchanges = self.declare_exchanges("exchanges", form.exchanges)
        rows = [
            self.declare_array(
                name,
                "icd_stream_row_t",
                [message_row(form, row, exchanges.get(row.exchange)) for row in rows],
            )
            for name, rows in directions
        ]
        confirming = self.declare_numbers(
            "confirming", "uint32_t", (f"{id:#x}u" for id in form.confirming), 8
        )
        request = "NULL"
        if form.request:
            exchange = exchanges[form.request.exchange]
            row = TableRow(f"{exchange}, {form.request.packet}u")
            request = self.declare("request", "icd_telemetry_request_t", [row])
        escaping = "NULL"
        if form.escaping:
            escaping = self.declare(
                "escaping", "icd_escaping_t", [TableRow(_escaping(form.escaping))]
            )
        around = (
            # -1 means that no packet has this direction. 0 is a packet without header
            # and trailer.
            max((packet.overhead for packet in form.packets_of(each)), default=-1)
            for each in DIRECTIONS
        )
        parts = [
            TableRow(
                f"ICD_DELIMITED_BY_{form.delimited_by.upper()}, {boolean(form.per_id)}",
                "a sequence for each id",
            ),
            TableRow(
                f"{len(form.packets)}u, {{{', '.join(map(str, around))}}}, {packets}",
                "packet formats",
            ),
            TableRow(
                f"{{{rows[0]}, {rows[1]}}}, {{{len(form.telecommands)}u, {len(form.telemetry)}u}}",
                "messages",
            ),
            TableRow(
                f"{len(form.confirming)}u, {confirming}", "telemetry that only responds"
            ),
            TableRow(request, "request of telemetry"),
            TableRow(escaping, "escape characters"),
        ]
        return self.declare(
            "stream", "icd_stream_form_t", parts, self.assumptions.of_section("link")
        )

    def row_of_packet(self, form: Stream, number: int) -> TableRow:
        """Return the row of a packet format; its fields and its checksum are separate
        tables.
        """
        packet = form.packets[number]
        suffix = f"_{number}" if len(form.packets) > 1 else ""
        fields = self.declare_array(
            f"fields{suffix}", "icd_packet_field_t", map(field_row, packet.fields)
        )
        check = "NULL"
        if packet.check:
            name, algorithm = f"check{suffix}", packet.check.algorithm
            row = TableRow(self.pointer_to_algorithm(algorithm), "algorithm")
            covered = f"{packet.check.covered_from}u, {packet.check.covered_trailer}u, {boolean(packet.check.is_seeded)}"
            check = self.declare(
                name, "icd_check_form_t", [row, TableRow(covered, "covered")]
            )
        sizes = (
            f"{len(packet.fields)}u, {packet.header_bytes}u, {packet.trailer_bytes}u"
        )
        # Without an id field, a decoder takes the id of the only message from here.
        has_id = packet.of("id") is not None
        ids = ", ".join(
            "0x0u" if has_id else f"{only_id(form, number, each):#x}u"
            for each in DIRECTIONS
        )
        sent = ", ".join(boolean(each in packet.directions) for each in DIRECTIONS)
        return TableRow(
            f"{{{{{ids}}}, {fields}, {check}, {sizes}, "
            f"ICD_PACKET_{content_name(packet).upper()}, {{{sent}}}, {packet.reserved}u}}",
            plain(packet.name),
        )

    def declare_bus_exchanges(self) -> dict[str, str]:
        """Declare the exchanges on each bus, and return the expressions that refer to
        them.
        """
        pointers = {}
        for bus, exchanges in self.facts.bus_exchanges.items():
            given = [exchanges.request, exchanges.command]
            declared = [each for each in given if each]
            names = self.declare_exchanges(f"{bus}_exchanges", declared)
            row = TableRow(
                ", ".join(names.get(each, "NULL") for each in reversed(given))
            )
            pointers[bus] = self.declare(f"on_{bus}", "icd_bus_exchanges_t", [row])
        return pointers

    def declare_exchanges(
        self, name: str, exchanges: Sequence[Exchange]
    ) -> dict[Exchange | None, str]:
        """Declare exchanges, and return the expression that refers to each."""
        rows = []
        for exchange in exchanges:
            sources = self.declare_once(
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
            responses = self.declare_once(
                "responses",
                "icd_response_t",
                map(self.initialiser_of_response, declared),
            )
            is_request = boolean(len(declared) < len(exchange.responses))
            counts = f"{len(exchange.sources)}u, {exchange.in_header}u, {len(declared)}u, {is_request}"
            poll = "NULL"
            if exchange.poll:
                until = number_place(exchange.poll.until, ID_BYTES)
                row = TableRow(f"{exchange.poll.telemetry}u, {until}")
                poll = self.declare("outcome_poll", "icd_outcome_poll_t", [row])
            rows.append(
                f"{{{sources}, {responses},\n{STEP * 3}{counts}, {exchange.timeout}u, {poll}}}"
            )
        table = self.declare_array(name, "icd_exchange_t", rows)
        return {
            exchange: f"&{table}[{number}]" for number, exchange in enumerate(exchanges)
        }

    def initialiser_of_response(self, response: Response) -> str:
        """Return the initialiser of a response; its echoes and meanings are separate
        tables.
        """
        echoes = self.declare_once(
            "echoes",
            "icd_echo_t",
            (
                f"{{{self.declare_place(echo.place)}, {echo.source}u}}"
                for echo in response.echoes
            ),
        )
        meanings = self.declare_once(
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
            f"{len(response.echoes)}u, {boolean(is_packet)}, {verdict_mask(response)}, {len(response.meanings)}u",
        )
        places = (
            self.declare_place(place)
            for place in (response.status, response.reason, response.detail)
        )
        lines = (", ".join(numbers), f"{echoes}, {meanings}", ", ".join(places))
        return f"{{{_in_lines(lines)}}}"

    def declare_place(self, place: NumberPlace | None) -> str:
        """Declare the position of a number in a frame; return NULL for None."""
        rows = [number_place(place, ID_BYTES)] if place else []
        return self.declare_once("place", "icd_number_place_t", rows)

    def declare_log_mask(self) -> str:
        mask = self.facts.mask
        if mask is None:
            return "NULL"
        rows = []
        for bit in range(mask.size * 8):
            row = mask.bits.get(bit)
            id, length = (row.id, row.length) if row else (None, mask.slot_bytes)
            text = f"bit {bit}" + (f": {plain(row.name)}" if row and row.name else "")
            rows.append(TableRow(f"{{{or_none(id)}, {length}u}}", text))
        return self.declare_section(
            "log_mask",
            mask,
            TableRow(self.declare_array("log_bits", "icd_log_bit_t", rows)),
        )

    def declare_log_message(self) -> str:
        mask = self.facts.mask
        if mask is None:
            return "NULL"
        sizes = TableRow(
            f"{mask.size}u, {mask.slot_bytes}u", "size of the mask, slot_bytes"
        )
        return self.declare_section("log_message", self.facts.log_message, sizes)

    def declare_packed_time(self) -> str:
        rows = [
            TableRow(
                f"{{{part.at}u, {part.bits}u, {part.factor}u, {part.offset}u}}", name
            )
            for name, part in self.link.time
        ]
        return self.declare("packed_time", "icd_time_form_t", rows) if rows else "NULL"

    def declare_index(self) -> str:
        form = self.link.index
        fields = [(name, form.fields[name]) for name in INDEX_PARTS] if form else []
        rows = (
            TableRow(f"{{{span.at}u, {span.bytes}u}}", name) for name, span in fields
        )
        return self.declare_section("index_entry", form, *rows)


def _in_lines(values: Iterable[str]) -> str:
    """Return values of a row with one of them per line."""
    return f",\n{STEP * 3}".join(values)


def _storable_messages(messages: Iterable[SentMessage]) -> list[SentMessage]:
    """Return the messages that the tables of the wire layer can store."""
    return [
        sent
        for sent in messages
        # `icd_message_t` stores the id in 8 bits and the length in 16.
        if sent.id <= _MOST_ID and sent.message.length <= _MOST_LENGTH
    ]


def _row_count(table: str) -> str:
    if table == "NULL":
        return "0u"
    return f"ICDGEN_ROWS({table})"


def _escaping(escaping: Escaping) -> str:
    start = escaping.start
    return (
        f"{escaping.escape:#04x}u, {start or 0:#04x}u, {escaping.end:#04x}u, {escaping.data:#04x}u,"
        f" {boolean(start is not None)}, {boolean(escaping.ignores_other)}"
    )
