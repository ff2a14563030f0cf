"""Arrays that a function per element, or per group of elements, reads and writes; and
the names of these functions.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.describe import FieldDescription
from icdgen.describe.arrays import loop_of, named_arrays
from icdgen.describe.description import Composite


def named(composite: Composite[Any]) -> Iterator[tuple[FieldDescription, str]]:
    """List these arrays of a message with their names; arrays in elements of an array
    come before it.
    """
    return named_arrays(composite, lambda field: loop_of(field) is not None)


def helper_of(field: FieldDescription) -> str:
    """Return the helper of the support module that calls the function for all elements;
    empty without such a function.
    """
    loop = loop_of(field)
    return "" if loop is None else "rounds" if loop.per_iteration > 1 else "each"


def reader(name: str) -> str:
    """Return the name of the function that reads an element or an iteration of an
    array.
    """
    return f"read_{name}"


def writer(name: str) -> str:
    """Return the name of the function that writes an element or an iteration of an
    array.
    """
    return f"write_{name}"
