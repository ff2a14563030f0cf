"""How operands, calls and the heads of functions are written."""

from __future__ import annotations

import re
from collections.abc import Sequence

from icdgen.backends.c.names import constant
from icdgen.backends.c.text import WIDTH
from icdgen.backends.lines import STEP, bracketed
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
    terms = _lengths(message.model.layout.lengths, constant(message, "length"))
    for sign in candidate.signs:
        byte = f"buffer[{sign.byte}]"
        if sign.byte >= message.model.layout.shortest:
            byte = f"((length > {sign.byte}u) ? {byte} : 0u)"
        masked = byte if sign.mask == 0xFF else f"({byte} & 0x{sign.mask:02X}u)"
        terms.append(f"{masked} == 0x{sign.value:02X}u")
    return either(terms, f" &&\n{STEP * depth}")


def _lengths(lengths: range, longest: str) -> list[str]:
    """What holds of the ``length`` of a frame; ``longest`` is the macro of the longest."""
    least, step = lengths[0], lengths.step
    if len(lengths) == 1:
        return [f"length == {longest}"]
    tests = [f"length >= {least}u"] if least else []
    tests.append(f"length <= {longest}")
    if step > 1:
        rest = f"(length - {least}u)" if least else "length"
        tests.append(f"({rest} % {step}u) == 0u")
    return tests


def head(returned: str, name: str, *parameters: str) -> str:
    """The head of a function."""
    return bracketed(f"static inline {returned}{name}(", parameters, ")", WIDTH, last="")
