"""Procedures of a node: the tables of their steps, and types with typed inputs and
outputs.

`_ProcedureWriter` returns the code of a type, and `_step_literal` the row of a step,
which the engine of the wire layer runs. A procedure of an included node is generated
there, once (`NodeProcedures`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import singledispatch

from icdgen.backends.lines import STEP
from icdgen.backends.literals import Brackets, written
from icdgen.backends.rust.literals import (
    Expression,
    flat,
    flat_rows,
    members,
    part,
    rows,
    some,
    spelled,
)
from icdgen.backends.rust.names import RESERVED, constant_name, memory_constant
from icdgen.backends.rust.streams import algorithm_of
from icdgen.backends.rust.symbols import RUST_NAMES, procedure_type
from icdgen.backends.rust.text import code, doc, integer, prose, signature, string
from icdgen.backends.rust.types import reason_number
from icdgen.describe import Description
from icdgen.describe.comments import sentence
from icdgen.describe.links import LinkDescription
from icdgen.describe.procedures import input_text, source_text
from icdgen.describe.storage import storage_bits
from icdgen.frozen import dataclass
from icdgen.icd.buses import BUSES
from icdgen.icd.enumeration import Enum
from icdgen.protocol import procedures as model
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.facts import Facts

SECTION = "procedures."
"""Beginning of the names of sections with assumptions about procedures."""

_OWN = ("memory", "on_block", "on_entry")
"""Parameters of constructors that are no inputs."""


@dataclass(frozen=True, slots=True)
class OutputMethod:
    """Method that returns an output."""

    about: str
    name: str
    type: str
    value: str


@dataclass(frozen=True, slots=True)
class ProcedureText:
    """Parts of the code of a procedure."""

    type: str
    constant: str
    about: str
    new: str  # head of the constructor, with its comment
    lifetime: str  # `'a` if it borrows, otherwise `'static`
    generics: str  # parameters of the type
    bounds: str  # the same with bounds
    elided: tuple[str, str]  # parameters of an implementation and of the type in it
    sink: str
    numbers: str  # the inputs that are numbers
    data: str  # the bytes to send
    memory: str
    into_sink: str
    outputs: tuple[OutputMethod, ...]
    memory_constant: str  # "" if the procedure has no blocks
    memory_bytes: str
    table: str

    def is_code_of(self, other: ProcedureText) -> bool:
        """Return whether the code is the same; examples name the node."""
        return (self.new, self.outputs, self.table) == (
            other.new,
            other.outputs,
            other.table,
        )


def buffer_sizes(links: Iterable[LinkDescription]) -> dict[str, int]:
    """Return the sizes of buffers for all procedures: of telecommands and of entries."""
    procedures = [each for link in links for each in link.facts.procedures]
    steps = [step for each in procedures for step in each.steps]
    telecommands = [len(step.data) for step in steps if isinstance(step, model.Send)]
    maps = [each.blocks.map for each in procedures if each.blocks and each.blocks.map]
    telecommands += [message.length for map in maps for message in map.messages]
    entries = [each.entry.length for each in procedures if each.entry]
    return {
        "telecommand": max(telecommands, default=1),
        "entry": max(entries, default=1),
    }


class NodeProcedures:
    """Procedures of a node.

    ``own``: those whose code is in the module of the node. ``included``: types of
    others, by the module of an included node that has their code.
    """

    def __init__(
        self,
        link: LinkDescription,
        description: Description,
        of_included: Mapping[str, NodeProcedures],
        crate: str,
    ) -> None:
        self.node = link.facts.node.name
        self.own: list[ProcedureText] = []
        self.included: dict[str, list[ProcedureText]] = {}
        self.all: list[ProcedureText] = []
        for procedure in link.facts.procedures:
            # A node can have procedures of the nodes that it includes. Code that is the
            # same is generated once, in the module of the included node.
            text = _ProcedureWriter(
                procedure, link.facts, description, crate
            ).procedure_text()
            owners = (
                name
                for name in description.node(self.node).included
                if name in of_included
                and any(map(text.is_code_of, of_included[name].own))
            )
            owner = next(owners, None)
            self.all.append(text)
            if owner:
                self.included.setdefault(owner, []).append(text)
            else:
                self.own.append(text)

    @property
    def uses_link(self) -> bool:
        """Whether its tables use the module `link` of the wire layer."""
        return any("link::" in text.table for text in self.own)


class _ProcedureWriter:
    """Writes the code of a procedure."""

    def __init__(
        self,
        procedure: model.Procedure,
        facts: Facts,
        description: Description,
        crate: str,
    ) -> None:
        self._crate = crate
        self._procedure, self._facts, self._description = procedure, facts, description
        self._type = procedure_type(procedure.name)
        self._constant = constant_name(procedure.name)
        self._memory = memory_constant(procedure.name)
        blocks = procedure.blocks
        self._receives = blocks is not None and not blocks.sends

    def procedure_text(self) -> ProcedureText:
        procedure = self._procedure
        sink, into_sink, bound = self._sink()
        has_memory = procedure.blocks is not None
        borrowed = ["'a"] * has_memory
        functions = ["F"] if bound else []
        bounds = [f"F: {bound}"] if bound else []
        sent = procedure.content
        return ProcedureText(
            type=self._type,
            constant=self._constant,
            about=f"{doc(self._about())}\n{code(self._example())}",
            new=self._new(bound),
            lifetime="'a" if has_memory else "'static",
            generics=_angle(borrowed + functions),
            bounds=_angle(borrowed + bounds),
            elided=(_angle(functions), _angle(["'_"] * has_memory + functions)),
            sink=sink,
            numbers=", ".join(self._number(each) for each in procedure.numbers),
            data=_parameter(sent) if sent else "&[]",
            memory="memory" if has_memory else "&mut []",
            into_sink=into_sink,
            outputs=tuple(map(self._output, procedure.outputs)),
            memory_constant=self._memory if has_memory else "",
            memory_bytes=self._memory_bytes(),
            table=written(self._form(), lambda why, indent: ""),
        )

    def _sink(self) -> tuple[str, str, str]:
        """Return the type of the sink, its expression ("" if there is nothing to store), and
        the bound of its function.
        """
        entry = self._procedure.entry
        if self._receives:
            sink = "procedure::Received"
            return f"{sink}<F>", f"{sink}(on_block)", "FnMut(u32, &[u8])"
        if entry is not None:
            message = self._description.message(entry)
            path = f"crate::{message.node.name}::{RUST_NAMES.symbol(message, 'type')}"
            sink = "procedure::Entries"
            return f"{sink}<{path}, F>", f"{sink}::new(on_entry)", f"FnMut({path})"
        return "()", "", ""

    def _about(self) -> Iterator[str]:
        procedure = self._procedure
        yield prose(sentence(procedure.summary)) or f"Procedure `{procedure.name}`."
        source = source_text(procedure.source)
        if source:
            yield prose(f"Source: {source[0].lower()}{source[1:]}")
        section = f"{SECTION}{procedure.name}"
        for assumption in self._facts.assumptions:
            # The final dot keeps `copy` from matching the sections of `copy_all`.
            if f"{assumption.section}.".startswith(f"{section}."):
                where = assumption.section.removeprefix(SECTION)
                why = prose(sentence(assumption.why))
                yield f"Assumed (`{where}`, `{assumption.key}`): {why}"

    def _example(self) -> Iterator[str]:
        """Yield the lines of an example, which is run."""
        names = [self._type]
        arguments = list(map(_example_argument, self._procedure.inputs))
        if self._procedure.blocks:
            names.append(self._memory)
            arguments.append("&mut memory")
        if self._receives:
            arguments.append("|_offset, _bytes| {}")
        elif self._procedure.entry:
            arguments.append("|_entry| {}")
        path = f"{self._crate}::{self._facts.node.name}::procedures"
        listed = f"{{{', '.join(names)}}}" if len(names) > 1 else names[0]
        yield "```"
        yield f"use {path}::{listed};"
        yield ""
        if self._procedure.blocks:
            yield f"let mut memory = [0; {self._memory}];"
        yield f"let mut procedure = {self._type}::new({', '.join(arguments)})?;"
        yield "assert!(procedure.next(0).is_some()); // `run` of a session does the rest"
        yield f"# Ok::<(), {self._crate}::wire::Error>(())"
        yield "```"

    def _new(self, bound: str) -> str:
        """Return the comment and the head of the constructor."""
        procedure, rows, parameters = self._procedure, [], []
        for each in procedure.inputs:
            name = _parameter(each)
            text = prose(input_text(each)) + " None: unknown." * each.is_optional
            rows.append(f"`{each.name}`: {text.strip()}" if text else f"`{each.name}`")
            parameters.append(f"{name}: {self._input_type(each)}")
        if procedure.blocks:
            rows.append(
                f"`memory`: [`{self._memory}`] bytes; with fewer, blocks are smaller."
            )
            parameters.append("memory: &'a mut [u8]")
        if self._receives:
            rows.append("`on_block`: gets the offset and the bytes of each block.")
            parameters.append("on_block: F")
        elif bound:
            rows.append("`on_entry`: gets each entry.")
            parameters.append("on_entry: F")
        head = signature("pub fn new", tuple(parameters), "Result<Self, Error>")
        items = (doc([row], STEP, "///  ").replace("///  ", "/// -", 1) for row in rows)
        lines = [
            doc(["Create the procedure."], STEP),
            *([f"{STEP}///", *items] if rows else []),
            f"{STEP}///\n{STEP}/// # Errors\n{STEP}///",
            doc([f"{', '.join(self._errors()) or 'None: it has no inputs'}."], STEP),
        ]
        return "\n".join([*lines, head])

    def _errors(self) -> Iterator[str]:
        if self._procedure.numbers:
            yield "[`Error::Range`] if an input has a value that the ICD does not allow"
        if self._procedure.content:
            yield "[`Error::TooLong`] if there are too many bytes"
        if self._procedure.blocks:
            yield "[`Error::Length`] if the memory is too small for a packet"

    def _input_type(self, each: model.Input) -> str:
        if each.is_bytes:
            return "&'a [u8]"
        if each.enum is not None:
            type = self._enum_path(each.enum)
        else:
            type = (
                "bool" if each.is_flag else f"u{storage_bits(each.most.bit_length())}"
            )
        return f"Option<{type}>" if each.is_optional else type

    def _number(self, each: model.Input) -> str:
        """Return the expression of an input as an optional number."""
        name = _parameter(each)
        if each.enum is not None:  # which is never optional (ICD192)
            bits = self._description.enum(each.enum).storage.bits
            if bits == 64:
                # None is refused like any other value that is not possible.
                return f"u32::try_from({name}.raw()).ok()"
            raw = f"{name}.raw()"
            return f"Some({raw})" if bits == 32 else f"Some(u32::from({raw}))"
        is_wide = not each.is_flag and each.most.bit_length() > 16
        if each.is_optional:
            return name if is_wide else f"{name}.map(u32::from)"
        return f"Some({name})" if is_wide else f"Some(u32::from({name}))"

    def _enum_path(self, enum: Enum) -> str:
        described = self._description.enum(enum)
        name = RUST_NAMES.symbol(described, "type")
        return f"crate::{described.node.name}::enums::{name}"

    def _output(self, output: model.Output) -> OutputMethod:
        value = f"self.0.output({output.register})"
        type, converted = "u32", value
        if output.enum is not None:
            type = self._enum_path(output.enum)
            number = reason_number(self._description.enum(output.enum))
            converted = f"{value}.map(|code| {type}::from({number}))"
        elif output.is_flag:
            type, converted = "bool", f"{value}.map(|flag| flag != 0)"
        words = output.name.replace("_", " ")
        about = doc([f"Return the {words}; None until the procedure succeeded."], STEP)
        name = f"r#{output.name}" if output.name in RESERVED else output.name
        return OutputMethod(about, name, type, converted)

    def _memory_bytes(self) -> str:
        blocks = self._procedure.blocks
        if blocks is None:
            return ""
        # Bytes to send stay in the input of the caller. Both directions need a bit for
        # each packet.
        received = 0 if blocks.sends else blocks.packets * blocks.packet_bytes
        return integer(received + -(-blocks.packets // 8))

    def _form(self) -> Brackets:
        procedure = self._procedure
        content = procedure.content
        inputs = (
            _flat_literal(
                "Input",
                name=string(each.name),
                most=each.most,
                values=flat_rows(map(spelled, each.values)),
                allowed=string(_allowed(each)),
                is_optional=each.is_optional,
            )
            for each in procedure.numbers
        )
        outputs = (
            f"({string(each.name)}, {each.register})" for each in procedure.outputs
        )
        entry = procedure.entry.telemetry_id if procedure.entry else None
        items = (
            part("name", string(procedure.name)),
            part("inputs", rows(inputs)),
            part("most_bytes", integer(content.most if content else 0)),
            part("outputs", flat_rows(outputs)),
            part("entry", some(entry)),
            part("most_entries", integer(procedure.most_entries)),
            part("blocks", some(_blocks_literal(procedure.blocks))),
            part("time_ms", integer(procedure.time)),
            part("requests", integer(procedure.requests)),
            part("retries", integer(self._facts.client.retries)),
            part("steps", rows(map(_step_literal, procedure.steps))),
        )
        return Brackets("procedure::Form { ", items, " }")


def _example_argument(each: model.Input) -> str:
    """Return an allowed value of an input."""
    if each.is_bytes:
        return "&[1, 2, 3]"
    value = "false" if each.is_flag else str(each.values[0] if each.values else 0)
    value = f"{value}.into()" if each.enum else value
    return "None" if each.is_optional else value


def _allowed(each: model.Input) -> str:
    """Return the allowed numbers of an input in words."""
    if each.values:
        return f"one of {', '.join(map(str, each.values))}"
    return f"0 to {each.most}"


def _angle(parameters: list[str]) -> str:
    return f"<{', '.join(parameters)}>" if parameters else ""


def _parameter(each: model.Input) -> str:
    """Return the name of the parameter of an input."""
    if each.name in _OWN or each.name in ("self", "super", "crate"):
        # Of the keywords that `r#` cannot escape, only `self`, `super` and `crate` are
        # names in snake case.
        return f"{each.name}_"
    return f"r#{each.name}" if each.name in RESERVED else each.name


def _flat_literal(type: str, /, **parts: Expression | int) -> Brackets:
    """Return a struct or a step of the module `procedure` on one line."""
    literal = flat(type, **parts)
    return Brackets(
        f"procedure::{type} {{ ", literal.items, literal.closing, is_flat=True
    )


def _blocks_literal(blocks: model.Blocks | None) -> Brackets | None:
    if blocks is None:
        return None
    values = {
        **members(blocks),
        "total": some(blocks.total),
        "map": some(_map_literal(blocks.map)),
    }
    items = (
        part(key, value if isinstance(value, Brackets) else spelled(value))
        for key, value in values.items()
    )
    return Brackets("procedure::Blocks { ", tuple(items), " }")


def _map_literal(map: model.PacketMap | None) -> Brackets | None:
    if map is None:
        return None
    messages = (
        f"({spelled(message.telecommand_id or 0)}, {spelled(message.telemetry_id or 0)})"
        for message in map.messages
    )
    values = {**members(map), "messages": flat_rows(messages)}
    # The messages of a map have the same layout, so the first one gives the length of
    # all.
    return _flat_literal("PacketMap", length=map.messages[0].length, **values)


def _value_literal(value: model.Value) -> str:
    kind = "Register" if value.in_register else "Constant"
    return f"procedure::Value::{kind}({spelled(value.number)})"


def _place_literal(place: NumberPlace) -> Brackets:
    return flat("NumberPlace", **members(place))


def _test_literal(test: model.Test) -> Brackets:
    return _flat_literal(
        "Test", register=test.register, value=_value_literal(test.value)
    )


def _takes_literal(takes: Iterable[model.Take]) -> Brackets:
    return flat_rows(
        _flat_literal("Take", place=_place_literal(take.place), register=take.register)
        for take in takes
    )


def _bytes_literal(data: bytes) -> Expression:
    """Return a reference to bytes."""
    if len(data) > 1 and not any(data):
        return f"&[0; {len(data)}]"
    return flat_rows(map(str, data))


@singledispatch
def _step_literal(step: model.Step) -> Expression:
    """Return the expression of a step."""
    name = f"Step::{type(step).__name__}"
    parts = {}
    for key, value in members(step).items():
        parts[key] = _test_literal(value) if isinstance(value, model.Test) else value
    return _flat_literal(name, **parts) if parts else f"procedure::{name}"


@_step_literal.register
def _(step: model.Send) -> Brackets:
    puts = (
        _flat_literal(
            "Put", place=_place_literal(put.place), value=_value_literal(put.value)
        )
        for put in step.puts
    )
    return _flat_literal(
        "Step::Send",
        id=step.message.telecommand_id or 0,
        data=_bytes_literal(step.data),
        puts=flat_rows(puts),
        packet_at=some(step.packet_at),
        repeats=step.repeats,
        ignores_timeout=step.ignores_timeout,
    )


@_step_literal.register
def _(step: model.Get) -> Brackets:
    id = step.message.telemetry_id or 0
    return _flat_literal("Step::Get", id=id, takes=_takes_literal(step.takes))


@_step_literal.register
def _(step: model.Poll) -> Brackets:
    return _flat_literal(
        "Step::Poll",
        id=step.message.telemetry_id or 0,
        takes=_takes_literal(step.takes),
        until=flat_rows(map(_test_literal, step.until)),
        fails=flat_rows(map(_test_literal, step.fails)),
        interval_ms=step.interval,
        timeout_ms=step.timeout,
    )


@_step_literal.register
def _(step: model.SetLength) -> str:
    return f"procedure::Step::SetLength({_value_literal(step.value)})"


@_step_literal.register
def _(step: model.Receive) -> Brackets:
    return _flat_literal(
        "Step::Receive",
        id=step.message.telemetry_id or 0,
        number=_place_literal(step.number).within("&", ""),
        data_at=step.data_at,
        silence_ms=step.silence,
        requested_on=flat("PerBus", **{bus: bus in step.requested_on for bus in BUSES}),
    )


@_step_literal.register
def _(step: model.VerifyChecksum) -> Brackets:
    return _flat_literal(
        "Step::VerifyChecksum",
        algorithm=algorithm_of(step.algorithm).within("&", ""),
        of_block=step.of_block,
        covers_fill=step.covers_fill,
        value=_value_literal(step.value),
        again=step.again,
    )
