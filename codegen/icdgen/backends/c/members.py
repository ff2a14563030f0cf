"""Statements for members of a message that set initial values, and that test raw values
against the bits of their fields.

Elements of arrays have the same statements in a loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from icdgen.backends.c import bits, constants
from icdgen.backends.c.decoding import element_count
from icdgen.backends.c.statement import loop
from icdgen.backends.c.text import literal
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Composite, Into

_Lines = Callable[[FieldDescription, str, str], list[str]]
"""Function that returns the lines for a field, given its names in C and in the ICD;
empty if the field needs none.
"""


def _statements_of_field(
    field: FieldDescription,
    lines_of: _Lines,
    count: str,
    owner: str = "",
    of: str = "",
    depth: int = 1,
) -> list[str]:
    """Return the lines for a field; for an array in a loop over ``count`` elements, an
    expression in C.
    """
    name, member = of + field.model.name, owner + field.member
    if not field.count:
        return lines_of(field, member, name)
    # An inner loop has an index of its own name: compilers warn if a variable hides
    # another one (`-Wshadow`).
    index = "element" if depth == 1 else f"element_{depth}"
    has_loop = count != "1u"
    member += f"[{index}]" if has_loop else "[0]"
    lines = []
    if field.element_struct is None:
        lines += lines_of(field, member, name)
    else:
        for inner in field.element_struct.walk(Into.STRUCTS):
            lines += _statements_of_field(
                inner,
                lines_of,
                f"{inner.count}u",
                f"{member}.",
                f"{name}[].",
                depth + 1,
            )
    if not lines or not has_loop:
        return lines
    return [loop(index, count), *(f"{STEP}{line}" for line in lines), "}"]


def initial_statements(message: Composite[Any]) -> list[str]:
    """Return the statements that set constants, and counters to their smallest value."""
    # `memset` has cleared the message, so only values other than 0 need a statement.
    counters = [field for field in message.members if field.model.smallest_raw]
    lines = [f"message->{field.member} = {field.initial_raw}u;" for field in counters]
    for field in message.walk(Into.STRUCTS):
        if field.initial_count or not field.count:
            lines += _statements_of_field(
                field, _initial_lines, f"{field.initial_count}u"
            )
    return lines


def _initial_lines(field: FieldDescription, member: str, name: str) -> list[str]:
    return (
        []
        if field.model.const is None
        else [f"message->{member} = {constants.only_value_macro(field)};"]
    )


def misfits(message: MessageDescription, is_last_part: bool) -> list[str]:
    """Return the statements that return the name of the first field whose raw value
    does not fit.

    They test the fields of the last variable part, or all others: the count must be
    valid before its elements are tested.
    """
    return _range_tests(message, is_last_part, _name_of_misfit)


def excess(message: MessageDescription) -> list[str]:
    """Return the statements that collect bits that do not fit in ``bits_beyond_field``."""
    return [
        line
        for is_last_part in (False, True)
        for line in _range_tests(message, is_last_part, _gathered)
    ]


def _range_tests(
    message: MessageDescription, is_last_part: bool, lines_of: _Lines
) -> list[str]:
    lines = []
    for field in message.walk(Into.STRUCTS):
        if field.needs_range_check and field.is_in_last_part == is_last_part:
            count = (
                element_count(message.last_part)
                if is_last_part and message.last_part
                else f"{field.count}u"
            )
            lines += _statements_of_field(field, lines_of, count)
    return lines


def _name_of_misfit(field: FieldDescription, member: str, name: str) -> list[str]:
    if not field.is_narrow:
        return []
    return [
        f"if (({bits.bits_beyond_field(field, member)}) != 0u) {{",
        f"{STEP}return {literal(name)};",
        "}",
    ]


def _gathered(field: FieldDescription, member: str, name: str) -> list[str]:
    return (
        [f"excess |= {bits.bits_beyond_field(field, member)};"]
        if field.is_narrow
        else []
    )
