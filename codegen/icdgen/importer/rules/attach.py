"""Tables that say more about fields and messages of other tables: enumerations, lookup
tables, bits, and the index of messages.

Their key `of` names a field. `build` calls `attach` before it makes messages, and
`interpret` calls `check_index` when all messages are complete.
"""

from __future__ import annotations

from dataclasses import replace

from icdgen.importer.model import ReadMessage, TableResult
from icdgen.importer.rules.bit_order import Order, bits_of, run_of
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.language import decimal, normalised
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart, known_kind
from icdgen.importer.words import squeezed

# Roles that bits share with the field they divide.
_GROUP = (
    "group",
    "counter",
    "count",
    "rest",
    "stride",
    "up_to",
)
# Attributes of a message that its own table and the index can state.
_STATED = ("kind", "length")


def attach(
    parts: list[TablePart], messages: list[TablePart], order: Order, notes: Notes
) -> None:
    """Give enumerations, lookup tables and bits to the fields that their `of` names."""
    for part in parts:
        # An enumeration with a name of its own belongs to no field: `lists` reads it.
        has_own_name = part.rule.what == "enumeration" and part.given.get("enumeration")
        if part.rule.what not in ("enumeration", "lookup", "bits") or has_own_name:
            continue
        name = normalised(part.given.get("of", ""))
        hosts = _hosts(name, part, parts, messages)
        if not hosts:
            notes.error(
                "IMP107",
                f"{part.table.title}: there is no field `{name}`"
                f"{f' in a message `{part.name}`' if part.name else ''} for this {part.rule.what}",
                part.table.spot,
                "correct `of` and the name of the message in the rule, or the patterns with `{of}` and `{message}`",
                part.rule.place,
            )
        for host, field in hosts:
            if part.rule.what == "enumeration":
                field.members, field.kind = part.pairs, "enum"
            elif part.rule.what == "lookup":
                _lookup(part, field, notes)
            else:
                _divide(part, host, field, order, notes)


def _hosts(
    name: str, part: TablePart, parts: list[TablePart], messages: list[TablePart]
) -> list[tuple[TablePart, FieldDraft]]:
    """Return the fields of this name in the message that the part names, or in all
    messages.

    If several tables describe one name, each belongs to the nearest message above it.
    """
    if not name:
        return []
    wanted = squeezed(name)
    # A part without the name of a message is about all messages.
    hosts = [m for m in messages if squeezed(part.name) in ("", squeezed(m.name))]
    fields = [(m, d) for m in hosts for d in m.drafts if squeezed(d.name) == wanted]
    rivals = [
        p
        for p in parts
        if p.rule.what == part.rule.what
        and squeezed(p.given.get("of", "")) == wanted
        and squeezed(p.name) == squeezed(part.name)
    ]
    # Manuals print the table of values below the message that it belongs to.
    if len(rivals) > 1:
        return [(m, d) for m, d in fields if m.table.number <= part.table.number][-1:]
    return fields


def _lookup(part: TablePart, field: FieldDraft, notes: Notes) -> None:
    points = [[raw, decimal(text)] for raw, text in part.pairs]
    if any(physical is None for _, physical in points):
        notes.error(
            "IMP023",
            f"{part.table.title}: a point of the lookup table of `{field.name}` is no number",
            part.table.spot,
            "correct the pattern of `points`",
            part.rule.place,
        )
        return
    field.facts["points"] = [
        [raw, float(str(physical))]
        # Manuals also print tables with the largest value first.
        for raw, physical in sorted(points, key=lambda point: point[0] or 0)
    ]


def _divide(
    part: TablePart, host: TablePart, field: FieldDraft, order: Order, notes: Notes
) -> None:
    """Put the fields of bits in the place of the field that they divide."""
    # Tables of bits count from the least significant bit of the value, wherever the
    # value stands in the frame.
    host_bits = bits_of(field.at, field.bits, field.order or order)
    covered = {bit for draft in part.drafts for bit in range(draft.at, draft.end)}
    missing = sorted(set(range(field.bits)) - covered)
    if missing or max(covered, default=0) >= field.bits:
        shown = ", ".join(map(str, missing)) or f"{field.bits} and above"
        notes.warn(
            "IMP105",
            f"{part.table.title}: the bits of `{field.name}` leave out or exceed its bits: {shown}",
            part.table.spot,
            "make sure that no row was lost",
            part.rule.place,
        )
    pieces = []
    group = {
        role: text
        for role in _GROUP
        if field.roles.get("group") and (text := field.roles.get(role))
    }
    for draft in part.drafts:
        run = (
            run_of(host_bits[draft.at : draft.end], order)
            if draft.end <= field.bits
            else None
        )
        if run is None:
            notes.error(
                "IMP105",
                f"{part.table.title}: `{draft.name}` does not fit into the bits of `{field.name}`",
                draft.spot,
                "compare with the table",
                part.rule.place,
            )
            continue
        own_order = run[1] if run[1] != order else None
        roles = replace(draft.roles, given=draft.roles.given | group)
        pieces.append(
            replace(
                draft,
                at=run[0],
                order=own_order,
                facts=dict(draft.facts),
                roles=roles,
                table=part.table,
            )
        )
    # By identity: two fields can have equal content.
    index = next(i for i, draft in enumerate(host.drafts) if draft is field)
    host.drafts[index : index + 1] = pieces


def check_index(
    index: list[TablePart], results: list[TableResult], notes: Notes
) -> None:
    """Complete messages from the index, and report what it contradicts, lists without a
    table, or lacks.
    """
    messages = [
        result.content for result in results if isinstance(result.content, ReadMessage)
    ]
    for entry in index:
        id, name = entry.number("id"), normalised(entry.name)
        where = f"{entry.table.title}, row of `{name or id}`"
        entry.given["kind"] = known_kind(
            entry.given.get("kind", ""), where, entry.table.spot, entry.rule, notes
        )
        same = [
            m
            for m in messages
            if (id is not None and id in m.ids)
            or (name and squeezed(m.name) == squeezed(name))
        ]
        if not same:
            notes.warn(
                "IMP061",
                f"{entry.table.title}: it lists `{name or id}`, and no table describes it",
                entry.table.spot,
                "write a rule for its table; if it has no data and no table, a second rule can read it from this one (`also: true` "
                "here, `keep` there); or leave the row out with `skip`",
                entry.rule.place,
            )
        for message in same:
            _complete(message, entry, id, name, notes)


def _complete(
    message: ReadMessage, entry: TablePart, id: int | None, name: str, notes: Notes
) -> None:
    if not message.name:
        message.name = name
    stated = {"kind": entry.given.get("kind"), "length": entry.number("length")}
    if all(number is None for number in message.ids) and id is not None:
        # One id for setting and reading, as in protocols with a direction bit.
        if (message.kind or stated["kind"]) == "configuration":
            message.set_id = message.get_id = id
        else:
            message.id = id
    elif id is not None and id not in message.ids:
        notes.error(
            "IMP060",
            f"{entry.table.title}: it gives `{message.name}` the id {id}, its own table says "
            f"{next(number for number in message.ids if number is not None)}",
            entry.table.spot,
            "compare both tables",
            entry.rule.place,
        )
    for key in _STATED:
        own, other = getattr(message, key), stated[key]
        if own in (None, "") and other:
            setattr(message, key, other)
        elif other and own != other:
            notes.error(
                "IMP060",
                f"{entry.table.title}: it gives `{message.name}` the {key} {other}, its own table says {own}",
                entry.table.spot,
                "compare both tables",
                entry.rule.place,
            )
