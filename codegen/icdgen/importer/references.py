"""References between the tables of a node: from lists to messages, and from fields to
enumerations. Checks of complete messages.

The three public functions change the `NodeParts` of a node and add findings. `assemble`
calls them in the order of this file.
"""

from __future__ import annotations

import itertools
from typing import Any

from icdgen.icd.wire_ids import DEFAULT_BITS
from icdgen.import_results.findings import DOUBTFUL, LIKELY, ImportFinding
from icdgen.importer.model import Listed, NodeParts, ReadEnum, ReadField, ReadMessage
from icdgen.importer.words import plain, squeezed, table_name


def compare_with_lists(node: NodeParts, import_findings: list[ImportFinding]) -> None:
    """Compare list tables with the tables of messages.

    Messages take their group, and missing facts, from the list. Contradictions (IMP060)
    and messages that only one of them has (IMP061, IMP062) are findings.
    """
    rows = [row for list_table in node.lists for row in list_table.rows]
    for message in node.messages:
        row = _row_for(message, rows)
        if row is None:
            if any(list_table.kind in ("", message.kind) for list_table in node.lists):
                import_findings.append(ImportFinding("IMP062", f"{message.table.title}: no list table names it", message.table.spot,
                                        "compare with the list tables"))  # fmt: skip
            continue
        row.used = True
        message.group = row.group
        if not message.kind and row.kind:
            message.kind = row.kind
        message.name = message.name or row.name
        _compare(message, row, import_findings)
    for row in rows:
        if not row.used:
            node.missing.append(row)
            import_findings.append(
                ImportFinding("IMP061", f"`{row.name}` is listed, and no table describes it", row.spot,
                        "it is listed under `missing:`; check whether its table was read", sure=DOUBTFUL)
            )  # fmt: skip


def _row_for(message: ReadMessage, rows: list[Listed]) -> Listed | None:
    """Return the row of a list for a message, by kind and id, or else by name."""
    free = [
        row
        for row in rows
        if not row.used
        and (not row.kind or not message.kind or row.kind == message.kind)
    ]
    same = [row for row in free if (row.id, row.set_id, row.get_id) == message.ids]
    titled = [row for row in free if squeezed(row.name) == squeezed(message.name)]
    return next(iter([*same, *titled]), None)


def _compare(
    message: ReadMessage, row: Listed, import_findings: list[ImportFinding]
) -> None:
    """Complete a message from its row in a list, and report contradictions."""
    for key, what in _COMPARED_KEYS.items():
        own, value = getattr(message, key), getattr(row, key)
        if (
            value is None
            or value == own
            or (key == "name" and plain(str(value)) == plain(str(own)))
        ):
            continue
        if own is None:
            setattr(message, key, value)
            import_findings.append(
                ImportFinding(
                    "IMP063",
                    f"{message.table.title}: it does not say its {what}; the list says {value}",
                    message.table.spot,
                    "taken from the list",
                )
            )
            continue
        message.listed[key] = value
        import_findings.append(
            ImportFinding("IMP060", f"{message.table.title}: its {what} is `{own}`, the list (table {table_name(row.spot.table)}) "
                    f"says `{value}`", message.table.spot, "the ICD has the value of the detail table; `listed:` has the other")
        )  # fmt: skip


_COMPARED_KEYS = {
    "name": "name",
    "length": "length",
    "id": "id",
    "set_id": "set id",
    "get_id": "get id",
}


def resolve_enumerations(
    node: NodeParts,
    nodes: list[NodeParts],
    everything: list[ReadEnum],
    import_findings: list[ImportFinding],
) -> None:
    """Set the enumeration of each enum field, and copy it to the node if necessary.

    A field whose enumeration cannot be found becomes a `uint`.
    """
    for message in node.messages:
        for field in message.all_fields:
            if field.type != "enum" or field.enum:
                continue
            enum = _enumeration_of_field(
                node, everything, message, field, import_findings
            )
            if enum is None:
                field.type = "uint"
            else:
                field.enum = _name_within_reach(node, nodes, enum)


def _enumeration_of_field(
    node: NodeParts,
    everything: list[ReadEnum],
    message: ReadMessage,
    field: ReadField,
    import_findings: list[ImportFinding],
) -> ReadEnum | None:
    """Return the enumeration to which a field refers; report a reference that cannot be
    resolved.
    """
    described = field.described
    where = f"{message.table.title}, field `{field.name}`"
    of_number = [
        enum
        for enum in everything
        if enum.table.label == described.enum_table is not None
    ]
    # Parts of a manual that number their tables from 1 have several tables with this
    # number.
    of_number.sort(key=lambda enum: enum.table.run != message.table.run)
    of_table = [enum for enum in of_number if enum.table is of_number[0].table]
    titled = _by_title(described.enum_title, everything, node)
    is_ambiguous = len(of_table) > 1 and titled not in of_table
    numbered = None
    if titled in of_table:
        numbered = titled
    elif of_table and not is_ambiguous:
        numbered = of_table[0]
    chosen = numbered or titled
    if (
        numbered
        and described.enum_title
        and titled is not None
        and squeezed(titled.name) != squeezed(numbered.name)
    ):
        chosen = titled
        import_findings.append(
            ImportFinding("IMP051", f"{where}: it points to table {table_name(described.enum_table)} by number and to "
                    f"table {table_name(titled.table.label)} (`{titled.name}`) by title", field.spot,
                    "the title was followed")
        )  # fmt: skip
    if chosen is None:
        if is_ambiguous:
            names = " and ".join(f"`{enum.name}`" for enum in of_table[:3])
            what = f"it points to table {table_name(described.enum_table)}, which has {len(of_table)} enumerations: {names}"
        elif described.enum_table is not None:
            what = f"it points to table {table_name(described.enum_table)}, which is not there or no enumeration"
        elif described.enum_title:
            what = f"there is no enumeration `{described.enum_title}`"
        else:
            what = "it does not say in which table its values are"
        import_findings.append(ImportFinding("IMP050", f"{where}: {what}", field.spot,
                                "it is imported as uint; name its enumeration in an erratum", "error"))  # fmt: skip
    return chosen


def _by_title(
    title: str, everything: list[ReadEnum], node: NodeParts
) -> ReadEnum | None:
    """Return the enumeration of a title: its name, the caption of its table, or the
    beginning of both.
    """
    wanted = squeezed(title)
    if not wanted:
        return None
    near = [*node.enums, *everything]
    equal = (enum for enum in near if wanted == squeezed(enum.name))
    # The caption of a table with several enumerations is the title of none.
    captioned = (
        enum
        for enum in near
        if wanted == squeezed(enum.table.caption)
        and sum(each.table is enum.table for each in everything) == 1
    )
    # A cell can break off a title. A caption that goes on can also be about another
    # enumeration.
    torn = [
        enum
        for enum in near
        if len(wanted) > 5
        and squeezed(enum.table.caption).startswith(wanted)
        and squeezed(enum.name).startswith(wanted)
    ]
    if len({squeezed(enum.name) for enum in torn}) > 1:
        torn = []
    return next(itertools.chain(equal, captioned, torn), None)


def _name_within_reach(node: NodeParts, nodes: list[NodeParts], enum: ReadEnum) -> str:
    """Return the name of the enumeration in the scope of the node.

    If it is out of scope, it is copied to the node.
    """
    names = {name.removesuffix(".yaml") for name in node.include}
    for visible in (node, *(n for n in nodes if n.name in names)):
        for own in visible.enums:
            if own is enum or any(table is enum.table for table in own.also):
                return own.name
    node.enums.append(enum)
    return enum.name


def check_messages(
    node: NodeParts, head: dict[str, Any], import_findings: list[ImportFinding]
) -> None:
    """Report what messages lack and bits without a field; drop messages that an ICD
    cannot represent.

    ``head`` is the section `node` of the ICD, which has the size of ids.
    """
    most = (1 << head.get("id_bits", DEFAULT_BITS)) - 1
    node.messages = [
        message
        for message in node.messages
        if _is_representable(message, most, import_findings)
    ]


def _is_representable(
    message: ReadMessage, most: int, import_findings: list[ImportFinding]
) -> bool:
    """Return whether an ICD can represent the message, and report what it lacks.

    ``most`` is the largest id. A length that no table states is set to the number of
    bytes that the fields need.
    """

    def say(
        code: str, what: str, help: str, severity: str = "warning", sure: str = LIKELY
    ) -> None:
        import_findings.append(
            ImportFinding(
                code,
                f"{message.table.title}: {what}",
                message.table.spot,
                help,
                severity,
                sure,
            )
        )

    if large := [i for i in message.ids if i is not None and i > most]:
        what = f"its id {large[0]} (0x{large[0]:X}) is above {most}"
        say(
            "IMP037",
            what,
            "in the profile, `node: {id_bits: 16}` makes room; it was left out",
            "error",
        )
        return False
    required = {
        "name": bool(message.name),
        "kind": bool(message.kind),
        "id": any(number is not None for number in message.ids),
    }
    if lacking := [key for key, is_given in required.items() if not is_given]:
        say("IMP031", f"its rule gives no {' and no '.join(lacking)}; the message was left out",
            "state it under `message:`, or take it with a pattern", "error")  # fmt: skip
        return False
    needed = max(((extent.end + 7) // 8 for extent in message.extents()), default=0)
    if message.length is None:
        message.length = needed
        what = f"it does not say its length; the fields need {needed} byte{'s' if needed != 1 else ''}"
        say("IMP032", what, "look at the page", "note")
    elif needed > message.length:
        what = f"its fields need {needed} bytes, its length is {message.length}"
        say("IMP033", what, "look at the page; `icdgen check` names the fields")
    if message.length and not message.fields:
        say(
            "IMP034",
            f"it has {message.length} bytes and no field",
            "look at the page",
            "error",
            DOUBTFUL,
        )
    elif free := message.gaps:
        bits = ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in free)
        say(
            "IMP035",
            f"no field covers bit {bits}",
            "such bits are reserved; make sure that no row was lost",
        )
    return True
