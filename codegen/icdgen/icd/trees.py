"""Access to trees of files that may violate the schema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from icdgen.icd.located import Map

T = TypeVar("T")


def mappings(items: object) -> list[Map]:
    """Return the mappings in a list; an empty list if the value is not a list."""
    return (
        [item for item in items if isinstance(item, Map)]
        if isinstance(items, list)
        else []
    )


def at_path(tree: Any, path: Iterable[str]) -> Any:
    """Return the value at a path of keys; None if a key is absent or a value on the
    path is not a mapping.
    """
    for key in path:
        tree = tree.get(key) if isinstance(tree, dict) else None
    return tree


def named(objects: Mapping[str, T], name: object) -> T | None:
    """Return the object of a name; None if the name is unknown or not a string."""
    return objects.get(name) if isinstance(name, str) else None
