"""The JSON Schemas of ICDs and of the output for programs are valid and have no dead
parts.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import jsonschema
import pytest

from icdgen.shipped import PACKAGE

SCHEMAS = sorted(PACKAGE.rglob("*schema.json"), key=lambda path: path.name)
NAMES = [path.relative_to(PACKAGE).as_posix() for path in SCHEMAS]

# The known keywords, by the kind of their value. An unknown keyword is legal in a JSON
# Schema, but has no effect.
SCHEMA_UNDER = {
    "additionalProperties",
    "items",
    "if",
    "then",
    "else",
    "not",
    "propertyNames",
    "contains",
}
SCHEMAS_UNDER = {"anyOf", "oneOf", "allOf", "prefixItems"}
SCHEMAS_BY_NAME = {"properties", "$defs", "patternProperties", "dependentSchemas"}
PLAIN = {
    "$schema", "$id", "$ref", "title", "description", "type", "enum", "const", "required", "minimum", "maximum",
    "exclusiveMinimum", "exclusiveMaximum", "minLength", "maxLength", "pattern", "minItems", "maxItems", "uniqueItems",
    "minProperties", "maxProperties", "dependentRequired", "default", "examples",
}  # fmt: skip


def parts(schema: object, path: str = "#") -> Iterator[tuple[str, dict]]:
    """Yield every schema within a schema, with its path."""
    if not isinstance(schema, dict):
        return
    yield path, schema
    for key, value in schema.items():
        if key in SCHEMA_UNDER:
            yield from parts(value, f"{path}/{key}")
        elif key in SCHEMAS_UNDER:
            for number, inner in enumerate(value):
                yield from parts(inner, f"{path}/{key}/{number}")
        elif key in SCHEMAS_BY_NAME:
            for name, inner in value.items():
                yield from parts(inner, f"{path}/{key}/{name}")


@pytest.mark.parametrize("path", SCHEMAS, ids=NAMES)
def test_every_key_of_a_schema_has_an_effect(path: Path):
    keywords = PLAIN | SCHEMA_UNDER | SCHEMAS_UNDER | SCHEMAS_BY_NAME
    unknown = [
        f"{place}/{key}"
        for place, part in parts(json.loads(path.read_text("utf-8")))
        for key in part
        if key not in keywords
    ]
    assert unknown == []


@pytest.mark.parametrize("path", SCHEMAS, ids=NAMES)
def test_a_schema_is_valid_itself(path: Path):
    schema = json.loads(path.read_text("utf-8"))
    jsonschema.validators.validator_for(schema).check_schema(schema)


@pytest.mark.parametrize("path", SCHEMAS, ids=NAMES)
def test_every_definition_of_a_schema_is_used(path: Path):
    schema = json.loads(path.read_text("utf-8"))
    used = {part["$ref"] for _, part in parts(schema) if "$ref" in part}
    documents = (
        {"icd", "errata", "source_table"} if path.parent.name == "icd" else set()
    )  # read under their names
    assert [
        name
        for name in schema.get("$defs", {})
        if f"#/$defs/{name}" not in used and name not in documents
    ] == []


@pytest.mark.parametrize("path", SCHEMAS, ids=NAMES)
def test_a_schema_requires_only_properties_that_it_has(path: Path):
    missing = [
        f"{place}/{key}"
        for place, part in parts(json.loads(path.read_text("utf-8")))
        if part.get("additionalProperties") is False
        for key in (*part.get("required", ()), *part.get("dependentRequired", ()))
        if key not in part.get("properties", {})
    ]
    assert missing == []


def test_every_section_that_has_parameters_of_a_crc_can_state_its_check_value():
    """Rule ICD091 computes `check` in every section, so the schema must allow it there."""
    schema = json.loads((PACKAGE / "icd" / "schema.json").read_text("utf-8"))
    sections = {
        place: part["properties"]
        for place, part in parts(schema)
        if "polynomial" in part.get("properties", {})
    }
    assert (
        len(sections) == 1
        and [place for place, keys in sections.items() if "check" not in keys] == []
    )
