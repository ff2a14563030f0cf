"""What kind of mapping stands where, and in which order its keys come: both are read off the JSON Schema."""

from __future__ import annotations

from functools import cache
from typing import Any

from icdgen.icd import schema

# Always one line, however long: the rows of the manual's tables.
ROWS = frozenset({"field", "derived", "member", "loggable", "unit"})
# Always one key a line.
BLOCKS = frozenset({"icd", "errata", "node", "enum", "message", "erratum", "note", "protocol", "section"})
# A list of these stays on one line if it fits.
INLINE = frozenset({"source"})


class Kind:
    """A place of the format: ``name`` is the schema's (empty where the schema says nothing), ``keys`` their order."""

    __slots__ = ("_children", "_rule", "keys", "name")

    def __init__(self, name: str, rule: dict[str, Any]) -> None:
        self.name, self._rule = name, rule
        self.keys = {key: index for index, key in enumerate(rule.get("properties", {}))}
        self._children: dict[tuple[str | None, bool], Kind] = {}

    def child(self, key: str | None, mapping: bool) -> Kind:
        """The kind of the value of ``key``, or of an item (``key`` None); ``mapping``: it is one, else a sequence."""
        at = (key if key in self.keys else None, mapping)
        if at not in self._children:
            self._children[at] = self._find(key, mapping)
        return self._children[at]

    def _find(self, key: str | None, mapping: bool) -> Kind:
        rule = self._rule.get("items", {}) if key is None else self._rule.get("properties", {}).get(key, {})
        name, rule = _follow("section" if self.name == "protocol" and mapping else "", rule)
        if rule.get("if") == {"type": "array"}:  # one, or a list of them
            name, rule = _follow(name, rule["else" if mapping else "then"])
        return Kind(name, rule)


@cache
def root(document: str) -> Kind:
    """The kind of a whole file: "icd" or "errata"."""
    return Kind(document, schema.definition(document))


def _follow(name: str, rule: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    while "$ref" in rule:
        name = schema.referred(rule)
        rule = schema.definition(name)
    return name, rule
