"""How a message is used in C, Python and Rust, with the names that the backends give."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.names import enumerator, stem
from icdgen.backends.python import names as python
from icdgen.backends.rust import CRATE, fields
from icdgen.backends.rust import names as rust
from icdgen.describe import FieldDescription, describe
from icdgen.icd.model import Field, Icd, Message, Node

_PACKAGE = "icdgen_messages"


class Snippet(NamedTuple):
    """A piece of a program; ``text`` is what a highlighter would want: code with comments."""

    language: str
    key: str
    text: str


class Usage:
    """Makes the snippets of messages."""

    def __init__(self, icd: Icd) -> None:
        self.icd, self.description, self.enums = icd, describe(icd), rust.Enums(icd)

    def snippets(self, message: Message) -> list[Snippet]:
        """One for each language: receiving, sending, or both."""
        node = self.icd.node(message.node)
        receive, send = message.telemetry_id is not None, message.telecommand_id is not None
        shown = _worth_showing(message)
        return [
            Snippet("C", "c", self._c(message, node, shown, receive, send)),
            Snippet("Python", "python", self._python(message, node, shown, receive, send)),
            Snippet("Rust", "rust", self._rust(message, node, shown, receive, send)),
        ]

    def _c(self, message: Message, node: Node, shown: Field | None, receive: bool, send: bool) -> str:
        described = self.description.message(message)
        name = stem(described)
        fields = (field for field in described.fields if field.field is shown)
        field = next(fields, None)
        lines = [f'#include "{node.name}.h"']
        if receive:
            lines += ["", f"{name}_t message;", f"if ({name}_decode(&message, buffer, length) == ICD_OK) {{"]
            if field is None:
                lines.append(f"    /* {name.upper()}_LENGTH bytes, without any field */")
            elif field.steps is not None:
                lines.append(f"    double {field.name} = {name}_{field.physical_name}(&message);")
            else:
                lines.append(f"    use(message.{field.name});")
            lines.append("}")
        if send:
            size = f"{name.upper()}_LENGTH"
            variable = "command" if receive else "message"
            lines += ["", f"{name}_t {variable};", f"uint8_t frame[{size}{'' if message.length else ' + 1'}];", ""]
            lines.append(f"{name}_init(&{variable});")
            if field is not None:
                lines.append(self._c_setting(name, field, variable))
            lines.append(f"if ({name}_encode(&{variable}, frame, sizeof frame) == ICD_OK) {{")
            lines.append(f"    send({name.upper()}_{'SET_ID' if receive else 'ID'}, frame, {size});")
            lines.append("}")
        return "\n".join(lines)

    def _c_setting(self, name: str, field: FieldDescription, variable: str) -> str:
        if field.steps is not None:
            return f"{name}_set_{field.physical_name}(&{variable}, 0.0);   /* ICD_OK, unless it does not fit */"
        if field.enum is not None and field.enum.members:
            return f"{variable}.{field.name} = {enumerator(field.enum, field.enum.members[-1])};"
        return f"{variable}.{field.name} = {'true' if field.field.type == 'bool' else '0'};"

    def _python(self, message: Message, node: Node, shown: Field | None, receive: bool, send: bool) -> str:
        name = python.class_name(message, node)
        field = python.attribute(shown, node) if shown else ""
        physical = python.physical(shown, field) if shown else ""
        enum = shown.enum if shown and shown.enum and shown.enum.members and send else None
        imported = [name] + ([python.class_name(enum, self.icd.node(enum.node))] if enum is not None else [])
        lines = [f"from {_PACKAGE}.{node.name} import {', '.join(imported)}"]
        if receive:
            lines += ["", f"message = {name}.from_bytes(buffer)"]
            if shown:
                lines.append(f"message.{field}" + ("   # raw" if physical else ""))
            if physical:
                lines.append(f"message.{physical}   # physical")
        if send:
            lines += ["", f"command = {name}()"]
            if shown and physical:
                lines.append(f"command.{physical} = 0.0   # RangeError, if it does not fit")
            elif shown and enum is not None:
                lines.append(
                    f"command.{field} = {imported[1]}.{python.member(enum.members[-1], self.icd.node(enum.node))}"
                )
            elif shown:
                lines.append(
                    f"command.{field} = {'True' if shown.type == 'bool' else '0.0' if shown.type == 'float' else '0'}"
                )
            lines.append(f"send({name}.{'SET_ID' if receive else 'ID'}, command.to_bytes())")
        return "\n".join(lines)

    def _rust(self, message: Message, node: Node, shown: Field | None, receive: bool, send: bool) -> str:
        name = rust.type_name(message, node)
        field = rust.field_name(shown, node) if shown else ""
        physical = rust.physical_name(shown, field) if shown else ""
        scaled = shown is not None and shown.scale is not None
        lines = [f"use {CRATE}::{node.name}::{name};"]
        enum = shown.enum if shown and shown.enum and shown.enum.members and send else None
        if enum is not None:
            lines.append(f"use {CRATE}::{enum.node}::enums::{rust.type_name(enum, self.icd.node(enum.node))};")
        if receive:
            lines += ["", f"let {'message' if shown else '_message'} = {name}::from_bytes(buffer)?;"]
            if shown:
                lines.append(f"let {field} = message.{f'{physical}()' if scaled else field};")
        if send:
            change = "mut " if shown else ""
            lines += ["", f"let {change}command = {name}::default();"]
            if shown and scaled:
                lines.append(f"command.set_{physical}(0.0)?;   // refuses what does not fit")
            elif shown and enum is not None:
                owner = self.icd.node(enum.node)
                variant = rust.variant_name(enum.members[-1], owner)
                lines.append(f"command.{field} = {rust.type_name(enum, owner)}::{variant}.into();")
            elif shown and shown.enum is None:
                lines.append(
                    f"command.{field} = {'true' if shown.type == 'bool' else '0.0' if shown.type == 'float' else '0'};"
                )
            narrow = any(fields.is_narrow(one, self.enums) for one in message.fields)
            lines.append(
                f"send({name}::{'SET_ID' if receive else 'ID'}, &command.{'try_to_bytes()?' if narrow else 'to_bytes()'});"
            )
        return "\n".join(lines)


def _worth_showing(message: Message) -> Field | None:
    """The first field with a scale, else the first that is neither constant nor a byte array."""
    usual = [field for field in message.fields if field.const is None and field.type != "bytes"]
    return next((field for field in usual if field.scale is not None), usual[0] if usual else None)
