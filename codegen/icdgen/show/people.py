"""Text form of ICDs: the nodes, the messages of a node, or a message, enumeration,
struct or erratum.

`to_text` takes an ICD and the words of a selection and returns text with tables for
``icdgen show``. A message has precedence over other items of the same name. ``fields``
has the table of fields, and ``machine`` the JSON form, which contains everything.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence

from icdgen.describe.errata import errata_of_enum, errata_of_message
from icdgen.describe.ids import id_text, pair_bytes
from icdgen.describe.numbers import length_text
from icdgen.describe.shared_ids import sharing_sentence
from icdgen.icd.erratum import Erratum
from icdgen.icd.lines import lines as icd_lines
from icdgen.icd.located import yaml_text
from icdgen.icd.model import (
    CONFIGURATION,
    TELECOMMAND,
    TELEMETRY,
    Enum,
    Icd,
    Message,
    Node,
    Struct,
    framed_link,
)
from icdgen.icd.responses import ACK, BUSY, NAK, PROGRESS, REPLY, declared_responses
from icdgen.icd.variants import ids_of
from icdgen.icd.wire_ids import DEFAULT_BITS, size
from icdgen.protocol import facts as protocol_facts
from icdgen.show.fields import field_table
from icdgen.tables import Column, printable_text, render_table
from icdgen.values.errors import NotFound
from icdgen.values.find import (
    find_message,
    find_named,
    find_node,
    items_by_name,
    kind_and_ids,
)
from icdgen.wording import count

_RESPONSES = {
    ACK: "confirmed by",
    REPLY: "answered with",
    NAK: "refused by",
    BUSY: "busy:",
    PROGRESS: "in progress:",
}
_FIGURES = (
    "type",
    "version",
    "commands",
    "telemetry",
    "settings",
    "fields",
    "errata",
    "notes",
)
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


def to_text(
    icd: Icd,
    selection: Sequence[str] = (),
    width: int | None = None,
    kind: str | None = None,
) -> str:
    """Return the text of a selection: empty for all nodes, a node, or a node and an
    item of it.

    The item is a message (by name or id), an enumeration, a struct or the id of an
    erratum. The node can be omitted if there is only one. ``width`` is the width of the
    terminal, None for a pipe. Raises `NotFound` or `Ambiguous`.
    """
    if not selection:
        return _nodes(icd, width)
    if len(selection) > 1:
        return _item(icd, find_node(icd, selection[0]), selection[1], width, kind)
    node, items = find_named(icd, selection)
    if items:
        return _item(icd, node, items[0], width, kind)
    return _node(icd, node, width, kind)


def _nodes(icd: Icd, width: int | None) -> str:
    """Return the table of all nodes."""
    return render_table(_NODES, [_row_of_node(node) for node in icd.nodes], width)


def _row_of_node(node: Node) -> tuple[str, ...]:
    kinds = Counter(message.kind for message in node.messages)
    return (
        node.name,
        node.title,
        _number(node.node_type),
        _number(node.interface_version),
        *(str(kinds[kind]) for kind in (TELECOMMAND, TELEMETRY, CONFIGURATION)),
        str(sum(message.field_count for message in node.messages)),
        str(sum(not erratum.is_note for erratum in node.errata)),
        str(sum(erratum.is_note for erratum in node.errata)),
        ", ".join(node.includes),
    )


def _node(icd: Icd, node: Node, width: int | None, kind: str | None) -> str:
    """Return the head of a node and the table of its messages, own messages first."""
    facts = []
    if node.node_type is not None:
        facts.append(f"node type {node.node_type}")
    if node.interface_version is not None:
        facts.append(f"interface version {node.interface_version}")
    facts.append(f"{node.byte_order}-endian, {node.bit_order}")
    if node.id_bits != DEFAULT_BITS:
        facts.append(f"ids of {node.id_bits} bits")
    if node.includes:
        facts.append(f"includes {', '.join(node.includes)}")
    facts.append(_count(node))
    text = _lines(
        [f"{node.name}: {node.title}", "; ".join(filter(None, facts)), node.summary],
        width,
    )
    form = protocol_facts.of(icd, node).stream
    messages = [
        message for message in icd.messages_of(node) if kind in (None, message.kind)
    ]
    # Own messages first. The sort is stable, so each group keeps its order.
    messages.sort(key=lambda message: message.node != node.name)
    rows = []
    for message in messages:
        layout = message.layout
        lengths = str(layout.longest)
        if len(layout.lengths) > 1:
            lengths = f"{layout.shortest} to {layout.longest}"
        rows.append(
            (
                "/".join(id_text(form, id) for id in message.ids),
                message.kind,
                message.name,
                lengths,
                str(message.field_count),
                _number(message.table),
                message.group,
                message.node if message.node != node.name else "",
            )
        )
    text += "\n" + render_table(_MESSAGES, rows, width) if rows else ""
    if node.enums:
        text += "\n" + _lines(
            [f"Enumerations: {', '.join(enum.name for enum in node.enums)}"], width
        )
    missing = [
        f"Missing: {item.kind} {id_text(form, item.id)} {item.name}. {item.why}"
        for item in node.missing
    ]
    return text + ("\n" + _lines(missing, width) if missing else "")


def _item(icd: Icd, node: Node, name: str, width: int | None, kind: str | None) -> str:
    """Return a message, or else the enumerations, structs or errata of a name.

    Raises `NotFound` or `Ambiguous`.
    """
    # A message has precedence. If several messages match, `Ambiguous` is raised, and
    # nothing else is searched.
    try:
        return _message(icd, node, find_message(icd, node.name, name, kind), width)
    except NotFound:
        enums: list[Enum] = []
        structs: list[Struct] = []
        errata: list[Erratum] = []
        for owner in (*icd.included(node), node):
            enums += owner.enums
            structs += owner.structs
            errata += owner.errata
        enums = items_by_name(enums, name, node.vocabulary)
        structs = items_by_name(structs, name, node.vocabulary)
        errata = [each for each in errata if each.id.casefold() == name.casefold()]
        if enums:
            texts = [_enum(enum, width) for enum in enums]
        elif structs:
            texts = [
                _struct(struct, icd.node(struct.node), width) for struct in structs
            ]
        elif errata:
            texts = [_erratum(erratum, width) for erratum in errata]
        else:
            raise
        return "\n".join(texts)


def _struct(struct: Struct, node: Node, width: int | None) -> str:
    """Return a struct with the table of its fields."""
    facts = [
        "struct",
        count(struct.length, "byte"),
        f"table {struct.table}" if struct.table else "",
    ]
    lines = [
        f"{node.name}: {struct.name}",
        "; ".join(filter(None, facts)),
        struct.summary,
    ]
    lines += [f"Also called {', '.join(struct.aliases)}."] if struct.aliases else []
    return _lines(lines, width) + "\n" + field_table(struct, node, width)


def _message(icd: Icd, selected: Node, message: Message, width: int | None) -> str:
    """Return a message with the table of its fields, its enumerations and errata.

    ``selected`` or an include declares it.
    """
    node, form = icd.node(message.node), protocol_facts.of(icd, selected).stream
    # An id that is written as its bytes, `01 35`, is hexadecimal already.
    in_hex = "/".join(f"{id:0{2 * size(node.id_bits)}X}" for id in message.ids)
    facts = [
        kind_and_ids(message, form) + ("" if pair_bytes(form) else f" (hex {in_hex})"),
        length_text(message),
        f"the last {message.reserved} reserved" if message.reserved else "",
        f"table {message.table}" if message.table else "",
        f"page {message.page}" if message.page else "",
        message.group,
        f"sent every {message.period_ms} ms" if message.period_ms else "",
        *_outcomes(icd, selected, message),
    ]
    lines = [
        f"{node.name}: {message.name}",
        "; ".join(filter(None, facts)),
        message.summary,
    ]
    lines += [f"Also called {', '.join(message.aliases)}."] if message.aliases else []
    lines += [f"Dangerous: {message.hazard}"] if message.hazard else []
    lines += filter(None, [sharing_sentence(ids_of(icd, node), message)])
    lines += [
        f"From bit {part.at} it repeats {part.message}." for part in message.contains
    ]
    table = field_table(message, node, width)
    # Each enumeration once, in the order of its first field.
    used = dict.fromkeys(line.enum for line in icd_lines(message.layout) if line.enum)
    enums = [_enum(enum, width) for enum in used]
    errata = [_erratum(erratum, width) for erratum in errata_of_message(message)]
    return "\n".join([_lines(lines, width), *filter(None, [table]), *enums, *errata])


def _outcomes(icd: Icd, selected: Node, message: Message) -> list[str]:
    """Return what responds to a telecommand, in words; empty for the default of links
    without header and trailer, an acknowledge.
    """
    protocol = icd.protocol_of(selected)
    if not framed_link(protocol) or message.telecommand_id is None:
        if message.acknowledge:
            return []
        restarts = message.expects_reset
        return ["restarts instead of acknowledging" if restarts else "not acknowledged"]
    commands = protocol["link"].get("commands", {})
    responses = declared_responses(commands, message)
    texts = [
        f"{_RESPONSES[kind]} {row.get('message') or 'packet ' + row['packet']}"
        for kind, row in responses.items()
    ]
    repeat = ["may be sent again after a time-out"] if message.repeat else []
    return [", ".join(texts) or "no response", *repeat]


def _enum(enum: Enum, width: int | None) -> str:
    """Return an enumeration with the table of its members, and its errata."""
    table_of_manual = f", table {enum.table}" if enum.table else ""
    head = f"{enum.name} (enumeration{table_of_manual})"
    members = [
        (member.values, ", ".join((member.name, *member.aliases)), member.summary)
        for member in enum.members
    ]
    table = render_table(
        [Column("value", right=True, fixed=True), Column("name"), Column("meaning")],
        members,
        width,
    )
    errata = "".join(
        "\n" + _erratum(erratum, width) for erratum in errata_of_enum(enum)
    )
    aliases = f"Also called {', '.join(enum.aliases)}." if enum.aliases else ""
    return _lines([head, enum.summary, aliases], width) + table + errata


def _count(node: Node) -> str:
    """Return the numbers of errata and notes of a node in words."""
    notes = sum(erratum.is_note for erratum in node.errata)
    counts = ((len(node.errata) - notes, "erratum", "errata"), (notes, "note", "notes"))
    return ", ".join(
        f"{number} {singular if number == 1 else plural}"
        for number, singular, plural in counts
        if number
    )


def _erratum(erratum: Erratum, width: int | None) -> str:
    """Return an erratum or note with its changes."""
    lines = [
        f"{erratum.label} {erratum.id}{erratum.sureness}: {erratum.title}",
        erratum.why,
        erratum.evidence,
    ]
    if erratum.changes:
        printed = dict(erratum.printed)
        changes = [
            f"{key} {yaml_text(printed.get(key))} -> {yaml_text(value)}"
            for key, value in erratum.held
        ]
        lines.append(f"Printed and held: {', '.join(changes)}")
    if erratum.tables:
        lines.append(f"Tables: {', '.join(map(str, erratum.tables))}")
    head, *indented = filter(None, lines)
    return _lines([head], width) + _lines(indented, width, "  ")


def _lines(lines: Sequence[str], width: int | None, indent: str = "") -> str:
    """Return paragraphs, wrapped to the width of a terminal; empty paragraphs are
    omitted.
    """
    text = ""
    for paragraph in map(printable_text, filter(None, lines)):
        wrapped = [paragraph]
        if width is not None:
            wrapped = textwrap.wrap(paragraph, max(width - len(indent), 20)) or wrapped
        text += "".join(f"{indent}{line}\n" for line in wrapped)
    return text


def _number(value: int | None) -> str:
    return "" if value is None else str(value)
