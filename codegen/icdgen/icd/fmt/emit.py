"""Conversion of trees of plain values, which importers make, to canonical YAML.

A tree consists of dicts, lists and scalars, as in JSON. `Spelled` is a number with a
spelling, such as ``0x5A``.
"""

from __future__ import annotations

from typing import Any

from icdgen.icd import schema
from icdgen.icd.fmt import format_text, kinds, write
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText


class Spelled(int):
    """A number with its spelling, such as ``0x5A``."""

    spelling: str

    def __new__(cls, spelling: str) -> Spelled:
        """Return the number of a decimal or hexadecimal spelling."""
        number = super().__new__(
            cls, int(spelling, 16) if "x" in spelling.lower() else int(spelling)
        )
        number.spelling = spelling
        return number


def canonical_yaml(tree: dict[str, Any]) -> str:
    """Return the canonical YAML of an ICD as a tree of plain values."""
    root = branch(tree)
    root.header = [schema.LINE]
    return canonical_yaml_of_branch(root)


def canonical_yaml_of_branch(root: Branch) -> str:
    """Return the canonical YAML of a tree of the formatter.

    The text is read back, so it is certain to load.
    """
    return format_text(
        write.write_canonical(root, kinds.kind_of_root("icd")), "the result"
    )


def branch(value: dict[str, Any] | list[Any]) -> Branch:
    """Return a mapping or a list as a branch of the formatter."""
    result = Branch(isinstance(value, dict), False, 0)
    items = (
        value.items() if isinstance(value, dict) else ((None, item) for item in value)
    )
    result.children = [
        Child(ScalarText(key, key) if key is not None else NOTHING, node(item))
        for key, item in items
    ]
    return result


def node(value: object) -> Branch | ScalarText:
    """Return a value as a node of the formatter."""
    if isinstance(value, (dict, list)):
        return branch(value)
    if isinstance(value, Spelled):
        return ScalarText(int(value), value.spelling)
    if isinstance(value, bool):
        return ScalarText(value, "true" if value else "false")
    return ScalarText(value, "null" if value is None else str(value))
