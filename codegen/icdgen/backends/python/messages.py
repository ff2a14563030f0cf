"""One message -> the values of its template."""

from __future__ import annotations

from icdgen.backends.python import names
from icdgen.backends.python.black import assignment, bracketed, by_module, definition, display, imported
from icdgen.backends.python.fields import Row, row, scaled
from icdgen.backends.python.plan import Planner
from icdgen.backends.python.text import docstring, literal, prose, sentence
from icdgen.icd.model import Field, Icd, Message, Node


class EnumNames:
    """The classes of the enumerations that a message uses, and where they are."""

    def __init__(self, icd: Icd) -> None:
        self.of: dict[int, str] = {}
        self.homes: dict[int, tuple[str, str]] = {}  # node, module
        self.defaults: dict[int, dict[int, str]] = {}
        for node in icd.nodes:
            for enum in node.enums:
                self.of[id(enum)] = names.class_name(enum, node)
                self.homes[id(enum)] = node.name, names.module_name(enum, node)
                self.defaults[id(enum)] = {m.value: names.member(m, node) for m in reversed(enum.members)}


def values(message: Message, node: Node, enums: EnumNames) -> dict[str, object]:
    """What the message template needs."""
    attributes = [names.attribute(field, node) for field in message.fields]
    plan = Planner(message, node, attributes, enums.of).plan()
    rows, defaults = [], {}
    for field, attribute in zip(message.fields, attributes, strict=True):
        enum = enums.of[id(field.enum)] if field.enum else ""
        rows.append(row(field, attribute, enum, _default_member(field, enum, enums, defaults)))
    name = names.class_name(message, node)
    properties = [scaled(f, a) for f, a in zip(message.fields, attributes, strict=True) if f.scale]
    return {
        "head": bracketed(0, f"class {name}(", ["_base.Message"], "):"),
        "module_doc": docstring(0, [_headline(message, node)]),
        "doc": docstring(4, _documentation(message)),
        "imports": _imports(message, node, enums, plan.floats),
        "struct": bracketed(0, "_STRUCT = struct.Struct(", [f'"{plan.format}"'], ")"),
        "tables": [
            *plan.tables,
            *(bracketed(0, f"{name} = {call[0]}", call[1:], ")") for call, name in defaults.items()),
        ],
        "slots": display(4, "__slots__ = (", [f'"{a}"' for a in attributes], ")").lstrip(),
        "constants": _constants(message, node),
        "infos": _infos(rows),
        "fields": rows,
        "scaled": properties,
        "init": _signature("def __init__(", "self", [r.parameter for r in rows], ") -> None:"),
        "from_physical": _signature("def from_physical(", "cls", [r.physical_parameter for r in rows], f") -> {name}:"),
        "from_bytes": definition(4, "def from_bytes(", ["cls", "data: _base.Buffer"], f") -> {name}:"),
        "length": f"{message.length} byte{'s' if message.length != 1 else ''}",
        "unpack": plan.unpack,
        "assign": plan.assign,
        "prepare": plan.prepare,
        "pack": plan.pack,
    }


def _default_member(field: Field, enum: str, enums: EnumNames, defaults: dict[tuple[str, ...], str]) -> str:
    """What an enum or bytes field is by default; constants of the module are kept in ``defaults``."""
    if field.type == "bytes":
        return _constant(defaults, "bytes(", str(field.bits // 8))
    if not enum:
        return ""
    value = field.const or 0
    member = enums.defaults[id(field.enum)].get(value)
    if member:
        return f"{enum}.{member}"
    return _constant(defaults, "_codec.unnamed(", enum, str(value))


def _constant(defaults: dict[tuple[str, ...], str], *call: str) -> str:
    return defaults.setdefault(call, f"_DEFAULT_{len(defaults)}")


def _infos(rows: list[Row]) -> str:
    if not rows:
        return ""
    return display(4, "FIELDS = (", [r.info for r in rows], ")")


def _signature(head: str, first: str, parameters: list[str], tail: str) -> str:
    return definition(4, head, [first, "*", *parameters], tail)


def _headline(message: Message, node: Node) -> str:
    ids = " and ".join(str(i) for i in message.ids)
    return f"{prose(message.name)}, {message.kind} {ids} of {prose(node.title)}."


def _documentation(message: Message) -> list[str]:
    table = f", table {message.table}" if message.table is not None else ""
    size = f"{message.length} byte{'s' if message.length != 1 else ''}"
    if message.kind == "configuration":
        ids = f"set by telecommand {message.set_id}, got by telemetry {message.get_id}"
    else:
        ids = f"{message.kind} {message.id}"
    paragraphs = [f"{prose(message.name)}: {ids}, {size}{table}."]
    if message.summary:
        paragraphs.append(sentence(message.summary))
    if message.expects_reset:
        paragraphs.append("The node restarts instead of acknowledging it.")
    elif not message.acknowledge:
        paragraphs.append("The node does not acknowledge it.")
    for part in message.contains:
        paragraphs.append(f"Repeats `{prose(part.message)}` from bit {part.at}.")
    for erratum in message.errata:
        paragraphs.append(f"{erratum.label} {prose(erratum.id)}: {sentence(erratum.title)}")
    return paragraphs


def _constants(message: Message, node: Node) -> list[str]:
    found = [f'NODE = "{node.name}"', assignment(4, "NAME", literal(message.name)).lstrip(), f'KIND = "{message.kind}"']
    if message.kind == "configuration":
        found += [f"SET_ID = {message.set_id}", f"GET_ID = {message.get_id}", "IDS = (SET_ID, GET_ID)"]
    else:
        found += [f"ID = {message.id}", "IDS = (ID,)"]
    found.append(f"LENGTH = {message.length}")
    if message.table is not None:
        found.append(f"TABLE = {message.table}")
    if not message.acknowledge:
        found.append("ACKNOWLEDGED = False")
    if node.byte_order != "little":
        found.append(f'BYTE_ORDER = "{node.byte_order}"')
    if node.bit_order != "lsb0":
        found.append(f'BIT_ORDER = "{node.bit_order}"')
    return found


def _imports(message: Message, node: Node, enums: EnumNames, floats: bool) -> list[str]:
    found = [f"from ... import _base, _codec{', _floats' if floats else ''}"]
    wanted = {id(f.enum): f.enum for f in message.fields if f.enum}
    homes = sorted((enums.homes[key][0] == node.name, *enums.homes[key], enums.of[key]) for key in wanted)
    lines = [(f".{module}" if own else f"...{home}.{names.TYPES}.{module}", name) for own, home, module, name in homes]
    return found + [imported(0, source, name) for source, name in sorted(lines, key=by_module)]
