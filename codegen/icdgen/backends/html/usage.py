"""How a message is used in C, Python and Rust, with the names that the backends give."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from icdgen.backends.c.names import constant, enumerator, stem
from icdgen.backends.rust import CRATE
from icdgen.backends.rust.names import type_name
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.naming import camel

_PACKAGE = "icdgen_messages"
_ZEROS = {"bool": "false", "float": "0.0"}


class Snippet(NamedTuple):
    """A piece of a program; ``text`` is what a highlighter would want: code with comments."""

    language: str
    key: str
    text: str


def snippets(message: MessageDescription) -> list[Snippet]:
    """One for each language: receiving, sending, or both."""
    shown = _worth_showing(message)
    languages: tuple[tuple[str, str, _Maker], ...] = (
        ("C", "c", _c),
        ("Python", "python", _python),
        ("Rust", "rust", _rust),
    )
    return [Snippet(name, key, "\n".join(make(message, shown))) for name, key, make in languages]


def names(message: MessageDescription) -> list[tuple[str, str]]:
    """Language and the name of the message's type in it."""
    return [("C", f"{stem(message)}_t"), ("Python", camel(message.words)), ("Rust", type_name(message))]


_Maker = Callable[[MessageDescription, FieldDescription | None], list[str]]


def _is_sent(message: MessageDescription) -> bool:
    return message.model.telecommand_id is not None


def _is_received(message: MessageDescription) -> bool:
    return message.model.telemetry_id is not None


def _c(message: MessageDescription, field: FieldDescription | None) -> list[str]:
    name, length = stem(message), constant(message, "length")
    lines = [f'#include "{message.node.name}.h"']
    if _is_received(message):
        lines += ["", f"{name}_t message;", f"if ({name}_decode(&message, buffer, length) == ICD_OK) {{"]
        if field is None:
            lines.append(f"    /* {length} bytes, without any field */")
        elif field.steps is not None:
            lines.append(f"    double {field.name} = {name}_{field.physical_name}(&message);")
        else:
            lines.append(f"    use(message.{field.name});")
        lines.append("}")
    if _is_sent(message):
        variable = "command" if _is_received(message) else "message"
        frame = f"uint8_t frame[{length}{'' if message.model.length else ' + 1'}];"
        lines += ["", f"{name}_t {variable};", frame, "", f"{name}_init(&{variable});"]
        if field is not None and field.steps is not None:
            call = f"{name}_set_{field.physical_name}(&{variable}, 0.0);"
            lines.append(f"{call}   /* ICD_OK, unless it does not fit */")
        elif field is not None and field.enum is not None and field.enum.members:
            lines.append(f"{variable}.{field.name} = {enumerator(field.enum, field.enum.members[-1])};")
        elif field is not None:
            lines.append(f"{variable}.{field.name} = {'false' if field.model.type == 'bool' else '0'};")
        lines.append(f"if ({name}_encode(&{variable}, frame, sizeof frame) == ICD_OK) {{")
        lines += [f"    send({constant(message, message.telecommand_id_name)}, frame, {length});", "}"]
    return lines


def _python(message: MessageDescription, field: FieldDescription | None) -> list[str]:
    name, enum = camel(message.words), field.enum if field else None
    imported = name
    lines = []
    if _is_received(message):
        lines += ["", f"message = {name}.from_bytes(buffer)"]
        if field is not None:
            lines.append(f"message.{field.name}" + ("   # raw" if field.steps else ""))
        if field is not None and field.steps is not None:
            lines.append(f"message.{field.physical_name}   # physical")
    if _is_sent(message):
        lines += ["", f"command = {name}()"]
        if field is not None and field.steps is not None:
            lines.append(f"command.{field.physical_name} = 0.0   # RangeError, if it does not fit")
        elif field is not None and enum is not None and enum.members:
            imported += f", {camel(enum.words)}"
            lines.append(f"command.{field.name} = {camel(enum.words)}.{enum.members[-1].name.upper()}")
        elif field is not None:
            lines.append(f"command.{field.name} = {_ZEROS.get(field.model.type, '0').capitalize()}")
        lines.append(f"send({name}.{message.telecommand_id_name.upper()}, command.to_bytes())")
    return [f"from {_PACKAGE}.{message.node.name} import {imported}", *lines]


def _rust(message: MessageDescription, field: FieldDescription | None) -> list[str]:
    name, enum = type_name(message), field.enum if field else None
    used = [f"use {CRATE}::{message.node.name}::{name};"]
    lines = []
    if _is_received(message):
        lines += ["", f"let {'message' if field else '_message'} = {name}::from_bytes(buffer)?;"]
        if field is not None:
            lines.append(f"let {field.name} = message.{f'{field.physical_name}()' if field.steps else field.name};")
    if _is_sent(message):
        lines += ["", f"let {'mut ' if field else ''}command = {name}::default();"]
        if field is not None and field.steps is not None:
            lines.append(f"command.set_{field.physical_name}(0.0)?;   // refuses what does not fit")
        elif field is not None and enum is not None and enum.members:
            used.append(f"use {CRATE}::{enum.node.name}::enums::{type_name(enum)};")
            lines.append(f"command.{field.name} = {type_name(enum)}::{type_name(enum.members[-1])}.into();")
        elif field is not None and enum is None:
            lines.append(f"command.{field.name} = {_ZEROS.get(field.model.type, '0')};")
        to_bytes = "try_to_bytes()?" if message.is_narrow else "to_bytes()"
        lines.append(f"send({name}::{message.telecommand_id_name.upper()}, &command.{to_bytes});")
    return used + lines


def _worth_showing(message: MessageDescription) -> FieldDescription | None:
    """The first field with a scale, else the first that is neither constant nor a byte array."""
    usual = [one for one in message.fields if one.model.const is None and one.model.type != "bytes"]
    return next((one for one in usual if one.steps is not None), usual[0] if usual else None)
