"""How operands, calls and the heads of functions are written."""

from __future__ import annotations

import re
from collections.abc import Sequence

from icdgen.backends.c.names import constant
from icdgen.backends.c.text import WIDTH
from icdgen.backends.lines import STEP, bracketed
from icdgen.describe.lengths import LengthTest, length_tests_of_frame
from icdgen.describe.nodes import MessageOfId

_COMPOUND = re.compile(r" (?:<<|>>|&) \w+\Z")


def grouped(term: str) -> str:
    """The term as an operand: in parentheses if it ends with an operation."""
    return f"({term})" if _COMPOUND.search(term) else term


def joined(terms: Sequence[str]) -> str:
    """The terms, or-ed together."""
    return " | ".join(map(grouped, terms)) if len(terms) > 1 else terms[0]


def either(tests: Sequence[str], operator: str = " || ") -> str:
    """A test that holds if one of them does; with another ``operator``, if all do."""
    return operator.join(f"({test})" for test in tests) if len(tests) > 1 else tests[0]


def call(function: str, arguments: Sequence[str], depth: int = 1) -> str:
    """A call as a statement; ``depth`` is that of the line it begins in."""
    return bracketed(f"{function}(", arguments, ");", WIDTH, STEP * depth, last="")


def loop(index: str, count: str, by: int = 1) -> str:
    """The head of a loop over so many elements; ``by`` of them at once."""
    step = f"{index}++" if by == 1 else f"{index} += {by}u"
    return f"for (size_t {index} = 0u; {index} < {count}; {step}) {{"


def assigned_byte(target: str, terms: Sequence[str]) -> str:
    """A statement that gives a byte the value of terms or-ed together."""
    value = joined(terms)
    if not (len(terms) == 1 and value.startswith("ICDGEN_U8(") and value.endswith(")")):
        value = f"ICDGEN_U8({value})"
    line = f"{target} = {value};"
    if len(STEP) + len(line) <= WIDTH or len(terms) == 1:
        return line
    rows = f" |\n{STEP * 2}".join(map(grouped, terms))
    return f"{target} = ICDGEN_U8(\n{STEP * 2}{rows});"


def like(candidate: MessageOfId, depth: int = 3) -> str:
    """Whether a frame is that of a message: its length, and the bytes of its constants; 0 where zeros are cut off.

    ``depth`` is that of the lines after the first.
    """
    message = candidate.message
    tests = length_tests_of_frame(message.model.layout.lengths)
    terms = [length_test(test, constant(message, "length")) for test in tests]
    for sign in candidate.constant_bytes:
        byte = f"buffer[{sign.byte}]"
        if sign.byte >= message.model.layout.shortest:
            byte = f"((length > {sign.byte}u) ? {byte} : 0u)"
        masked = byte if sign.mask == 0xFF else f"({byte} & 0x{sign.mask:02X}u)"
        terms.append(f"{masked} == 0x{sign.value:02X}u")
    return either(terms, f" &&\n{STEP * depth}")


def length_test(test: LengthTest, longest: str) -> str:
    """What holds of a ``length`` that passes; ``longest`` is the macro of the longest."""
    if test.kind == "multiple":
        return f"{_remainder(test)} == 0u"
    operators = {"equal": "==", "at least": ">=", "at most": "<="}
    return f"length {operators[test.kind]} {_bytes(test, longest)}"


def failed_length_test(test: LengthTest, longest: str) -> str:
    """What holds of a ``length`` that does not pass."""
    if test.kind == "multiple":
        return f"{_remainder(test)} != 0u"
    operators = {"equal": "!=", "at least": "<", "at most": ">"}
    return f"length {operators[test.kind]} {_bytes(test, longest)}"


def _bytes(test: LengthTest, longest: str) -> str:
    return f"{test.value}u" if test.kind == "at least" else longest


def _remainder(test: LengthTest) -> str:
    counted = f"(length - {test.without}u)" if test.without else "length"
    return f"({counted} % {test.value}u)"


def head(returned: str, name: str, *parameters: str) -> str:
    """The head of a function."""
    return bracketed(f"static inline {returned}{name}(", parameters, ")", WIDTH, last="")
