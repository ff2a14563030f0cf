"""Tables that list messages or the frames of logs, and enumerations that descriptions
refer to by name.

`list_of`, `log_of` and `enumeration_of` return a `TableResult`. `interpret` calls the
first two with the roles of the rows of one table, `build` the third with a part that
was read. Rows without a name, id or bit are reported (IMP103) and left out. `assemble`
assigns the results to nodes.
"""

from __future__ import annotations

import re

from icdgen.importer.document import SourceTable
from icdgen.importer.model import (
    Listed,
    ReadEnum,
    ReadList,
    ReadLog,
    ReadLogBit,
    ReadMember,
    TableResult,
)
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.language import normalised, whole_number
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart, known_kind
from icdgen.importer.rules.rule import TableRule

_MASK = re.compile(r"(?:0x)?(?:[0-9A-Fa-f]{2}\s*)+\Z")
_IDS = ("id", "set_id", "get_id")


def list_of(
    rule: TableRule,
    table: SourceTable,
    given: dict[str, str],
    rows: list[Roles],
    notes: Notes,
) -> TableResult:
    """Return the list of messages that a table is."""
    kind = known_kind(given.get("kind", ""), table.title, table.spot, rule, notes)
    result = ReadList(kind, normalised(given.get("node", "")), [])
    for roles in rows:
        spot = table.spot_of(roles.row.source)
        numbers = {
            role: _number(rule, table, roles, role, notes) for role in (*_IDS, "length")
        }
        name = roles.get("message")
        if not name or all(numbers[role] is None for role in _IDS):
            lacks = "name" if not name else "id"
            notes.error(
                "IMP103",
                f"{table.title}: the row `{roles.row.text[:80]}` gives no {lacks}",
                spot,
                "give columns the roles `message` and `id`, or drop the row with `skip`",
                rule.place,
            )
            continue
        result.rows.append(
            Listed(
                known_kind(
                    roles.get("kind"),
                    f"{table.title}, row of `{name}`",
                    spot,
                    rule,
                    notes,
                )
                or kind,
                name,
                numbers["length"],
                numbers["id"],
                numbers["set_id"],
                numbers["get_id"],
                roles.get("section"),
                spot,
            )
        )
    return TableResult(table, "list", result)


def log_of(
    rule: TableRule, table: SourceTable, rows: list[Roles], notes: Notes
) -> TableResult:
    """Return the frames that can be logged, by the bit of the mask."""
    log = ReadLog([])
    for roles in rows:
        bit = (
            bit_of_mask(roles.get("mask"))
            if roles.get("mask")
            else whole_number(roles.get("bit") or "?")
        )
        frame = _number(rule, table, roles, "id", notes)
        if bit is None or frame is None:
            notes.error(
                "IMP103",
                f"{table.title}: the row `{roles.row.text[:80]}` gives no mask of one bit and no id of a frame",
                table.spot_of(roles.row.source),
                "give columns the roles `mask` or `bit`, and `id`",
                rule.place,
            )
            continue
        log.bits.append(ReadLogBit(bit, frame, roles.get("message")))
    return TableResult(table, "loggable frames", log)


def enumeration_of(part: TablePart) -> TableResult:
    """Return the enumeration that a table prints under a name of its own."""
    members = [
        ReadMember(value, name, text)
        for (value, name), text in zip(part.pairs, part.texts, strict=True)
    ]
    table = part.table
    return TableResult(
        table,
        "enumeration",
        ReadEnum(normalised(part.given["enumeration"]), members, table),
    )


def _number(
    rule: TableRule, table: SourceTable, roles: Roles, role: str, notes: Notes
) -> int | None:
    text = roles.get(role)
    value = whole_number(text, rule.base) if text else None
    if text and value is None:
        notes.error(
            "IMP023",
            f"{table.title}: `{role}` is `{text[:40]}`, which is not a number",
            table.spot_of(roles.row.source),
            "correct the pattern or the table file",
            rule.place,
        )
    return value


def bit_of_mask(text: str) -> int | None:
    """Return the number of the only bit in a mask of bytes, or None.

    The first byte has the lowest bits.
    """
    if not _MASK.match(text.strip()):
        return None
    data = bytes.fromhex(text.strip().removeprefix("0x").replace(" ", ""))
    value = int.from_bytes(data, "little")
    # Only a power of two has no bit in common with the number before it.
    return value.bit_length() - 1 if value and value & (value - 1) == 0 else None
