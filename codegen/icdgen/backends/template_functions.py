"""Functions that templates call, as a mapping for the renderer."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any


def functions_by_name(functions: Iterable[Callable[..., Any]]) -> dict[str, object]:
    """Return the functions by their names, under which templates call them.

    Raises `ValueError` if two functions have the same name: the later one would replace
    the other in the templates.
    """
    result: dict[str, object] = {}
    for function in functions:
        if result.setdefault(function.__name__, function) is not function:
            raise ValueError(f"two functions have the name `{function.__name__}`")
    return result
