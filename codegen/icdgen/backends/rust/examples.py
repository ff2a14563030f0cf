"""Examples in the documentation of generated code, which ``cargo test --doc`` runs."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen import codec
from icdgen.backends.rust.accessors import accessors
from icdgen.backends.rust.names import ENUMS_MODULE, constant_name, field_name, setter
from icdgen.backends.rust.symbols import RUST_NAMES
from icdgen.backends.rust.text import double, integer, mask
from icdgen.describe import EnumDescription, MessageDescription, NodeDescription
from icdgen.describe.examples import Example, Shown, example
from icdgen.describe.links import LinkDescription
from icdgen.describe.nodes import Direction

_SHORT = 8
"""Bytes of a frame up to which an example shows all; of longer frames it shows the
bytes that are not 0.
"""


def message_example(message: MessageDescription, crate: str) -> list[str]:
    """Return lines that decode a frame, read a value and encode it again.

    A message that is only sent is created and encoded.
    """
    shown = example(message)
    is_received = message.model.telemetry_id is not None
    body = _received(message, shown) if is_received else _sent(message, shown)
    return _fallible([*_imports(message, shown.shown, crate), "", *body], crate)


def enum_example(enum: EnumDescription, crate: str) -> list[str]:
    """Return lines that compare a value with its name."""
    name, member = RUST_NAMES.symbol(enum, "type"), (
        enum.members[-1] if enum.members else None
    )
    first = enum.member(member.model.value) if member else None
    tests = []
    if first is not None:
        variant = RUST_NAMES.symbol(first, "variant")
        tests.append(
            f"assert_eq!({name}::from({integer(first.model.value)}), {name}::{variant});"
        )
    path = f"{crate}::{enum.node.name}::{ENUMS_MODULE}::{name}"
    return _fenced(
        [f"use {path};", "", *tests, f"assert_eq!({name}::default().raw(), 0);"]
    )


def direction_example(
    direction: Direction, node: NodeDescription, crate: str
) -> list[str]:
    """Return lines that decode a frame of zeros by its id."""
    message, id = direction.messages[0]
    name, path = (
        direction.kind.capitalize(),
        f"{crate}::{message.node.name}::{RUST_NAMES.symbol(message, 'type')}",
    )
    return _fallible(
        [
            f"use {crate}::{node.name}::{name};",
            "",
            f"let message = {name}::from_bytes({path}::{constant_name(id)}, &[0; {message.model.layout.shortest}])?;",
            f"assert_eq!(message.name(), {path}::NAME);",
        ],
        crate,
    )


def client_example(
    node: NodeDescription, link: LinkDescription, crate: str
) -> list[str]:
    """Return lines in which a client on a UART requests a message and gets it; none
    without UART or short messages.
    """
    linked = [
        message
        for message in node.telemetry
        if message.model.telemetry_id in link.facts.telemetry
    ]
    short = [message for message in linked if message.model.length <= _SHORT]
    if link.facts.framing is None or not short:
        return []
    scaled = (
        message
        for message in short
        if any(field.is_scaled for field in message.members)
    )
    message = next(scaled, short[0])
    reply, name = example(message), RUST_NAMES.symbol(message, "type")
    answer = _bytes(bytes([message.model.telemetry_id or 0, *reply.frame]))
    client = f"Client::<{node.name}::Node, {{ {node.name}::LONGEST }}>"
    return _fallible(
        [
            *_imports(message, reply.shown, crate),
            f"use {crate}::{{{node.name}, wire}};",
            "",
            f"let mut client = wire::{client}::uart(&{node.name}::LINK)?;",
            f"client.request::<{name}>(0)?; // at 0 ms, by any clock",
            "assert!(client.output().is_some()); // bytes for the port",
            "",
            "// What the node answers; the client is given it 20 ms later.",
            "let mut line = [0; 64];",
            f"let size = wire::uart::encode(&{node.name}::LINK, &{answer}, &mut line)?;",
            "let mut answer = None;",
            f"client.received(20, &line[..size], |event| answer = event.message::<{name}>());",
            "let message = answer.unwrap();",
            (
                _read(reply.shown)
                if reply.shown
                else "assert_eq!(message.to_bytes()?, []);"
            ),
        ],
        f"{crate}::wire",
    )


def _fallible(lines: Iterable[str], crate: str) -> list[str]:
    """Return the lines as a doctest in which ``?`` is allowed."""
    return _fenced((*lines, f"# Result::<(), {crate}::Error>::Ok(())"))


def _fenced(lines: Iterable[str]) -> list[str]:
    return ["```", *lines, "```"]


def _imports(message: MessageDescription, shown: Shown | None, crate: str) -> list[str]:
    home, name = f"{crate}::{message.node.name}", RUST_NAMES.symbol(message, "type")
    enum = shown.field.enum if shown else None
    if enum is None:
        return [f"use {home}::{name};"]
    if enum.node is message.node:
        return [f"use {home}::{{{ENUMS_MODULE}, {name}}};"]
    return [f"use {crate}::{enum.node.name}::{ENUMS_MODULE};", f"use {home}::{name};"]


def _received(message: MessageDescription, shown: Example) -> list[str]:
    lines = [f"let frame = {_bytes(shown.frame)};"]
    if len(shown.frame) > _SHORT:
        size = (
            str(len(shown.frame))
            if message.last_part
            else f"{RUST_NAMES.symbol(message, 'type')}::LENGTH"
        )
        lines = [f"let mut frame = [0; {size}];"]
        lines += [_put(start, run) for start, run in shown.runs]
    return [
        *lines,
        f"let message = {RUST_NAMES.symbol(message, 'type')}::from_bytes(&frame)?;",
        *([_read(shown.shown)] if shown.shown else []),
        "assert_eq!(message.to_bytes()?, frame);",
    ]


def _sent(message: MessageDescription, shown: Example) -> list[str]:
    name = RUST_NAMES.symbol(message, "type")
    lines = [f"let command = {name}::default();"]
    if shown.shown:
        lines = [f"let mut command = {name}::default();", _written(shown.shown)]
    if len(shown.frame) <= _SHORT:
        return [*lines, f"assert_eq!(command.to_bytes()?, {_bytes(shown.frame)});"]
    places = [
        f"assert_eq!(frame[{start}..{start + len(run)}], {_bytes(run)});"
        for start, run in shown.runs
    ]
    if not places:
        return [*lines, f"assert_eq!(command.to_bytes()?.len(), {len(shown.frame)});"]
    return [*lines, "let frame = command.to_bytes()?;", *places]


def _read(shown: Shown) -> str:
    field = shown.field
    if shown.physical is not None:
        return f"assert_eq!(message.{field.physical_name}(), {double(shown.physical)});"
    value = f"message.{field_name(field)}"
    return (
        f"assert!({value});"
        if field.model.type == "bool"
        else f"assert_eq!({value}, {_value(shown)});"
    )


def _written(shown: Shown) -> str:
    field = shown.field
    if shown.physical is not None and accessors(field)[0].raw:
        return f"command.{setter(field.physical_name)}({double(shown.physical)})?;"
    into = ".into()" if field.enum else ""
    return f"command.{field_name(field)} = {_value(shown)}{into};"


def _value(shown: Shown) -> str:
    """Return the literal of the raw value."""
    field, raw = shown.field, shown.raw
    if field.enum is not None:
        member = field.enum.member(raw)
        assert member is not None, "an example of an enumeration is a member of it"
        return f"{ENUMS_MODULE}::{RUST_NAMES.symbol(field.enum, 'type')}::{RUST_NAMES.symbol(member, 'variant')}"
    if field.model.type == "bool":
        return "true" if raw else "false"
    return (
        double(codec.float_value(field.model, raw))
        if field.model.type == "float"
        else integer(raw)
    )


def _put(start: int, run: bytes) -> str:
    if len(run) == 1:
        return f"frame[{start}] = {mask(run[0])};"
    return f"frame[{start}..{start + len(run)}].copy_from_slice(&{_bytes(run)});"


def _bytes(data: bytes) -> str:
    return f"[{', '.join(map(mask, data))}]"
