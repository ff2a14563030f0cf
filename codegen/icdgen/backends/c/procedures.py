"""Procedures: their steps as tables of the wire layer, and the typed functions that
initialize them.

`ProcedureCode` has what the template ``procedures.h.j2`` needs; `_ProcedureTables`
returns the tables that the engine of the wire layer runs. Rows have the member order of
structs in ``runtime/c/wire``.
"""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.c.facts import TableRow, boolean
from icdgen.backends.c.names import (
    PROCEDURE_PARAMETERS,
    input_parameters,
    procedure,
    procedure_size,
)
from icdgen.backends.c.stream_rows import number_place
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.tables import Table, TableSet
from icdgen.backends.c.text import plain
from icdgen.describe.links import Assumptions, LinkDescription
from icdgen.describe.nodes import Description, NodeDescription
from icdgen.describe.procedures import input_text, procedure_text
from icdgen.describe.storage import storage_bits
from icdgen.frozen import NamedTuple
from icdgen.icd.buses import BUSES
from icdgen.icd.model import Enum
from icdgen.icd.procedures import FIXED_NAMES
from icdgen.icd.responses import ID_BYTES
from icdgen.protocol.procedures import (
    Blocks,
    Collect,
    EndIfZeros,
    Get,
    GetMap,
    Input,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    PacketDone,
    Poll,
    Procedure,
    Receive,
    Send,
    SendMap,
    SetLength,
    SkipUnless,
    Step,
    Test,
    Value,
    Verify,
    VerifyChecksum,
)

# A request is a poll without conditions.
_KINDS: dict[type, str] = {
    Send: "SEND", Get: "POLL", Poll: "POLL", NextBlock: "NEXT_BLOCK", SetLength: "SET_LENGTH", NextRound: "NEXT_ROUND",
    NextPacket: "NEXT_PACKET", PacketDone: "PACKET_DONE", SendMap: "SEND_MAP", GetMap: "GET_MAP", Receive: "RECEIVE",
    VerifyChecksum: "VERIFY_CRC", Verify: "VERIFY", Collect: "COLLECT", EndIfZeros: "END_IF_ZEROS",
    SkipUnless: "SKIP_UNLESS", Jump: "JUMP",
}  # fmt: skip


class ProcedureSizes(NamedTuple):
    """Sizes of the memory of the procedures of all nodes."""

    step_bytes: int
    registers: int


def procedure_sizes(links: Iterable[LinkDescription]) -> ProcedureSizes:
    """Return the longest message and the largest number of registers."""
    procedures = [each for link in links for each in link.facts.procedures]
    lengths = (message.length for each in procedures for message in each.messages)
    # The runtime has an array of registers even without procedures, and C has no arrays
    # without elements (C99 6.7.5.2).
    registers = [each.registers for each in procedures] + [len(FIXED_NAMES)]
    return ProcedureSizes(max(lengths, default=1), max(registers))


class OutputFunction(NamedTuple):
    """Function that returns an output of a procedure."""

    name: str
    type: str
    value: str
    about: str


class ProcedureCode:
    """Code of a procedure of a node."""

    def __init__(
        self,
        node: NodeDescription,
        link: LinkDescription,
        model: Procedure,
        assumptions: Assumptions,
    ) -> None:
        self.node, self.link, self.procedure = node, link, model
        self._description: Description = link.description
        self.tables = _ProcedureTables(link, assumptions).declare_procedure(model)

    @property
    def name(self) -> str:
        """Name of the function that initializes the procedure."""
        return procedure(self.node, self.procedure.name)

    @property
    def form(self) -> str:
        """Name of the function that returns its steps."""
        return procedure(self.node, self.procedure.name, "form")

    @property
    def receives(self) -> bool:
        """Whether it receives blocks."""
        return self.procedure.blocks is not None and not self.procedure.blocks.sends

    @property
    def needs_bus(self) -> bool:
        """Whether its requests depend on the bus."""
        return not self.link.facts.stream and any(
            isinstance(step, Receive) and step.requested_on
            for step in self.procedure.steps
        )

    @property
    def numbers(self) -> list[str]:
        """Expressions of the inputs that are numbers."""
        return [
            f"{each.name} ? 1u : 0u" if each.is_flag else f"ICDGEN_U32({each.name})"
            for each in self.procedure.numbers
        ]

    @property
    def wide_numbers(self) -> list[str]:
        """Names of the inputs whose type has more than the 32 bits of an input."""
        return [
            each.name
            for each in self.procedure.numbers
            if each.enum and self._description.enum(each.enum).storage.bits > 32
        ]

    @property
    def parameters(self) -> list[str]:
        """Parameters of the function, with their types."""
        parameters = [_fixed_parameter("procedure")]
        parameters += [_fixed_parameter("bus")] if self.needs_bus else []
        for each in self.procedure.inputs:
            names = input_parameters(each.name, each.is_bytes)
            types = (
                ("const uint8_t *", "size_t ")
                if each.is_bytes
                else (f"{self.type_of(each)} ",)
            )
            parameters += map("".join, zip(types, names, strict=True))
        return parameters + list(map(_fixed_parameter, self.memory_names))

    @property
    def memory_names(self) -> list[str]:
        """Names of the parameters for memory and callbacks."""
        names = []
        if self.procedure.blocks:
            names.append("block_size")
            names += ["buffer", "buffer_size"] if self.receives else []
            names += ["bitmap", "bitmap_size"]
        names += ["on_block"] if self.receives else []
        names += ["on_entry"] if self.procedure.entry else []
        return [*names, *(["context"] if self.receives or self.procedure.entry else [])]

    @property
    def members(self) -> list[tuple[str, str]]:
        """Members of the memory of a procedure, and their values."""
        rows = [("block" if n == "block_size" else n, n) for n in self.memory_names]
        if self.procedure.content:
            given = input_parameters(self.procedure.content.name, True)
            rows = [*zip(("bytes", "byte_count"), given, strict=True), *rows]
        return rows

    @property
    def paragraphs(self) -> list[str]:
        """Comment of the function."""
        model = self.procedure
        paragraphs = [
            f"Initialize the procedure `{model.name}`. {procedure_text(model)}".strip()
        ]
        paragraphs += map(self._about, model.inputs)
        if model.blocks:
            size = model.blocks.size
            paragraphs.append(
                f"`block_size`: largest number of bytes of a block; 0: {size}."
            )
            needed = [("bitmap", "BITMAP_BYTES")]
            if self.receives:
                needed.insert(0, ("buffer", "BLOCK_BYTES"))
            paragraphs += (
                f"`{memory}` needs {self._size(end)} bytes, less for smaller blocks."
                for memory, end in needed
            )
        if self.procedure.entry:
            entry = self._description.message(self.procedure.entry)
            decode = C_NAMES.symbol(entry, "decode")
            paragraphs.append(
                f"`on_entry` is called for each entry, which {decode}() decodes."
            )
        paragraphs.append("Errors: see icd_procedure_init().")
        return paragraphs

    def _about(self, each: Input) -> str:
        unknown = " ICD_UNKNOWN if it is not known." if each.is_optional else ""
        return f"`{each.name}`: {input_text(each)}{unknown}" if input_text(each) else ""

    def _size(self, end: str) -> str:
        return procedure_size(self.node, self.procedure.name, end)

    @property
    def sizes(self) -> list[tuple[str, int, str]]:
        """Constants of the procedure: name, value and comment."""
        blocks = self.procedure.blocks
        if blocks is None:
            return []
        bitmap = (
            self._size("BITMAP_BYTES"),
            -(-blocks.packets // 8),
            "Size in bytes of a bitmap for the packets of the largest block.",
        )
        buffer = (
            self._size("BLOCK_BYTES"),
            blocks.packets * blocks.packet_bytes,
            "Size in bytes of a buffer for the largest block.",
        )
        return [buffer, bitmap] if self.receives else [bitmap]

    @property
    def outputs(self) -> list[OutputFunction]:
        """Functions that return the outputs."""
        functions = []
        for output in self.procedure.outputs:
            value = f"procedure->registers[{output.register}]"
            type = "uint32_t"
            if output.is_flag:
                type, value = "bool", f"{value} != 0u"
            elif output.enum is not None:
                type = self._enum(output.enum)
                value = f"ICDGEN_CAST({type}, {value})"
            name = procedure(self.node, self.procedure.name, output.name)
            about = f"Return `{output.name}`. It is valid if the procedure ended with ICD_DONE."
            functions.append(OutputFunction(name, type, value, about))
        return functions

    def _enum(self, enum: Enum) -> str:
        return C_NAMES.symbol(self._description.enum(enum), "t")

    def type_of(self, each: Input) -> str:
        """Return the type of an input that is a number."""
        if each.is_optional:
            # Only 32 bits can represent `ICD_UNKNOWN`.
            return "uint32_t"
        if each.is_flag:
            return "bool"
        if each.enum is not None:
            return self._enum(each.enum)
        return f"uint{storage_bits(each.most.bit_length())}_t"


class _ProcedureTables(TableSet):
    """Tables of a procedure."""

    def declare_procedure(self, procedure: Procedure) -> list[Table]:
        """Return the tables of a procedure.

        The tables of its steps come first, because C needs their declarations before
        the table that refers to them.
        """
        self._rows: dict[str, list[TableRow]] = {
            name: [] for name in ("sends", "polls", "receives", "checksums", "tests")
        }
        steps = [self.row_of_step(step) for step in procedure.steps]
        types = {
            "sends": "icd_send_form_t",
            "polls": "icd_poll_form_t",
            "receives": "icd_receive_form_t",
            "checksums": "icd_checksum_test_t",
            "tests": "icd_test_t",
        }
        inputs, content = procedure.numbers, procedure.content
        arrays = ", ".join(
            self.declare_array(name, types[name], rows)
            for name, rows in self._rows.items()
        )
        receives = len(self._rows["receives"])
        rows = [
            TableRow(
                f"{self.declare_array('steps', 'icd_step_form_t', steps)}, {len(steps)}u",
                "steps",
            ),
            TableRow(arrays, ", ".join(self._rows)),
            TableRow(
                self.declare_array(
                    "inputs", "icd_input_form_t", map(self.row_of_input, inputs)
                ),
                "inputs",
            ),
            TableRow(f"{len(inputs)}u, {receives}u", "how many inputs, receives"),
            TableRow(self.declare_blocks(procedure.blocks), "blocks"),
            TableRow(
                f"{content.most if content else 0}u", "largest number of bytes to send"
            ),
            TableRow(f"{procedure.most_entries}u", "largest number of entries"),
            TableRow(f"{procedure.time}u", "longest duration in ms"),
            TableRow(f"{procedure.requests}u", "largest number of requests"),
        ]
        self.declare(
            "form",
            "icd_procedure_form_t",
            rows,
            self.assumptions.of_section_tree(f"procedures.{procedure.name}"),
        )
        return self.tables

    def row_of_step(self, step: Step) -> TableRow:
        """Return the row of a step; what it does is in another table."""
        index, text = 0, ""
        if isinstance(step, Send):
            index = self._index_of_row("sends", self.send_initialiser(step))
            text = step.message.name
        elif isinstance(step, (Get, Poll)):
            index = self._index_of_row("polls", self.poll_initialiser(step))
            text = step.message.name
        elif isinstance(step, Receive):
            index = self._index_of_row("receives", self.receive_initialiser(step))
            text = step.message.name
        elif isinstance(step, VerifyChecksum):
            index = self._index_of_row("checksums", self.checksum_initialiser(step))
        elif isinstance(step, (Verify, SkipUnless)):
            index = self._index_of_row("tests", test_initialiser(step.test))
        elif isinstance(step, SetLength):
            index = self._index_of_row(
                "tests", f"{{0u, {value_initialiser(step.value)}}}"
            )
        repeats = boolean(getattr(step, "again", False))
        to = getattr(step, "to", 0)
        kind = f"ICD_STEP_{_KINDS[type(step)]}"
        return TableRow(f"{{{kind}, {index}u, {repeats}, {to}u}}", plain(text))

    def _index_of_row(self, table: str, row: str) -> int:
        """Return the index of a row, which is added unless it is there."""
        rows = self._rows[table]
        # Steps often repeat the same message or test. They then share the row.
        if TableRow(row) not in rows:
            rows.append(TableRow(row))
        return rows.index(TableRow(row))

    def send_initialiser(self, step: Send) -> str:
        # NULL stands for zeros, which need no table.
        data = "NULL"
        if any(step.data):
            number = len(self._rows["sends"])
            octets = (f"{byte:#04x}u" for byte in step.data)
            data = self.declare_numbers(f"data_{number}", "uint8_t", octets, 16)
        puts = self.declare_once(
            "puts",
            "icd_put_t",
            (
                f"{{{number_place(each.place, ID_BYTES)}, {value_initialiser(each.value)}}}"
                for each in step.puts
            ),
        )
        packet_at = -1 if step.packet_at is None else step.packet_at
        flags = f"{boolean(step.repeats)}, {boolean(step.ignores_timeout)}"
        start = f"{step.message.telecommand_id:#x}u, {len(step.data)}u, {data}"
        return f"{{{start}, {puts}, {len(step.puts)}u, {packet_at}, {flags}}}"

    def poll_initialiser(self, step: Get | Poll) -> str:
        until: tuple[Test, ...] = ()
        fails: tuple[Test, ...] = ()
        times = "0u, 0u"
        if isinstance(step, Poll):
            until, fails = step.until, step.fails
            times = f"{step.interval}u, {step.timeout}u"
        takes = self.declare_once(
            "takes",
            "icd_take_t",
            (
                f"{{{number_place(each.place, ID_BYTES)}, {each.register}u}}"
                for each in step.takes
            ),
        )
        tests = self.declare_once(
            "conditions", "icd_test_t", map(test_initialiser, (*until, *fails))
        )
        counts = f"{len(step.takes)}u, {len(until)}u, {len(fails)}u"
        return (
            f"{{{step.message.telemetry_id:#x}u, {takes}, {tests}, {counts}, {times}}}"
        )

    def receive_initialiser(self, step: Receive) -> str:
        buses = sum(1 << BUSES.index(bus) for bus in step.requested_on)
        number = number_place(step.number, ID_BYTES)
        return (
            f"{{{step.message.telemetry_id:#x}u, {number}, {step.data_at}u, "
            f"{step.silence}u, {buses}u}}"
        )

    def checksum_initialiser(self, step: VerifyChecksum) -> str:
        flags = f"{boolean(step.of_block)}, {boolean(step.covers_fill)}"
        return f"{{{self.pointer_to_algorithm(step.algorithm)}, {flags}, {value_initialiser(step.value)}}}"

    def row_of_input(self, each: Input) -> TableRow:
        values = self.declare_once("values", "uint32_t", (f"{n}u" for n in each.values))
        optional = boolean(each.is_optional)
        return TableRow(
            f"{{{each.most}u, {values}, {len(each.values)}u, {optional}}}", each.name
        )

    def declare_blocks(self, blocks: Blocks | None) -> str:
        """Declare the tables of the blocks and their map; return NULL without blocks."""
        if blocks is None:
            return "NULL"
        form, map = "NULL", blocks.map
        if map is not None:
            messages = self.declare_array(
                "map_messages",
                "icd_map_message_t",
                [
                    TableRow(
                        f"{{{_id_literal(message.telecommand_id)}, {_id_literal(message.telemetry_id)}}}",
                        plain(message.name),
                    )
                    for message in map.messages
                ],
            )
            flags = (map.msb0, map.received, map.beyond_end)
            rows = [
                TableRow(f"{messages}, {len(map.messages)}u", "messages"),
                TableRow(
                    f"{map.messages[0].length}u, {map.at}u, {map.bytes}u",
                    "length of a message, offset and bytes of the map",
                ),
                TableRow(
                    ", ".join(boolean(flag) for flag in flags),
                    "bit 0 is the most significant one, received, beyond the end",
                ),
            ]
            form = self.declare("map", "icd_map_form_t", rows)
        return self.declare(
            "blocks",
            "icd_blocks_form_t",
            [
                TableRow(boolean(blocks.sends), "sends"),
                # 0 is the register of the offset, so it can mean that there is none.
                TableRow(f"{blocks.total or 0}u", "register with the number of bytes"),
                TableRow(
                    f"{blocks.begin}u, {blocks.size}u", "first step, bytes of a block"
                ),
                TableRow(
                    f"{blocks.packet_bytes}u, {blocks.first_packet}u, {blocks.fill:#04x}u",
                    "bytes of a packet, first number, fill",
                ),
                TableRow(f"{blocks.rounds}u, {blocks.most}u", "rounds, bytes in all"),
                TableRow(form, "map"),
            ],
        )


def _fixed_parameter(name: str) -> str:
    """Return a parameter of all procedures that need it."""
    return PROCEDURE_PARAMETERS[name] + name


def _id_literal(id: int | None) -> str:
    return f"{id or 0:#x}u"


def value_initialiser(value: Value) -> str:
    """Return the initialiser of a value."""
    return f"{{{value.number}u, {boolean(value.in_register)}}}"


def test_initialiser(test: Test) -> str:
    """Return the initialiser of a test."""
    return f"{{{test.register}u, {value_initialiser(test.value)}}}"
