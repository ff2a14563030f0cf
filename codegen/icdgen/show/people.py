"""ICDs as text: the nodes, one node's messages, one message, enumeration or erratum."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from icdgen.describe.errata import errata_of_enum, errata_of_message
from icdgen.describe.ids import id_text, pair_bytes
from icdgen.describe.numbers import length_text
from icdgen.describe.shared_ids import sharing
from icdgen.icd.erratum import Erratum
from icdgen.icd.lines import lines as icd_lines
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Enum, Icd, Message, Node, Struct
from icdgen.icd.places import scalars_in
from icdgen.icd.rules.wording import count
from icdgen.icd.variants import ids_of
from icdgen.icd.wire_ids import DEFAULT_BITS, size
from icdgen.protocol import facts as protocol_facts
from icdgen.show.fields import field_table
from icdgen.tables import Column, clean, render
from icdgen.values.errors import NotFound
from icdgen.values.find import by_name, describe, find_message, find_named, find_node

_FIGURES = ("type", "version", "commands", "telemetry", "settings", "fields", "errata", "notes")
_NODES = [
    Column("node", fixed=True),
    Column("title"),
    *(Column(title, right=True, fixed=True) for title in _FIGURES),
    Column("includes"),
]
_MESSAGES = [
    Column("id", right=True, fixed=True),
    Column("kind"),
    Column("name"),
    *(Column(title, right=True, fixed=True) for title in ("bytes", "fields", "table")),
    Column("group"),
    Column("of"),
]


def to_text(icd: Icd, selection: Sequence[str] = (), width: int | None = None, kind: str | None = None) -> str:
    """Without a selection the nodes; of one node its messages; of a node and a name or id that message.

    The second name may also be an enumeration, a struct or an erratum's id; the node need not be named if it is the only one.
    ``width`` is that of the terminal, None for a pipe.
    Raises `NotFound` or `Ambiguous`.
    """
    if not selection:
        return _nodes(icd, width)
    if len(selection) > 1:
        return _one(icd, find_node(icd, selection[0]), selection[1], width, kind)
    node, items = find_named(icd, selection)
    return _one(icd, node, items[0], width, kind) if items else _node(icd, node, width, kind)


def _nodes(icd: Icd, width: int | None) -> str:
    rows = [
        (
            node.name,
            node.title,
            _number(node.node_type),
            _number(node.interface_version),
            *(str(sum(m.kind == kind for m in node.messages)) for kind in (TELECOMMAND, TELEMETRY, CONFIGURATION)),
            str(sum(map(_field_count, node.messages))),
            str(sum(not e.is_note for e in node.errata)),
            str(sum(e.is_note for e in node.errata)),
            ", ".join(node.includes),
        )
        for node in icd.nodes
    ]
    return render(_NODES, rows, width)


def _node(icd: Icd, node: Node, width: int | None, kind: str | None) -> str:
    facts = [
        f"node type {node.node_type}" if node.node_type is not None else "",
        f"interface version {node.interface_version}" if node.interface_version is not None else "",
        f"{node.byte_order}-endian, {node.bit_order}",
        f"ids of {node.id_bits} bits" if node.id_bits != DEFAULT_BITS else "",
        f"includes {', '.join(node.includes)}" if node.includes else "",
        _count(node),
    ]
    text = _lines([f"{node.name}: {node.title}", "; ".join(filter(None, facts)), node.summary], width)
    form = protocol_facts.of(icd, node).stream
    messages = [m for m in icd.messages_of(node) if kind in (None, m.kind)]
    messages.sort(key=lambda m: m.node != node.name)  # its own first
    rows = [
        (
            "/".join(id_text(form, id) for id in m.ids),
            m.kind,
            m.name,
            str(m.layout.longest) if len(m.layout.lengths) == 1 else f"{m.layout.shortest} to {m.layout.longest}",
            str(_field_count(m)),
            _number(m.table),
            m.group,
            m.node if m.node != node.name else "",
        )
        for m in messages
    ]
    text += "\n" + render(_MESSAGES, rows, width) if rows else ""
    if node.enums:
        text += "\n" + _lines([f"Enumerations: {', '.join(e.name for e in node.enums)}"], width)
    missing = [f"Missing: {m.kind} {id_text(form, m.id)} {m.name}. {m.why}" for m in node.missing]
    return text + ("\n" + _lines(missing, width) if missing else "")


def _one(icd: Icd, node: Node, name: str, width: int | None, kind: str | None) -> str:
    try:
        return _message(icd, node, find_message(icd, node.name, name, kind), width)
    except NotFound:
        family = (*icd.included(node), node)
        texts = (
            [_enum(enum, width) for enum in by_name([e for n in family for e in n.enums], name, node.vocabulary)]
            or [
                _struct(struct, icd.node(struct.node), width)
                for struct in by_name([s for n in family for s in n.structs], name, node.vocabulary)
            ]
            or [
                _erratum(erratum, width)
                for n in family
                for erratum in n.errata
                if erratum.id.casefold() == name.casefold()
            ]
        )
        if not texts:
            raise
        return "\n".join(texts)


def _field_count(message: Message) -> int:
    """Return the number of fields, each element of an array by itself."""
    return sum(not field.is_count for field in scalars_in(message.layout))


def _struct(struct: Struct, node: Node, width: int | None) -> str:
    facts = ["struct", count(struct.length, "byte"), f"table {struct.table}" if struct.table else ""]
    lines = [f"{node.name}: {struct.name}", "; ".join(filter(None, facts)), struct.summary]
    lines += [f"Also called {', '.join(struct.aliases)}."] if struct.aliases else []
    return _lines(lines, width) + "\n" + field_table(struct, node, width)


def _message(icd: Icd, asked: Node, message: Message, width: int | None) -> str:
    node, form = icd.node(message.node), protocol_facts.of(icd, asked).stream
    # An id that is written as its bytes, `01 35`, is hexadecimal already.
    in_hex = "/".join(f"{i:0{2 * size(node.id_bits)}X}" for i in message.ids)
    facts = [
        describe(message, form) + ("" if pair_bytes(form) else f" (hex {in_hex})"),
        length_text(message),
        f"the last {message.reserved} reserved" if message.reserved else "",
        f"table {message.table}" if message.table else "",
        f"page {message.page}" if message.page else "",
        message.group,
        (
            ""
            if message.acknowledge
            else "restarts instead of acknowledging" if message.expects_reset else "not acknowledged"
        ),
    ]
    lines = [f"{node.name}: {message.name}", "; ".join(filter(None, facts)), message.summary]
    lines += [f"Also called {', '.join(message.aliases)}."] if message.aliases else []
    lines += [f"Dangerous: {message.hazard}"] if message.hazard else []
    lines += filter(None, [sharing(ids_of(icd, node), message)])
    lines += [f"From bit {part.at} it repeats {part.message}." for part in message.contains]
    table = field_table(message, node, width)
    enums = [_enum(enum, width) for enum in dict.fromkeys(line.enum for line in icd_lines(message.layout) if line.enum)]
    errata = [_erratum(erratum, width) for erratum in errata_of_message(message)]
    return "\n".join([_lines(lines, width), *filter(None, [table]), *enums, *errata])


def _enum(enum: Enum, width: int | None) -> str:
    head = f"{enum.name} (enumeration" + (f", table {enum.table})" if enum.table else ")")
    members = [(m.values, ", ".join((m.name, *m.aliases)), m.summary) for m in enum.members]
    table = render([Column("value", right=True, fixed=True), Column("name"), Column("meaning")], members, width)
    errata = "".join("\n" + _erratum(e, width) for e in errata_of_enum(enum))
    aliases = f"Also called {', '.join(enum.aliases)}." if enum.aliases else ""
    return _lines([head, enum.summary, aliases], width) + table + errata


def _count(node: Node) -> str:
    notes = sum(e.is_note for e in node.errata)
    counts = ((len(node.errata) - notes, "erratum", "errata"), (notes, "note", "notes"))
    return ", ".join(f"{number} {singular if number == 1 else plural}" for number, singular, plural in counts if number)


def _erratum(erratum: Erratum, width: int | None) -> str:
    lines = [f"{erratum.label} {erratum.id}{erratum.sureness}: {erratum.title}", erratum.why, erratum.evidence]
    if erratum.changes:
        printed = dict(erratum.printed)
        changes = [f"{key} {_value(printed.get(key))} -> {_value(held)}" for key, held in erratum.held]
        lines.append(f"Printed and held: {', '.join(changes)}")
    if erratum.tables:
        lines.append(f"Tables: {', '.join(map(str, erratum.tables))}")
    head, *others = filter(None, lines)
    return _lines([head], width) + _lines(others, width, "  ")


def _lines(lines: Sequence[str], width: int | None, indent: str = "") -> str:
    """Paragraphs, wrapped to a terminal; empty ones left out."""
    text = ""
    for line in map(clean, filter(None, lines)):
        wrapped = [line] if width is None else textwrap.wrap(line, max(width - len(indent), 20)) or [line]
        text += "".join(f"{indent}{line}\n" for line in wrapped)
    return text


def _number(value: int | None) -> str:
    return "" if value is None else str(value)


def _value(value: object) -> str:
    if value is None:
        return "(absent)"
    return str(value).lower() if isinstance(value, bool) else str(value)
