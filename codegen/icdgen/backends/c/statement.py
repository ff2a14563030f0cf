"""Operands, calls, loops, tests and heads of functions.

These functions know the syntax, the line width and the warnings of C, and nothing of
fields. The other modules of the backend put statements together with them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from icdgen.backends.c.names import constant
from icdgen.backends.c.text import WIDTH
from icdgen.backends.lines import STEP, bracketed
from icdgen.describe.lengths import LengthTest
from icdgen.describe.nodes import MessageOfId

PASSED = {"equal": "==", "at least": ">=", "at most": "<=", "multiple": "=="}
"""Operators of a `LengthTest` for lengths that pass it."""
FAILED = {"equal": "!=", "at least": "<", "at most": ">", "multiple": "!="}
"""Operators of a `LengthTest` for lengths that fail it."""

_COMPOUND = re.compile(r" (?:<<|>>|&) \w+\Z")


def grouped(term: str) -> str:
    """Return a term as an operand: in parentheses if it ends with an operation."""
    # Other terms are names, indices or calls, which bind tighter than any binary
    # operator.
    return f"({term})" if _COMPOUND.search(term) else term


def joined(terms: Sequence[str]) -> str:
    """Return the terms combined by ``|``."""
    return " | ".join(map(grouped, terms)) if len(terms) > 1 else terms[0]


def either(tests: Sequence[str], operator: str = " || ") -> str:
    """Return the disjunction of the tests; with ``&&`` as the operator their
    conjunction.
    """
    # The parentheses make the precedence visible (MISRA C:2012, rule 12.1).
    return operator.join(f"({test})" for test in tests) if len(tests) > 1 else tests[0]


def call(function: str, arguments: Sequence[str], depth: int = 1) -> str:
    """Return a call as a statement in a line with an indentation of ``depth`` steps."""
    return bracketed(f"{function}(", arguments, ");", WIDTH, STEP * depth, last="")


def loop(index: str, count: str, by: int = 1) -> str:
    """Return the head of a loop over ``count`` elements, ``by`` of them at once."""
    step = f"{index}++" if by == 1 else f"{index} += {by}u"
    return f"for (size_t {index} = 0u; {index} < {count}; {step}) {{"


def assigned_byte(target: str, terms: Sequence[str]) -> str:
    """Return the statement that assigns terms, combined by ``|``, to a byte."""
    value = joined(terms)
    if not (len(terms) == 1 and value.startswith("ICDGEN_U8(") and value.endswith(")")):
        # `|` and `<<` have promoted the terms to `int`. Without the conversion,
        # `-Wconversion` warns about the assignment.
        value = f"ICDGEN_U8({value})"
    line = f"{target} = {value};"
    if len(STEP) + len(line) <= WIDTH or len(terms) == 1:
        return line
    rows = f" |\n{STEP * 2}".join(map(grouped, terms))
    return f"{target} = ICDGEN_U8(\n{STEP * 2}{rows});"


def frame_test(candidate: MessageOfId, depth: int = 3) -> str:
    """Return the test whether a frame is that of a message, by its length and the bytes
    of its constants.

    Bytes behind the end of a shortened frame count as 0. ``depth`` is the indentation
    of the lines after the first.
    """
    longest = constant(candidate.message, "length")
    terms = [length_test(test, longest) for test in candidate.length_tests]
    for constant_byte in candidate.constant_bytes:
        byte = f"buffer[{constant_byte.byte}]"
        if candidate.can_lack(constant_byte):
            byte = f"((length > {constant_byte.byte}u) ? {byte} : 0u)"
        masked = (
            byte
            if constant_byte.mask == 0xFF
            else f"({byte} & 0x{constant_byte.mask:02X}u)"
        )
        terms.append(f"{masked} == 0x{constant_byte.value:02X}u")
    return either(terms, f" &&\n{STEP * depth}")


def length_test(
    test: LengthTest, longest: str, operators: Mapping[str, str] = PASSED
) -> str:
    """Return the condition for a ``length`` that passes a test, or fails it with the
    operators `FAILED`.

    ``longest`` is the macro or number of the longest.
    """
    operator = operators[test.kind]
    if test.kind == "multiple":
        # The test of the shortest length comes before, so the difference does not
        # underflow.
        counted = f"(length - {test.without}u)" if test.without else "length"
        return f"({counted} % {test.value}u) {operator} 0u"
    bound = f"{test.value}u" if test.kind == "at least" else longest
    return f"length {operator} {bound}"


def head(returned: str, name: str, *parameters: str) -> str:
    """Return the head of a function."""
    return bracketed(
        f"static inline {returned}{name}(", parameters, ")", WIDTH, last=""
    )
