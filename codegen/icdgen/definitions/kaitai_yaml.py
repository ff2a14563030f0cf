"""YAML of a .ksy: a tree with source positions, and with integers in the notations of
Kaitai Struct.
"""

from __future__ import annotations

import re

from icdgen.definitions.model import unreadable
from icdgen.icd.located import Map
from icdgen.icd.source import Event, TreeBuilder

_INTEGER = re.compile(
    r"[-+]?(?:0[xX][0-9A-Fa-f_]+|0[bB][01_]+|0[oO][0-7_]+|[0-9][0-9_]*)\Z"
)
_FLOAT = re.compile(r"[-+]?[0-9]+\.[0-9]*(?:[eE][-+]?[0-9]+)?\Z")
_WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}
_LONGEST = 40  # characters of a number
_MOST_TEXT = 20_000  # characters of a text; the remainder is dropped


def parse(file: str, data: bytes) -> Map:
    """Return the tree of a .ksy.

    Raises `Findings` if the file is not YAML or has no `meta`. Anchors are rejected:
    aliases can expand a small text to a huge tree.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise unreadable(
            file,
            f"byte 0x{data[error.start]:02X} is not UTF-8",
            "save the file as UTF-8",
            line,
        ) from None
    tree, findings = _Builder(text, file).build()
    if findings:
        first = findings[0]
        raise unreadable(
            file,
            first.message.replace(" of the format", " of what is read"),
            first.help,
            first.place.line or 1,
        )
    meta = tree.get("meta") if isinstance(tree, Map) else None
    if not isinstance(tree, Map) or not isinstance(meta, Map):
        raise unreadable(
            file,
            "not a Kaitai Struct definition: it has no `meta`",
            "a .ksy begins with `meta:` and `seq:`",
        )
    return tree


def integer(text: str) -> int | None:
    """Return the value of an integer in decimal, `0x`, `0b` or `0o` notation, None for
    any other text.
    """
    if len(text) > _LONGEST or not _INTEGER.match(text):
        return None
    # Base 10 even with leading zeros: base 0 rejects `007`.
    try:
        return int(text.replace("_", ""), 10 if text.lstrip("+-").isdigit() else 0)
    except ValueError:
        return None


class _Builder(TreeBuilder):
    """Builder of trees with the scalars of Kaitai Struct."""

    def scalar(self, event: Event) -> object:
        """Return the value of a scalar.

        Only plain (unquoted) scalars can be numbers, booleans or null.
        """
        text = event.value
        if event.anchor is not None:
            self.refuse_alias(event)
        self.check_tag(event)
        if event.style:
            return text[:_MOST_TEXT]
        if text in _WORDS:
            return _WORDS[text]
        if (number := integer(text)) is not None:
            return number
        return (
            float(text)
            if len(text) <= _LONGEST and _FLOAT.match(text)
            else text[:_MOST_TEXT]
        )
