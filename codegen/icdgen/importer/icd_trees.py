"""What belongs to a node -> the tree of its ICD."""

from __future__ import annotations

import re
from typing import Any

from icdgen.icd import units
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.units import SIGNS, SPELLINGS, STANDARD
from icdgen.import_results.findings import Trouble
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import Listed, NodeParts, ReadEnum, ReadField, ReadMessage
from icdgen.importer.profile import Profile
from icdgen.importer.words import squeezed, table_name


def tree(node: NodeParts, document: Document, profile: Profile, prose: bool, troubles: list[Trouble]) -> dict[str, Any]:
    """The ICD of a node as plain mappings and lists, in the order of the manual."""
    messages = [_message(one, prose) for one in node.messages]
    return {"icdgen": 1, "node": head(node, document, profile)} | _given(
        include=node.include,
        units=_units(node, troubles),
        enums=[_enum(one, prose) for one in node.enums],
        structs=[
            {"name": one.name, "length": one.length, "fields": [_field(field, prose) for field in one.fields]}
            for message in node.messages
            for one in message.structs
        ],
        messages=messages,
        formula_for=_announced(messages),
        loggable=[{"bit": b.bit, "id": b.id} | _given(name=b.name) for log in node.logs for b in log.bits],
        missing=[entry for row in node.missing if (entry := _missing(row))],
    )


def _given(**keys: Any) -> dict[str, Any]:
    """The keys under which something stands."""
    return {key: value for key, value in keys.items() if value}


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


def _source(table: SourceTable) -> dict[str, Any]:
    made = {}
    if table.label is not None and table_name(table.label).isdigit():
        made["table"] = table.label
    if table.page is not None:
        made["page"] = table.page
    return made


def _enum(one: ReadEnum, prose: bool) -> dict[str, Any]:
    also = [source for table in one.also if (source := _source(table))]
    members = [{"value": m.value, "name": m.name, **_prose(m.name, m.summary, prose)} for m in one.members]
    return {"name": one.name, **_given(source=_source(one.table), also=also, members=members)}


def _prose(name: str, text: str, wanted: bool) -> dict[str, Any]:
    """A summary where the description says more than the name."""
    return {"summary": text} if wanted and text and squeezed(text) != squeezed(name) else {}


def _message(one: ReadMessage, prose: bool) -> dict[str, Any]:
    ids = {key: value for key in ("id", "set_id", "get_id") if (value := getattr(one, key)) is not None}
    return {
        "name": one.name, **ids, "kind": one.kind, "length": one.length, **_given(reserved=one.reserved_bytes),
        **_given(group=one.group, source=_source(one.table)),
        **_prose(one.name, one.summary, prose),
        **_given(listed=one.listed, fields=[_field(field, prose) for field in one.fields]),
    }  # fmt: skip


def _field(one: ReadField, prose: bool) -> dict[str, Any]:
    said = one.described
    if "struct" in one.facts:
        return {"at": one.at, "name": one.name, **one.facts}
    sized = {} if "size" in one.facts else {"bits": one.bits}
    return {
        "at": one.at, **sized, "name": one.name, "type": one.type, **one.facts,
        **_given(
            count=one.count, enum=one.enum, unit=SIGNS.get(said.unit, said.unit), formula=said.formula,
            formula_for=said.formula_for,
        ),
        **({"const": Spelled(said.const)} if said.const else {}),  # which may be 0
        **_prose(one.name, said.rest, prose),
    }  # fmt: skip


def _units(node: NodeParts, troubles: list[Trouble]) -> list[dict[str, Any]]:
    """Units that are not built in, and no other spelling of one that is."""
    first: dict[str, tuple[ReadMessage, ReadField]] = {}
    for message in node.messages:
        for field in message.all_fields:
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
