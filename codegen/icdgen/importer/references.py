"""What tables say about each other: lists and details, fields and enumerations, fields and their message."""

from __future__ import annotations

from icdgen.icd.wire_ids import DEFAULT_BITS
from icdgen.importer.document import DOUBTFUL, Trouble
from icdgen.importer.parts import NodeParts
from icdgen.importer.understand import messages
from icdgen.importer.understand.model import Listed, ReadEnum, ReadField, ReadMessage
from icdgen.importer.understand.survey import Found
from icdgen.importer.words import plain, squeezed, table_name


def listed(node: NodeParts, troubles: list[Trouble]) -> None:
    """Holds list tables and detail tables together: groups, names, what disagrees, what one of them lacks."""
    rows = [row for one in node.lists for row in one.rows]
    for message in node.messages:
        row = _row_of(message, rows)
        if row is None:
            message.name = message.names[0] if message.names else ""
            if any(one.kind in ("", message.kind) for one in node.lists):
                troubles.append(Trouble("IMP062", f"{message.table.title}: no list table names it", message.table.spot,
                                        "compare with the list tables"))  # fmt: skip
            continue
        row.used = True
        message.group = row.group
        if not message.kind and row.kind:
            message.kind = row.kind
        _name(message, row)
        _compare(message, row, troubles)
    for row in rows:
        if not row.used:
            node.missing.append(row)
            where = (
                f"table {table_name(row.table_number)} is named for it"
                if row.table_number
                else "no table is named for it"
            )
            troubles.append(
                Trouble("IMP061", f"`{row.name}` is listed, and {where}, but no table describes it", row.spot,
                        "held under `missing:`; was its table not understood?", sure=DOUBTFUL)
            )  # fmt: skip


def _row_of(message: ReadMessage, rows: list[Listed]) -> Listed | None:
    """The list's row for a message: by the table it names, else by kind and id, else by name."""
    free = [row for row in rows if not row.used and (not row.kind or not message.kind or row.kind == message.kind)]
    number = message.table.number
    named = [row for row in free if number is not None and row.table_number == number]
    same = [row for row in free if (row.id, row.set_id, row.get_id) == message.ids]
    titled = [row for row in free if squeezed(row.name) in {squeezed(name) for name in message.names}]
    for found in ([r for r in named if r in same or r in titled], same, titled, named):
        if found:
            return found[0]
    return None


def _name(message: ReadMessage, row: Listed) -> None:
    """The name that caption and list agree on; the caption's where they do not."""
    for name in message.names:
        if plain(name) == plain(row.name):
            message.name = name
            return
    message.name = message.names[0] if message.names else row.name


def _compare(message: ReadMessage, row: Listed, troubles: list[Trouble]) -> None:
    mine = {
        "name": message.name,
        "length": message.length,
        "id": message.id,
        "set_id": message.set_id,
        "get_id": message.get_id,
    }
    theirs = {"name": row.name, "length": row.length, "id": row.id, "set_id": row.set_id, "get_id": row.get_id}
    for key, value in theirs.items():
        own = mine[key]
        if value is None or value == own or (key == "name" and plain(str(value)) == plain(str(own))):
            continue
        if own is None:
            setattr(message, key, value)
            troubles.append(Trouble("IMP063", f"{message.table.title}: it does not say its {_SAID[key]}; the list says {value}",
                                    message.table.spot, "taken from the list"))  # fmt: skip
            continue
        message.listed[key] = value
        troubles.append(
            Trouble("IMP060", f"{message.table.title}: its {_SAID[key]} is `{own}`, the list (table {table_name(row.spot.table)}) "
                    f"says `{value}`", message.table.spot, "the detail table is held, `listed:` keeps the other")
        )  # fmt: skip


_SAID = {"name": "name", "length": "length", "id": "id", "set_id": "set id", "get_id": "get id"}


def enums(
    node: NodeParts,
    nodes: list[NodeParts],
    everything: list[tuple[Found, ReadEnum]],
    runs: dict[int, int],
    troubles: list[Trouble],
) -> None:
    """Finds the enumeration of each enum field, and brings it within reach of the node."""
    for message in node.messages:
        run = runs.get(id(message.table), 1)
        for field in message.fields:
            if field.type == "enum":
                _resolve(node, nodes, everything, run, message, field, troubles)


def _resolve(
    node: NodeParts, nodes: list[NodeParts], everything: list[tuple[Found, ReadEnum]], run: int, message: ReadMessage,
    field: ReadField, troubles: list[Trouble],
) -> None:  # fmt: skip
    said = field.described
    where = f"{message.table.title}, field `{field.name}`"
    numbered = next((enum for f, enum in everything if f.run == run and f.table.number == said.enum_table), None)
    if numbered is None and said.enum_table is not None:
        numbered = next((enum for f, enum in everything if f.table.number == said.enum_table), None)
    titled = _by_title(said.enum_title, everything, node)
    chosen = numbered or titled
    if numbered and said.enum_title and titled is not None and squeezed(titled.name) != squeezed(numbered.name):
        chosen = titled
        troubles.append(
            Trouble("IMP051", f"{where}: it points to table {table_name(said.enum_table)} by number and to "
                    f"table {table_name(titled.table.number)} (`{titled.name}`) by title", field.spot,
                    "the title was followed")
        )  # fmt: skip
    if chosen is None:
        if said.enum_table is not None:
            what = f"it points to table {table_name(said.enum_table)}, which is not there or no enumeration"
        elif said.enum_title:
            what = f"there is no enumeration `{said.enum_title}`"
        else:
            what = "it does not say where its values stand"
        troubles.append(Trouble("IMP050", f"{where}: {what}", field.spot,
                                "held as uint; give it an enumeration by an erratum", "error"))  # fmt: skip
        field.type = "uint"
        return
    field.enum = _within_reach(node, nodes, chosen)


def _by_title(title: str, everything: list[tuple[Found, ReadEnum]], node: NodeParts) -> ReadEnum | None:
    wanted = squeezed(title)
    if not wanted:
        return None
    near = [*node.enums, *(enum for _, enum in everything)]
    for enum in near:
        if wanted in (squeezed(enum.name), squeezed(enum.table.caption)):
            return enum
    for enum in near:  # a torn title
        if len(wanted) > 5 and squeezed(enum.table.caption).startswith(wanted):
            return enum
    return None


def _within_reach(node: NodeParts, nodes: list[NodeParts], enum: ReadEnum) -> str:
    """The name under which the node sees the enumeration; it is repeated in the node where it sees none."""
    names = {name.removesuffix(".yaml") for name in node.include}
    for one in (node, *(n for n in nodes if n.name in names)):
        for own in one.enums:
            if own is enum or any(table is enum.table for table in own.also):
                return own.name
    node.enums.append(enum)
    return enum.name


def complete(node: NodeParts, troubles: list[Trouble], id_bits: int = DEFAULT_BITS) -> None:
    """What a message still lacks, and bits that no field covers."""
    most = (1 << id_bits) - 1
    kept = []
    for message in node.messages:
        title, spot = message.table.title, message.table.spot
        if not message.lacks and (large := [i for i in message.ids if i is not None and i > most]):
            wider = "in the profile, `node: {id_bits: 16}` makes room"
            message.lacks = f"its id {large[0]} (0x{large[0]:X}) is above {most}: {wider}"
        if message.lacks:
            if message.lacks != "-":
                troubles.append(Trouble("IMP037", f"{title}: {message.lacks}", spot, "it was left out", "error"))
            continue
        if all(value is None for value in message.ids) or not message.kind:
            what = "no id" if message.kind else "nothing that says whether it is a telecommand or telemetry"
            troubles.append(Trouble("IMP031", f"{title}: {what}; it was left out", spot,
                                    "in the profile: `patterns: [\"{name} ({id})\"]`, or `defaults: {kind: telemetry}`"
                                    if message.kind else "in the profile: `defaults: {kind: telemetry}`, or words under `kinds:`",
                                    "error"))  # fmt: skip
            continue
        if not message.name:
            message.name = (
                f"Table {table_name(message.table.number)}" if message.table.number else f"Message {message.id}"
            )
            troubles.append(
                Trouble("IMP025", f"{title}: nothing names the message", spot, "name it in the ICD", "error")
            )
        needed = max((f.end + 7) // 8 for f in message.fields) if message.fields else 0
        if message.length is None:
            message.length = needed
            severity = "error" if messages.gaps(message) else "warning"
            troubles.append(Trouble("IMP032", f"{title}: it does not say its length; the fields need {needed} "
                                    f"byte{'s' if needed != 1 else ''}", spot, "look at the page", severity))  # fmt: skip
        elif needed > message.length:
            troubles.append(Trouble("IMP033", f"{title}: its fields need {needed} bytes, its length is {message.length}",
                                    spot, "look at the page; `icdgen check` tells the fields"))  # fmt: skip
        if message.length and not message.fields:
            troubles.append(Trouble("IMP034", f"{title}: it has {message.length} bytes and no field", spot,
                                    "look at the page", sure=DOUBTFUL))  # fmt: skip
        elif free := messages.gaps(message):
            bits = ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in free)
            troubles.append(Trouble("IMP035", f"{title}: no field covers bit {bits}", spot,
                                    "such bits are reserved; make sure that no row was lost", "note"))  # fmt: skip
        kept.append(message)
    node.messages = kept
