"""ICD of a node as a tree of mappings and lists, with the keys of the YAML format.

`assemble` calls this module when all references of the node are resolved. `icd/fmt`
writes a tree as text.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.icd import units
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.units import SIGNS, SPELLINGS, STANDARD
from icdgen.import_results.findings import ImportFinding
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import (
    Listed,
    NodeParts,
    ReadEnum,
    ReadField,
    ReadMessage,
    ReadStruct,
)
from icdgen.importer.profile import Profile
from icdgen.importer.words import squeezed, table_name


def tree(
    node: NodeParts,
    document: Document,
    profile: Profile,
    prose: bool,
    import_findings: list[ImportFinding],
) -> dict[str, Any]:
    """Return the ICD of a node as mappings and lists, in the order of the manual."""
    messages = [_message(item, prose) for item in node.messages]
    return {"icdgen": 1, "node": head(node, document, profile)} | _given(
        include=node.include,
        units=_units(node, import_findings),
        enums=[_enum(item, prose) for item in node.enums],
        structs=[
            _struct(item, prose)
            for message in node.messages
            for item in message.structs
        ],
        messages=messages,
        formula_for=_announced(messages),
        loggable=[
            {"bit": b.bit, "id": b.id} | _given(name=b.name)
            for log in node.logs
            for b in log.bits
        ],
        missing=[entry for row in node.missing if (entry := _missing(row))],
    )


def _given(**keys: Any) -> dict[str, Any]:
    """Return the keys that have a value."""
    return {key: value for key, value in keys.items() if value}


def _announced(messages: list[dict[str, Any]]) -> dict[str, str]:
    """Move `formula_for` from the fields to the ICD for each kind of message in which
    all formulas agree.
    """
    by_kind = {}
    for kind in dict.fromkeys(message["kind"] for message in messages):
        fields = []
        for message in messages:
            if message["kind"] == kind:
                fields += [
                    field for field in message.get("fields", ()) if "formula" in field
                ]
        words = {field.get("formula_for") for field in fields}
        if len(fields) > 1 and len(words) == 1 and None not in words:
            by_kind[kind] = words.pop()
            for field in fields:
                del field["formula_for"]
    return by_kind


def head(node: NodeParts, document: Document, profile: Profile) -> dict[str, Any]:
    """Return the section `node` of the ICD."""
    section = {
        "name": node.name,
        "title": node.title or node.name,
        **profile.data["node"],
    }
    # Without a title in its properties, a document is cited by its file name.
    title = document.title or re.split(r"[/\\]", document.file)[-1]
    section["source"] = {"document": title}
    if node.words is not None:
        section |= node.words.head
    return section


def _source(table: SourceTable) -> dict[str, Any]:
    source = {}
    if table.label is not None and table_name(table.label).isdigit():
        source["table"] = table.label
    if table.page is not None:
        source["page"] = table.page
    return source


def _struct(struct: ReadStruct, prose: bool) -> dict[str, Any]:
    fields = [_field(field, prose) for field in struct.fields]
    return {"name": struct.name, "length": struct.length, "fields": fields}


def _enum(enum: ReadEnum, prose: bool) -> dict[str, Any]:
    also = [source for table in enum.also if (source := _source(table))]
    members = [
        {"value": m.value, "name": m.name, **_prose(m.name, m.summary, prose)}
        for m in enum.members
    ]
    return {
        "name": enum.name,
        **_given(source=_source(enum.table), also=also, members=members),
    }


def _prose(name: str, text: str, wanted: bool) -> dict[str, Any]:
    """Return a summary if the description says more than the name."""
    return (
        {"summary": text}
        if wanted and text and squeezed(text) != squeezed(name)
        else {}
    )


def _message(message: ReadMessage, prose: bool) -> dict[str, Any]:
    ids = {
        key: value
        for key in ("id", "set_id", "get_id")
        if (value := getattr(message, key)) is not None
    }
    return {
        "name": message.name, **ids, "kind": message.kind, "length": message.length, **_given(reserved=message.reserved_bytes),
        **_given(group=message.group, source=_source(message.table)),
        **_prose(message.name, message.summary, prose),
        **_given(listed=message.listed, fields=[_field(field, prose) for field in message.fields]),
    }  # fmt: skip


def _field(field: ReadField, prose: bool) -> dict[str, Any]:
    described = field.described
    if "struct" in field.facts:
        return {"at": field.at, "name": field.name, **field.facts}
    sized = {} if "size" in field.facts else {"bits": field.bits}
    return {
        "at": field.at, **sized, "name": field.name, "type": field.type, **field.facts,
        **_given(
            count=field.count, enum=field.enum, unit=SIGNS.get(described.unit, described.unit), formula=described.formula,
            formula_for=described.formula_for,
        ),
        # A constant can be 0, which `_given` would leave out.
        **({"const": Spelled(described.const)} if described.const else {}),
        **_prose(field.name, described.prose, prose),
    }  # fmt: skip


def _units(
    node: NodeParts, import_findings: list[ImportFinding]
) -> list[dict[str, Any]]:
    """Return declarations of units that are not built in, and report them (IMP042)."""
    first: dict[str, tuple[ReadMessage, ReadField]] = {}
    for message in node.messages:
        for field in message.all_fields:
            symbol = field.described.unit
            if symbol and symbol not in STANDARD and symbol not in SPELLINGS:
                first.setdefault(symbol, (message, field))
    for symbol, (message, field) in first.items():
        import_findings.append(
            ImportFinding("IMP042", f"{message.table.title}, field `{field.name}`: the unit `{symbol}` is not built in",
                    field.spot, "declared under `units:`; say there what it measures", "note")
        )  # fmt: skip
    return units.declared(first)


def _missing(row: Listed) -> dict[str, Any] | None:
    """Return an entry of `missing`, or None for a row without an id or a kind."""
    number = row.id if row.id is not None else row.get_id
    if number is None or not row.kind:
        return None
    where = (
        f"Table {table_name(row.spot.table)} lists it"
        if row.spot.table
        else "A list names it"
    )
    return {
        "kind": row.kind,
        "id": number,
        "name": row.name,
        "why": f"{where}, no table describes it.",
    }
