"""Protocol facts in the JSON Schema of the protocol section."""

from __future__ import annotations

import json
from typing import Any

from icdgen.protocol.declared import FactKind, ProtocolFact, facts_of
from icdgen.protocol.sections import SECTIONS

Schema = dict[str, Any]
_LAST = "assumptions"  # last key of a section; new keys are inserted before it


def written(text: str) -> str:
    """Return the schema with the keys of all facts; other keys are unchanged."""
    schema = json.loads(text)
    for part, path in SECTIONS.items():
        for fact in facts_of(part):
            if fact.key and fact.kind is not FactKind.BUSES:
                *sections, key = f"{path}.{fact.key}".split(".")
                _put(
                    _section(schema["$defs"]["protocol"], sections), key, fragment(fact)
                )
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def _section(schema: Schema, path: list[str]) -> Schema:
    for key in path:
        schema = (
            schema["additionalProperties"] if key == "*" else schema["properties"][key]
        )
    return schema


def _put(section: Schema, key: str, fragment: Schema) -> None:
    properties = section["properties"]
    last = (
        {}
        if key in properties or _LAST not in properties
        else {_LAST: properties.pop(_LAST)}
    )
    properties[key] = fragment
    properties.update(last)


def fragment(fact: ProtocolFact) -> Schema:
    """Return the schema of the key of a fact."""
    about = fact.key_about or fact.about
    if fact.kind is FactKind.OCTET:
        return {"$ref": "#/$defs/byte", "description": about}
    if fact.listed:
        entry = {"enum": sorted(fact.words, key=lambda word: word != fact.listed)}
        return {
            "type": "array",
            "items": entry,
            "minItems": 1,
            "uniqueItems": True,
            "description": about,
        }
    if fact.kind is FactKind.FLAG:
        plain = fact.words[0] is False
        return (
            {"type": "boolean", "description": about}
            if plain
            else {"enum": [*fact.words], "description": about}
        )
    if fact.kind is FactKind.TIME:
        about += ", in milliseconds"
    limits = {"minimum": fact.least} | (
        {} if fact.most is None else {"maximum": fact.most}
    )
    return {"type": "integer", **limits, "description": about}
