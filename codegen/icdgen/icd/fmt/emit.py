"""Plain trees, as they are made in memory -> canonical YAML."""

from __future__ import annotations

from typing import Any

from icdgen.icd import schema
from icdgen.icd.fmt import format_text, kinds, write
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, Text


class Spelled(int):
    """A number with the way it is written: ``0x5A``."""

    spelling: str

    def __new__(cls, spelling: str) -> Spelled:
        made = super().__new__(cls, int(spelling, 16) if "x" in spelling.lower() else int(spelling))
        made.spelling = spelling
        return made


def text(tree: dict[str, Any]) -> str:
    """The canonical YAML of a tree."""
    root = branch(tree)
    root.header = [schema.LINE]
    return of(root)


def of(root: Branch) -> str:
    """The text of a tree with comments; it is read back, so that nothing is written that does not load."""
    return format_text(write.write(root, kinds.root("icd")), "the result")


def branch(value: dict[str, Any] | list[Any]) -> Branch:
    """A mapping or a list as the formatter holds it."""
    made = Branch(isinstance(value, dict), False, 0)
    items = value.items() if isinstance(value, dict) else ((None, item) for item in value)
    made.children = [Child(Text(key, key) if key is not None else NOTHING, node(item)) for key, item in items]
    return made


def node(value: object) -> Branch | Text:
    """Any value as the formatter holds it."""
    if isinstance(value, (dict, list)):
        return branch(value)
    if isinstance(value, Spelled):
        return Text(int(value), value.spelling)
    if isinstance(value, bool):
        return Text(value, "true" if value else "false")
    return Text(value, str(value))
