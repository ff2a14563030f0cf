"""What is looked up in trees as they were read, whatever may be wrong with them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from icdgen.icd.located import Map

T = TypeVar("T")


def mappings(items: object) -> list[Map]:
    """The mappings of a list: nothing where it is no list."""
    return [item for item in items if isinstance(item, Map)] if isinstance(items, list) else []


def at_path(tree: Any, path: Iterable[str]) -> Any:
    """What stands at a path of keys; None if nothing, or if there are no mappings on the way."""
    for key in path:
        tree = tree.get(key) if isinstance(tree, dict) else None
    return tree


def named(known: Mapping[str, T], name: object) -> T | None:
    """What is known by a name; None if it is no name, for anything may stand where one should."""
    return known.get(name) if isinstance(name, str) else None
