"""Arrays that code reads and writes in a loop, or by a function for an element.

These are arrays of structs, and arrays of numbers that are not whole words. An
iteration handles one element. Of elements that do not end at a byte, such as flags or
numbers of 12 bits, it handles as many as are whole bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import gcd
from typing import Any

from icdgen.describe.description import (
    Composite,
    FieldDescription,
    Into,
    StructDescription,
)
from icdgen.frozen import NamedTuple

MANY_ENOUGH = 4
"""Smallest number of elements for which a loop is shorter than a statement for each."""


class StructArray(NamedTuple):
    """Array of structs in a message, or in an element of another array of the message."""

    field: FieldDescription
    element_struct: StructDescription  # in the orders in effect here
    name: str  # with the names of enclosing arrays: ``satellites_signals``

    @property
    def begin(self) -> int:
        """First byte, counted from the start of the message or element that has the
        array.
        """
        return self.field.model.at // 8

    @property
    def step(self) -> int:
        """Bytes of an element."""
        return self.element_struct.model.length

    @property
    def length(self) -> int:
        """Number of bytes of the frame."""
        return self.field.count * self.step


def struct_arrays_in(
    composite: Composite[Any], prefix: str = ""
) -> tuple[StructArray, ...]:
    """Return the arrays of structs of a message or struct, without arrays in their
    elements.

    Names start with ``prefix``.
    """
    return tuple(
        StructArray(field, field.element_struct, prefix + field.name)
        for field in composite.walk(Into.STRUCTS)
        if field.element_struct is not None
    )


class ArrayLoop(NamedTuple):
    """Loop over an array.

    An iteration handles as many elements as are whole bytes. Elements behind the last
    one are left over.
    """

    per_iteration: int  # elements of an iteration
    iterations: int
    begin: int  # first byte of the first iteration
    step: int  # bytes of an iteration

    @property
    def elements(self) -> int:
        """Number of elements of all iterations."""
        return self.iterations * self.per_iteration

    @property
    def length(self) -> int:
        """Number of bytes of all iterations."""
        return self.iterations * self.step

    def members(
        self, first: FieldDescription, name: Callable[[int], str]
    ) -> tuple[FieldDescription, ...]:
        """Return the elements of an iteration, with bits counted from its first byte.

        ``name`` gives their names in code.
        """
        elements = []
        # All iterations share their code, so positions are those in the bytes of one
        # iteration.
        for index in range(self.per_iteration):
            element = first.moved(
                replace(first.model, at=index * first.model.bits, count=0)
            )
            element.member = name(index)
            elements.append(element)
        return tuple(elements)


def loop_from(first: FieldDescription, count: int) -> ArrayLoop | None:
    """Return the loop over an array of ``count`` elements, which starts with ``first``.

    None if there are few elements, if the array does not start at a byte, or if its
    words are copied.
    """
    at, bits = first.model.at, first.model.bits
    if at % 8 or first.is_copied or first.model.conditions:
        return None
    # Two elements of 12 bits are three bytes, eight flags are one.
    per_iteration = 8 // gcd(8, bits)  # the fewest elements that end at a byte
    loop = ArrayLoop(
        per_iteration, count // per_iteration, at // 8, per_iteration * bits // 8
    )
    return loop if loop.iterations > 1 and loop.elements >= MANY_ENOUGH else None


def loop_of(field: FieldDescription) -> ArrayLoop | None:
    """Return the loop over all elements of an array; None if they are copied, or read
    and written one by one.
    """
    if field.element_struct is not None:
        return ArrayLoop(
            1, field.count, field.model.at // 8, field.element_struct.model.length
        )
    if not field.count or field.struct is not None:
        return None
    loop = loop_from(field, field.count)
    # Elements behind the last iteration would need statements of their own.
    return loop if loop is not None and loop.elements == field.count else None


def looped_arrays(
    composite: Composite[Any], prefix: str = ""
) -> Iterator[tuple[FieldDescription, str]]:
    """List the arrays of a message with a `loop_of` all their elements, and their
    names; arrays in elements of an array come before it.

    Names start with ``prefix``.
    """
    for field in composite.walk(Into.STRUCTS):
        if loop_of(field) is not None:
            name = prefix + field.name
            if field.element_struct is not None:
                # A C function is declared before the functions that call it, so those
                # of inner arrays come first.
                yield from looped_arrays(field.element_struct, f"{name}_")
            yield field, name


def all_struct_arrays(composite: Composite[Any]) -> Iterator[StructArray]:
    """List all arrays of structs of a message; arrays in elements of an array come
    before it.
    """
    for field, name in looped_arrays(composite):
        if field.element_struct is not None:
            yield StructArray(field, field.element_struct, name)
