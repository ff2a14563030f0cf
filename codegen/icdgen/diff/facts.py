"""The protocol section as single facts: what differs, and where it stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.diagnostics import Place
from icdgen.diff.where import Places
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node

WORDS = frozenset(("source", "summary", "printed_constant"))  # keys that say something about the manual, not the device
NAMES = ("name", "role", "value")  # what tells the rows of a list apart


class Fact(NamedTuple):
    """A fact that differs; ``old`` or ``new`` is None where it is not stated."""

    path: str  # "protocol.uart.framing.escape"
    old: object
    new: object
    places: Places
    is_word: bool


def facts(old: Node, new: Node) -> Iterator[Fact]:
    """All facts that differ, in the order of the old node, then of the new one."""
    yield from _compare("protocol", (old.protocol, new.protocol), (_tree(old), _tree(new)), (None, None), False)


def _tree(node: Node) -> object:
    return node.source.get("protocol") if isinstance(node.source, Map) else None


Two = tuple[Any, Any]  # old and new


def _compare(path: str, values: Two, trees: Two, places: Places, is_word: bool) -> Iterator[Fact]:
    old, new = values
    if old == new and type(old) is type(new):
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in (*old, *(key for key in new if key not in old)):
            yield from _step(f"{path}.{key}", values, trees, places, (key, key), is_word or key in WORDS)
    elif isinstance(old, list) and isinstance(new, list) and any(isinstance(v, dict) for v in (*old, *new)):
        names = [_row_names(side) for side in values]
        for name in (*names[0], *(name for name in names[1] if name not in names[0])):
            steps = names[0].get(name), names[1].get(name)
            yield from _step(f"{path}.{name}", values, trees, places, steps, is_word)
    else:
        yield Fact(path, old, new, places, is_word)


def _row_names(rows: list[Any]) -> dict[str, int]:
    """The place of each row by its name; of several that are called alike the second is ``constant#2``."""
    found: dict[str, int] = {}
    seen: Counter[str] = Counter()
    for index, row in enumerate(rows):
        key = next((str(row[k]) for k in NAMES if k in row), str(index)) if isinstance(row, dict) else str(index)
        seen[key] += 1
        found[f"{key}#{seen[key]}" if seen[key] > 1 else key] = index
    return found


def _step(path: str, values: Two, trees: Two, places: Places, steps: Two, is_word: bool) -> Iterator[Fact]:
    old, new = map(_inside, values, trees, places, steps)
    yield from _compare(path, (old[0], new[0]), (old[1], new[1]), (old[2], new[2]), is_word)


def _inside(value: Any, tree: object, place: Place | None, step: Any) -> tuple[Any, object, Place | None]:
    """One side, a step further down: the value, what was read for it, and where that stands."""
    if step is None or not (step in value if isinstance(value, dict) else step < len(value)):
        return None, None, None
    below, found = _down(tree, step)
    return value[step], below, found or place


def _down(tree: object, step: Any) -> tuple[object, Place | None]:
    if isinstance(tree, Map) and step in tree:
        return tree[step], tree.at(step)
    if isinstance(tree, Seq) and isinstance(step, int) and step < len(tree):
        return tree[step], tree.item_at(step)
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
