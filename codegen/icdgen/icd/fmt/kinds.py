"""Kinds of mappings in a file and the order of their keys, both taken from the JSON
Schema.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from icdgen.icd import schema

# Kinds that are always written on one line, at any length: they are rows of tables in
# the manual.
ROWS = frozenset({"field", "derived", "member", "loggable", "unit", "packet_field"})
# Kinds that are always written with one key per line.
BLOCKS = frozenset(
    {
        "icd",
        "errata",
        "node",
        "enum",
        "message",
        "erratum",
        "note",
        "protocol",
        "section",
    }
)
# Kinds of which a list is written on one line if it fits.
INLINE = frozenset({"source"})


class SchemaKind:
    """Kind of a mapping or sequence: the name of its definition in the schema, and the
    order of its keys.
    """

    __slots__ = ("_children", "_rule", "keys", "name")

    def __init__(self, name: str, rule: dict[str, Any]) -> None:
        # The name is empty if the schema has no definition for it.
        self.name, self._rule = name, rule
        self.keys = {key: index for index, key in enumerate(rule.get("properties", {}))}
        self._children: dict[tuple[str | None, bool], SchemaKind] = {}

    def child(self, key: str | None, mapping: bool) -> SchemaKind:
        """Return the kind of a mapping or sequence in this one.

        ``key`` is its key in a mapping, or None for an item of a sequence. ``mapping``
        states whether the child is a mapping. Otherwise it is a sequence.
        """
        at = (key if key in self.keys else None, mapping)
        if at not in self._children:
            self._children[at] = self._find(key, mapping)
        return self._children[at]

    def _find(self, key: str | None, mapping: bool) -> SchemaKind:
        """Look up the kind of a child in the schema."""
        rule = (
            self._rule.get("items", {})
            if key is None
            else self._rule.get("properties", {}).get(key, {})
        )
        name, rule = _follow(
            "section" if self.name == "protocol" and mapping else "", rule
        )
        # The schema allows a single value or a list of values.
        if rule.get("if") == {"type": "array"}:
            name, rule = _follow(name, rule["else" if mapping else "then"])
        return SchemaKind(name, rule)


@cache
def kind_of_root(document: str) -> SchemaKind:
    """Return the kind of the root of a document: "icd" or "errata"."""
    return SchemaKind(document, schema.definition(document))


def _follow(name: str, rule: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Resolve references of a sub-schema; return the name of the definition and its
    sub-schema.
    """
    while "$ref" in rule:
        name = schema.name_of_reference(rule)
        rule = schema.definition(name)
    return name, rule
