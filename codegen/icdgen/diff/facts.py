"""The protocol section as single facts: what differs, and where it stands."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.diagnostics import Place
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node

WORDS = frozenset(("source", "summary", "printed_constant"))  # keys that say something about the manual, not the device
NAMES = ("name", "value")  # what tells the rows of a list apart


class Fact(NamedTuple):
    """A fact that differs; ``old`` or ``new`` is None where it is not stated."""

    path: str  # "protocol.uart.framing.escape"
    old: object
    new: object
    places: tuple[Place | None, Place | None]
    is_word: bool


def facts(old: Node, new: Node) -> Iterator[Fact]:
    """All facts that differ, in the order of the old node, then of the new one."""
    trees = tuple(node.source.get("protocol") if isinstance(node.source, Map) else None for node in (old, new))
    yield from _compare("protocol", (old.protocol, new.protocol), trees, (None, None), False)


def _compare(path: str, values: tuple, trees: tuple, places: tuple, is_word: bool) -> Iterator[Fact]:
    old, new = values
    if old == new and type(old) is type(new):
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in (*old, *(key for key in new if key not in old)):
            yield from _step(f"{path}.{key}", values, trees, places, (key, key), is_word or key in WORDS)
    elif isinstance(old, list) and isinstance(new, list) and any(isinstance(v, dict) for v in (*old, *new)):
        names = [_row_names(side) for side in values]
        for name in (*names[0], *(name for name in names[1] if name not in names[0])):
            steps = tuple(side.get(name) for side in names)
            yield from _step(f"{path}.{name}", values, trees, places, steps, is_word)
    else:
        yield Fact(path, old, new, places, is_word)


def _row_names(rows: list) -> dict[str, int]:
    found: dict[str, int] = {}
    for index, row in enumerate(rows):
        key = next((str(row[k]) for k in NAMES if k in row), str(index)) if isinstance(row, dict) else str(index)
        found[f"{key}#{index}" if key in found else key] = index
    return found


def _step(path: str, values: tuple, trees: tuple, places: tuple, steps: tuple, is_word: bool) -> Iterator[Fact]:
    inner, below, where = [], [], []
    for value, tree, place, step in zip(values, trees, places, steps, strict=True):
        there = step is not None and (step in value if isinstance(value, dict) else step < len(value))
        inner.append(value[step] if there else None)
        down, found = _down(tree, step) if there else (None, None)
        below.append(down)
        where.append(found or (place if there else None))
    yield from _compare(path, tuple(inner), tuple(below), tuple(where), is_word)


def _down(tree: object, step: object) -> tuple[object, Place | None]:
    if isinstance(tree, Map) and step in tree:
        return tree[step], tree.values_at.get(step, tree.place)
    if isinstance(tree, Seq) and isinstance(step, int) and step < len(tree):
        return tree[step], tree.items_at[step]
    return None, None


def shown(value: object) -> str:
    """A value as a reader of the ICD knows it, short."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and value > 9:
        return f"{value} (0x{value:02X})"
    if isinstance(value, list):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {shown(item)}' for key, item in value.items() if key not in WORDS)}}}"
    return str(value)
