"""A message -> everything that its module says, as finished strings."""

from __future__ import annotations

import re
from typing import NamedTuple

from icdgen.backends.rust import comments, constants, fields, names, scales
from icdgen.backends.rust.names import Enums
from icdgen.backends.rust.text import LITERAL_WIDTH, WIDTH, doc, integer, prose, rhs, string
from icdgen.icd.model import Field, Message, Node


_CALL = re.compile(r"([A-Za-z_0-9:]+)\((.+)\)\Z")  # a call of one argument around everything


class Scaled(NamedTuple):
    """The physical accessors of a field."""

    getter: str  # name
    setter: str
    doc: str
    set_doc: str
    signature: str
    body: str
    set_signature: str
    set_body: str


class Checked(NamedTuple):
    """The support module's entry of a scaled or narrow field."""

    name: str
    field: str
    type: str
    min: str
    max: str
    factor: str
    offset: str
    divisor: str


class FieldRow(NamedTuple):
    """A field of the struct."""

    model: Field
    name: str
    constant: str
    type: str
    doc: str
    declaration: str
    serde: bool  # whether serde needs help with it
    reading: str
    writing: list[str]
    default: str


class MessageRow:
    """What the template of a message is given."""

    def __init__(self, message: Message, node: Node, enums: Enums, id_type: str) -> None:
        self.message, self.node = message, node
        self.type = names.type_name(message, node)
        self.module = names.file_name(message, node)
        self.doc = doc(comments.message(message))
        self.head = doc([f"{prose(message.name)}, a message of node `{node.name}`."], mark="//!")
        self.name = string(message.name)
        self.length = message.length
        self.ids = constants.ids(message, id_type)
        tables = fields.flag_tables(message.fields, node)
        self.tables = sorted(tables)
        self.fields = [_row(field, node, enums, tables) for field in message.fields]
        narrow = [fields.is_narrow(field, enums) for field in message.fields]
        self.fallible = any(narrow)
        self.scaled = [_scaled(row, node) for row in self.fields if row.model.scale is not None]
        self.checked = [_checked(row, enums) for row, thin in zip(self.fields, narrow, strict=True) if thin or row.model.scale]
        self.constants = [one for field in message.fields for one in constants.of_field(field, node)]
        self.literal = _literal([(row.name, row.reading) for row in self.fields])
        plain = all(row.model.const in (None, 0) and (row.model.type != "bytes" or row.model.bits <= 256) for row in self.fields)
        self.default = None if plain else _literal([(row.name, row.default) for row in self.fields])
        floats = any(field.type == "float" for field in message.fields)
        derived = ["Clone", "Copy", "Debug"] + (["Default"] if plain else []) + ["PartialEq"] + ([] if floats else ["Eq", "Hash"])
        self.derives = ", ".join(derived)
        self.floats = floats
        self.imports = _imports(self)
        self.uses_enums = any(f"{names.ENUMS_MODULE}::" in row.type and "crate::" not in row.type for row in self.fields)


def _row(field: Field, node: Node, enums: Enums, tables: set[int]) -> FieldRow:
    name = names.field_name(field, node)
    constant = name.upper()
    kind = fields.raw_type(field, node, enums)
    return FieldRow(
        model=field,
        name=name,
        constant=constant,
        type=kind,
        doc=doc(comments.field(field), "    "),
        declaration=rhs("    ", f"pub {name}:", kind, ","),
        serde=field.type == "bytes",
        reading=fields.reading(field, node, enums, tables),
        writing=fields.writing(field, node, enums, name, constant),
        default=_default(field, kind),
    )


def _default(field: Field, kind: str) -> str:
    if field.type == "bytes":
        return f"[0; {field.bits // 8}]"
    value = field.const or 0
    if field.type == "enum":
        return f"{kind}::from({integer(value)})" if value else f"{kind}::default()"
    if field.type == "float":
        return "0.0"
    return ("true" if value else "false") if field.type == "bool" else integer(value)


def _literal(rows: list[tuple[str, str]]) -> str:
    """``Self { ... }`` in the body of a function."""
    if not rows:
        return "        Self {}"
    inline = ", ".join(f"{name}: {value}" for name, value in rows)
    if len(inline) <= LITERAL_WIDTH and "\n" not in inline:
        return f"        Self {{ {inline} }}"
    lines = "\n".join(_entry(name, value) for name, value in rows)
    return f"        Self {{\n{lines}\n        }}"


def _entry(name: str, value: str) -> str:
    line = f"            {name}: {value},"
    if "\n" in value or len(line) <= WIDTH:
        return line
    called = _CALL.match(value)
    if called is None:
        return f"            {name}:\n                {value},"
    return f"            {name}: {{\n                let value = {called[2]};\n                {called[1]}(value)\n            }},"


def _scaled(row: FieldRow, node: Node) -> Scaled:
    field, name = row.model, row.name
    getter = names.physical_name(field, node)
    unit = f" in {prose(field.unit.symbol)}" if field.unit else ", as a physical value"
    span = scales.physical_range(field.scale, field.raw_min, field.raw_max)
    setter = f"set_{getter}"
    source, before = f"self.{name}", ""
    if len(name) > fields.LONG_NAME:
        source, before = "raw", "\n".join((rhs("        ", "let raw =", f"self.{name}", ";"), ""))
    set_body = f"        self.{name} = {row.constant}.raw(value)?;"
    if len(set_body) > WIDTH - 10:
        set_body = f"        let raw = {row.constant}.raw(value)?;\n        self.{name} = raw;"
    return Scaled(
        getter,
        setter,
        doc([f"{prose(field.name)}{unit}: {span}."], "    "),
        doc([f"Sets {prose(field.name)}{unit}, to the nearest raw value, ties to even."], "    "),
        signature(f"pub fn {getter}", ("&self",), "f64"),
        f"{before}        {scales.getter(field, source, row.constant)}",
        signature(f"pub fn {setter}", ("&mut self", "value: f64"), "Result<(), Error>"),
        set_body,
    )


def signature(start: str, parameters: tuple[str, ...], returns: str, indent: str = "    ") -> str:
    """A function's head, up to its opening brace."""
    line = f"{indent}{start}({', '.join(parameters)}) -> {returns} {{"
    if len(line) <= WIDTH:
        return line
    inner = "".join(f"{indent}    {parameter},\n" for parameter in parameters)
    return f"{indent}{start}(\n{inner}{indent}) -> {returns} {{"


def _checked(row: FieldRow, enums: Enums) -> Checked:
    field = row.model
    line = scales.linear(field.scale)
    kind = f"u{enums.storage(field.enum)}" if field.type == "enum" else names.integer_type(field)
    low, high = integer(field.raw_min), integer(field.raw_max)
    return Checked(row.constant, string(field.name), kind, low, high, *map(integer, line))


def _imports(row: MessageRow) -> str:
    wanted = []
    if row.tables:
        wanted.append("flags")
    if any("take(" in one.reading for one in row.fields):
        wanted.append("take")
    wanted.append("Error")
    if row.checked:
        wanted.append("Scale")
    return f"{{{', '.join(wanted)}}}" if len(wanted) > 1 else wanted[0]
