"""One message -> the values of its template."""

from __future__ import annotations

from icdgen.backends.lines import bracketed, exploded
from icdgen.backends.python import names
from icdgen.backends.python.fields import row, scaled
from icdgen.backends.python.packing import Packer
from icdgen.backends.python.text import WIDTH, docstring, literal, paragraph, prose
from icdgen.describe import EnumDescription, FieldDescription, MessageDescription
from icdgen.describe.numbers import byte_count

STEP = "    "


def values(message: MessageDescription) -> dict[str, object]:
    """What the message template needs."""
    packing = Packer(message).packing()
    defaults: dict[str, str] = {}
    rows = [row(field, _default(field, defaults)) for field in message.fields]
    one, name = message.model, names.class_name(message)
    ids = " and ".join(map(str, one.ids))
    return {
        "name": name,
        "module_doc": docstring(0, [f"{prose(one.name)}, {one.kind} {ids} of {prose(message.node.title)}."]),
        "doc": docstring(4, map(paragraph, message.comment.paragraphs)),
        "imports": _imports(message, packing.floats),
        "format": packing.format,
        "tables": [*packing.tables, *(f"{name} = {call}" for call, name in defaults.items())],
        "slots": exploded("(", [f'"{field.name}"' for field in message.fields], ")", STEP),
        "constants": _constants(message),
        "infos": exploded("(", [one.info for one in rows], ")", STEP) if rows else "",
        "fields": rows,
        "scaled": [scaled(field) for field in message.fields if field.steps is not None],
        "init": exploded("def __init__(", ["self", "*", *(r.parameter for r in rows)], ") -> None:", STEP),
        "from_physical": exploded(
            "def from_physical(", ["cls", "*", *(r.physical_parameter for r in rows)], f") -> {name}:", STEP
        ),
        "from_bytes": bracketed("def from_bytes(", ["cls", "data: _base.Buffer"], f") -> {name}:", WIDTH, STEP),
        "length": byte_count(one.length),
        "packing": packing,
    }


def _default(field: FieldDescription, defaults: dict[str, str]) -> str:
    """What a field is at first; constants of the module are kept in ``defaults``."""
    kind, value = field.model.type, field.fresh
    if kind == "bytes":
        return _constant(defaults, f"bytes({field.model.bits // 8})")
    if field.enum is None:
        return str(bool(value)) if kind == "bool" else "0.0" if kind == "float" else str(value)
    name, member = names.class_name(field.enum), field.enum.member(value)
    return f"{name}.{member.name.upper()}" if member else _constant(defaults, f"_codec.unnamed({name}, {value})")


def _constant(defaults: dict[str, str], call: str) -> str:
    return defaults.setdefault(call, f"_DEFAULT_{len(defaults)}")


def _constants(message: MessageDescription) -> list[str]:
    one, node = message.model, message.node
    found = [f'NODE = "{node.name}"', f"NAME = {literal(one.name)}", f'KIND = "{one.kind}"']
    found += (f"{id.name.upper()} = {id.value}" for id in message.ids)
    ids = ", ".join(id.name.upper() for id in message.ids)
    found.append(f"IDS = ({ids}{',' if len(message.ids) == 1 else ''})")
    found.append(f"LENGTH = {one.length}")
    if one.table is not None:
        found.append(f"TABLE = {one.table}")
    if not one.acknowledge:
        found.append("ACKNOWLEDGED = False")
    if node.byte_order != "little":
        found.append(f'BYTE_ORDER = "{node.byte_order}"')
    if node.bit_order != "lsb0":
        found.append(f'BIT_ORDER = "{node.bit_order}"')
    return found


def _imports(message: MessageDescription, floats: bool) -> list[str]:
    enums = {field.enum for field in message.fields if field.enum is not None}
    lines = [_import(enum, message) for enum in enums]
    return [f"from ... import _base, _codec{', _floats' if floats else ''}", *sorted(lines)]


def _import(enum: EnumDescription, message: MessageDescription) -> str:
    module = names.module_name(enum)
    if enum.node is not message.node:
        module = f"..{enum.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {names.class_name(enum)}"
