"""Check of ICD files and errata overlays against the JSON Schema, with its violations
as findings.

`check` validates a tree against one definition of ``schema.json``. It returns findings
(ICD010) and the id() of each invalid mapping, which `icdgen.icd.build` leaves out of
the model. Profiles of imports, table files and accepted changes are definitions of the
same schema. Other functions look up definitions and descriptions of keys.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Fix, Lines, Place
from icdgen.icd.located import Map, Seq

PATH = Path(__file__).with_name("schema.json")
COPY = "icdgen.schema.json"  # copy of the schema in the folder of the ICDs, for editors
# First line of an ICD, which tells editors the schema.
LINE = f"# yaml-language-server: $schema={COPY}"
CODE = "ICD010"

# Keywords of JSON Schema whose violation concerns the keys of a mapping and not a value
# in it.
_ABOUT_KEYS = ("required", "additionalProperties", "minProperties")

# Types of JSON Schema in words.
_TYPES = {
    "string": "text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
    "object": "a mapping",
    "array": "a list",
    "null": "null",
}


def check(
    tree: Map, document: str, texts: Mapping[str, str] | None = None
) -> tuple[list[Finding], set[int]]:
    """Return the violations of ``#/$defs/<document>`` ("icd" or "errata"), and the id()
    of each mapping with a violation.

    With the ``texts`` of files by their names, findings also have the fixes that depend
    on the spelling of a value. A tree can have values of an overlay.
    """
    findings: list[Finding] = []
    broken: set[int] = set()
    lines: dict[str, Lines] = {}
    for error in _validator(document).iter_errors(tree):
        path = list(error.instance_path)
        holder, owner, place = locate(tree, path)
        # If a value must not be a mapping, the mapping around it is invalid, not the
        # value itself.
        broken.add(id(owner if error.kind.name in _ABOUT_KEYS else holder))
        if place.file not in lines:
            lines[place.file] = Lines((texts or {}).get(place.file, ""))
        findings += _explain(error, path, owner, place, lines[place.file])
    return findings, broken


@cache
def _schema() -> dict[str, Any]:
    schema: dict[str, Any] = json.loads(PATH.read_text(encoding="utf-8"))
    return schema


def definition(name: str) -> dict[str, Any]:
    """Return the sub-schema of a definition. Raises `KeyError`."""
    form: dict[str, Any] = _schema()["$defs"][name]
    return form


def name_of_reference(form: dict[str, Any]) -> str:
    """Return the name of the definition that a sub-schema refers to."""
    return str(form["$ref"]).rpartition("/")[2]


def protocol_schema() -> dict[str, Any]:
    """Return the sub-schema of the protocol section."""
    return definition("protocol")


def subschema_of_key(form: dict[str, Any], key: str) -> dict[str, Any]:
    """Return the sub-schema of a key of a mapping; empty if the key is unknown or any
    key is allowed.
    """
    inner: dict[str, Any] = _follow(form).get("properties", {}).get(key, {})
    return inner


def description_of(form: dict[str, Any]) -> str:
    """Return the description of a key."""
    return str(form.get("description") or _follow(form).get("description", ""))


@cache
def _validator(document: str) -> Any:
    import jsonschema_rs

    schema = {
        "$schema": _schema()["$schema"],
        "$ref": f"#/$defs/{document}",
        "$defs": _schema()["$defs"],
    }
    return jsonschema_rs.validator_for(schema)


def locate(tree: Map, path: list[Any]) -> tuple[Map, Map, Place]:
    """Return the mapping around the value at a path, the value itself if it is a
    mapping (else the former), and its place.
    """
    node: Any = tree
    holder, owner, place = tree, tree, tree.place
    for step in path:
        if isinstance(node, Map) and step not in node:
            # The validator takes the text of a number as the number.
            step = next(key for key in node if str(key) == str(step))
        holder = owner
        place = node.item_at(step) if isinstance(node, Seq) else node.at(step)
        node = node[step]
        if isinstance(node, Map):
            owner = node
    return holder, owner, place


def _explain(
    error: Any, path: list[Any], owner: Map, place: Place, lines: Lines
) -> list[Finding]:
    """Return the findings of an error of `jsonschema_rs`; several if a mapping has
    several unknown keys.
    """
    from icdgen.icd import remedies

    kind = error.kind
    name, fix = kind.name, ""
    what = f"`{path[-1]}`" if path and isinstance(path[-1], str) else "this"
    if path and isinstance(path[-1], int) and isinstance(path[-2], str):
        what = f"this entry of `{path[-2]}`"
    rule = _rule_at(list(error.schema_path))
    about = rule.get("description", "")
    help = f"correct {'it' if what == 'this' else what}: {about}" if about else ""
    if name == "required":
        missing = kind.property
        hint = description_of(subschema_of_key(rule, missing))
        message = f"`{missing}` is missing" + (f" from {what}" if path else "")
        return [
            Finding(
                CODE,
                message,
                place,
                f"add `{missing}:`" + (f", {hint}" if hint else ""),
            )
        ]
    if name == "additionalProperties":
        known_keys = list(rule.get("properties", {}))
        return [
            _unknown_key(key, owner[key], known_keys, owner.key_at(key))
            for key in kind.unexpected
            if key in owner.spots
        ]
    if name == "type":
        wanted = rule.get("type", "")
        types = [wanted] if isinstance(wanted, str) else wanted
        words = " or ".join(_TYPES.get(each, each) for each in types)
        message = f"{what} must be {words}, not {_describe(error.instance)}"
        is_text = wanted == "string" and {"enum", "pattern"}.isdisjoint(rule)
        if isinstance(error.instance, str) or (
            is_text and type(error.instance) in (int, float)
        ):
            fix = remedies.of_type(wanted, lines.marked(place))
    elif name in ("enum", "const"):
        message = f"{what} cannot be {_describe(error.instance)}"
        allowed = [word for word in rule.get("enum", ()) if isinstance(word, str)]
        help = _with_values(help, rule)
        if rule.get("enum") == [True]:
            fix = (
                "true"
                if remedies.of_type("boolean", lines.marked(place)) == "true"
                else ""
            )
        elif path and isinstance(error.instance, str):
            help, fix = remedies.of_value(
                str(path[-1]), error.instance, owner, allowed
            ) or (help, fix)
    elif name in ("minimum", "maximum"):
        side = "at least" if name == "minimum" else "at most"
        message = f"{what} must be {side} {rule[name]}, not {error.instance}"
    elif name == "minLength":
        message = f"{what} is empty"
    elif name == "maxLength":
        message = f"{what} is longer than {rule[name]:,} characters"
    elif name == "pattern":
        message = f"{what} cannot be {_describe(error.instance)}"
    elif name in ("minItems", "minProperties"):
        message = (
            f"{what} is empty"
            if rule[name] == 1
            else f"{what} has fewer than {rule[name]} entries"
        )
    elif name in ("maxItems", "maxProperties"):
        message = f"{what} has more than {rule[name]} {'entry' if rule[name] == 1 else 'entries'}"
    elif name == "anyOf":
        keys = (f"`{key}`" for choice in rule["anyOf"] for key in choice["required"])
        message = f"{what} has neither {' nor '.join(keys)}"
    else:
        message = f"{what} does not fit the format ({name})"
    help = help or "see docs/reference/icd-format.md"
    return [Finding(CODE, message, place, help, fix=Fix(place, fix) if fix else None)]


def _unknown_key(key: str, value: Any, known_keys: list[str], place: Place) -> Finding:
    """Return the finding for an unknown key of a mapping."""
    from icdgen.icd import remedies

    if key == "<<":
        return Finding(
            CODE,
            "merge keys (`<<`) are not supported",
            place,
            "write the keys themselves in its place",
        )
    help, fix = remedies.of_key(key, value, known_keys) or (
        "known keys: " + ", ".join(known_keys),
        "",
    )
    # In `{summary: a, b c}` YAML reads "b c" as a key.
    if " " in key and not fix:
        help = f"if it is the rest of a text with a comma, put that in quotes; {help}"
    return Finding(
        CODE,
        f"unknown key `{key[:60]}`",
        place,
        help,
        fix=Fix(place, fix) if fix else None,
    )


def _with_values(help: str, rule: dict[str, Any]) -> str:
    """Return the help with the allowed values appended, unless it names them all."""
    values = [
        str(value).lower() if isinstance(value, bool) else str(value)
        for value in rule.get("enum", ())
    ]
    if not values or all(value in help for value in values):
        return help
    return "; ".join(filter(None, (help, f"it can be {', '.join(values)}")))


def _rule_at(path: list[Any]) -> dict[str, Any]:
    """Return the sub-schema that failed: the path without its last keyword, with
    references resolved.
    """
    node: Any = _schema()
    for step in path[:-1]:
        if step == "$ref" or (isinstance(node, dict) and step not in node):
            node = _follow(node)
        if step != "$ref" and (isinstance(node, list) or step in node):
            node = node[step]
    return _follow(node) if isinstance(node, dict) else {}


def _follow(form: dict[str, Any]) -> dict[str, Any]:
    """Return the definition that a sub-schema refers to, or the sub-schema itself."""
    return definition(name_of_reference(form)) if "$ref" in form else form


def _describe(value: object) -> str:
    """Return a value in words, shortened to 40 characters."""
    if isinstance(value, bool):
        return f"the boolean {str(value).lower()}"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    if value is None:
        return "empty"
    text = str(value)
    text = text if len(text) <= 40 else text[:37] + "..."
    return f"the text {text!r}" if isinstance(value, str) else f"the number {text}"
