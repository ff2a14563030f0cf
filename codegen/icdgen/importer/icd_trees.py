"""What belongs to a node -> the tree of its ICD."""

from __future__ import annotations

import re
from typing import Any

from icdgen.icd import units
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.units import SIGNS, SPELLINGS, STANDARD
from icdgen.importer.document import Document, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand.model import Listed, NodeParts, ReadEnum, ReadField, ReadMessage
from icdgen.importer.words import squeezed, table_name


def tree(node: NodeParts, document: Document, profile: Profile, prose: bool, troubles: list[Trouble]) -> dict[str, Any]:
    """The ICD of a node as plain mappings and lists, in the order of the manual."""
    made: dict[str, Any] = {"icdgen": 1, "node": head(node, document, profile)}
    if node.include:
        made["include"] = node.include
    if declared := _units(node, troubles):
        made["units"] = declared
    if node.enums:
        made["enums"] = [_enum(one, prose) for one in node.enums]
    if node.messages:
        made["messages"] = [_message(one, prose) for one in node.messages]
        if announced := _announced(made["messages"]):
            made["formula_for"] = announced
    if node.logs:
        made["loggable"] = [
            {"bit": b.bit, "id": b.id, **({"name": b.name} if b.name else {})} for log in node.logs for b in log.bits
        ]
    if missing := [entry for row in node.missing if (entry := _missing(row))]:
        made["missing"] = missing
    return made


def _announced(messages: list[dict[str, Any]]) -> dict[str, str]:
    """What is announced of every formula of a kind of messages is taken out of the fields, to be said once."""
    made = {}
    for kind in dict.fromkeys(message["kind"] for message in messages):
        fields = [f for m in messages if m["kind"] == kind for f in m.get("fields", ()) if "formula" in f]
        words = {field.get("formula_for") for field in fields}
        if len(fields) > 1 and len(words) == 1 and None not in words:
            made[kind] = words.pop()
            for field in fields:
                del field["formula_for"]
    return made


def head(node: NodeParts, document: Document, profile: Profile) -> dict[str, Any]:
    """The section `node` of the ICD."""
    found = {"name": node.name, "title": node.title or node.name, **profile.data["node"]}
    title = document.title or re.split(r"[/\\]", document.file)[-1]
    found["source"] = {"document": title}
    if node.words is not None:
        found |= node.words.head
    return found


def _source(table: Table) -> dict[str, Any]:
    made = {}
    if table.number is not None and table_name(table.number).isdigit():
        made["table"] = table.number
    if table.page is not None:
        made["page"] = table.page
    return made


def _enum(one: ReadEnum, prose: bool) -> dict[str, Any]:
    made: dict[str, Any] = {"name": one.name}
    if source := _source(one.table):
        made["source"] = source
    if also := [s for s in (_source(table) for table in one.also) if s]:
        made["also"] = also
    made["members"] = [
        {"value": m.value, "name": m.name, **_prose(m.name, m.summary, prose)} for m in one.members
    ]  # fmt: skip
    return made


def _prose(name: str, text: str, wanted: bool) -> dict[str, Any]:
    """A summary where the description says more than the name."""
    return {"summary": text} if wanted and text and squeezed(text) != squeezed(name) else {}


def _message(one: ReadMessage, prose: bool) -> dict[str, Any]:
    made: dict[str, Any] = {"name": one.name}
    for key in ("id", "set_id", "get_id"):
        if (value := getattr(one, key)) is not None:
            made[key] = value
    made |= {"kind": one.kind, "length": one.length}
    if one.group:
        made["group"] = one.group
    if source := _source(one.table):
        made["source"] = source
    made |= _prose(one.name, one.summary, prose)
    if one.listed:
        made["listed"] = one.listed
    if one.fields:
        made["fields"] = [_field(f, prose) for f in one.fields]
    return made


def _field(one: ReadField, prose: bool) -> dict[str, Any]:
    made: dict[str, Any] = {"at": one.at, "bits": one.bits, "name": one.name, "type": one.type}
    if one.count:
        made["count"] = one.count
    if one.enum:
        made["enum"] = one.enum
    said = one.described
    if said.unit:
        made["unit"] = SIGNS.get(said.unit, said.unit)
    if said.formula:
        made["formula"] = said.formula
    if said.formula_for:
        made["formula_for"] = said.formula_for
    if said.const:
        made["const"] = Spelled(said.const)
    if one.bitfields:
        made["bitfields"] = [{"at": bits.at, "bits": bits.bits, "name": bits.name} for bits in one.bitfields]
    return made | _prose(one.name, said.rest, prose)


def _units(node: NodeParts, troubles: list[Trouble]) -> list[dict[str, Any]]:
    """Units that are not built in, and no other spelling of one that is."""
    first: dict[str, tuple[ReadMessage, ReadField]] = {}
    for message in node.messages:
        for field in message.fields:
            symbol = field.described.unit
            if symbol and symbol not in STANDARD and symbol not in SPELLINGS:
                first.setdefault(symbol, (message, field))
    for symbol, (message, field) in first.items():
        troubles.append(
            Trouble("IMP042", f"{message.table.title}, field `{field.name}`: the unit `{symbol}` is not built in",
                    field.spot, "declared under `units:`; say there what it measures", "note")
        )  # fmt: skip
    return units.declared(first)


def _missing(row: Listed) -> dict[str, Any] | None:
    number = row.id if row.id is not None else row.get_id
    if number is None or not row.kind:
        return None
    where = f"Table {table_name(row.spot.table)} lists it" if row.spot.table else "A list names it"
    return {"kind": row.kind, "id": number, "name": row.name, "why": f"{where}, no table describes it."}
