"""Statements of generated C. The test which message a frame is agrees with the ICD for
all lengths, and reads only the bytes that the frame has.
"""

from __future__ import annotations

import random
import re

import pytest

from icdgen.backends.c.names import constant
from icdgen.backends.c.statement import (
    FAILED,
    assigned_byte,
    call,
    either,
    frame_test,
    grouped,
    head,
    joined,
    length_test,
    loop,
)
from icdgen.describe import describe
from icdgen.describe.lengths import LengthTest
from icdgen.describe.nodes import MessageOfId
from tests.conformance import odd
from tests.conformance.icds import icd_of
from tests.limits import assert_limits

_CHOICE = re.compile(r"\((\(length [<>]=? \d+u\)) \? (buffer\[\d+\]) : 0u\)")


def candidates() -> list[MessageOfId]:
    """Return the messages of shared ids, some of which can end early."""
    (node,) = (
        node
        for node in describe(icd_of([odd.FOLDER / "apart.yaml"])).nodes
        if node.name == "apart"
    )
    return [
        candidate
        for direction in ("telecommand", "telemetry")
        for of_id in node.ids(direction)
        if of_id.is_shared
        for candidate in of_id.messages
    ]


def in_python(test: str, candidate: MessageOfId) -> str:
    """Return a test in C as an expression of Python."""
    message = candidate.message
    test = _CHOICE.sub(r"(\2 if \1 else 0)", " ".join(test.split()))
    test = test.replace(constant(message, "length"), str(message.model.length))
    return re.sub(r"\b(\d+|0x[0-9A-F]+)u\b", r"\1", test.replace("&&", "and"))


def is_frame(candidate: MessageOfId, frame: bytes) -> bool:
    """Return whether a frame, with its omitted zeros, has the length and the constants
    of a message.
    """
    lengths = candidate.message.model.layout.lengths
    complete = frame.ljust(lengths[-1], b"\0")
    return len(frame) in lengths and all(
        complete[byte] & mask == value for byte, mask, value in candidate.constant_bytes
    )


@pytest.mark.parametrize(
    "candidate", candidates(), ids=lambda candidate: candidate.message.name
)
def test_a_frame_is_recognized_without_reading_behind_its_end(candidate):
    source = random.Random(1)
    expression = compile(in_python(frame_test(candidate), candidate), "test", "eval")
    longest = candidate.message.model.length
    accepted = set()
    for length in range(longest + 2):
        for changed in (None, *range(length)):
            frame = bytearray(source.randbytes(length))
            for byte, mask, value in candidate.constant_bytes:
                if byte < length:
                    frame[byte] = frame[byte] & ~mask | value
            if changed is not None:
                frame[changed] ^= 1 << source.randrange(8)
            # A byte behind the end raises an `IndexError`.
            result = eval(expression, {"buffer": frame, "length": length})
            assert result == is_frame(candidate, bytes(frame)), frame.hex()
            accepted.add(result)
    assert True in accepted


def test_operands_and_bytes_are_converted_and_in_parentheses_where_c_needs_them():
    assert grouped("a << b") == "(a << b)"
    assert grouped("f(a << b)") == "f(a << b)"
    assert joined(["a << b"]) == "a << b"
    assert joined(["a << b", "c"]) == "(a << b) | c"
    assert assigned_byte("b", ["ICDGEN_U8(x)"]) == "b = ICDGEN_U8(x);"
    assert assigned_byte("b", ["x >> 3"]) == "b = ICDGEN_U8(x >> 3);"
    assert assigned_byte("b", ["ICDGEN_U8(x)", "y"]) == (
        "b = ICDGEN_U8(ICDGEN_U8(x) | y);"
    )


def test_an_assignment_that_is_too_long_has_a_line_for_each_term():
    terms = [letter * 50 for letter in "abc"]
    assert assigned_byte("buffer[0]", terms) == "\n".join(
        (
            "buffer[0] = ICDGEN_U8(",
            f"        {terms[0]} |",
            f"        {terms[1]} |",
            f"        {terms[2]});",
        )
    )


def test_loops_count_by_one_or_by_several():
    assert loop("i", "n") == "for (size_t i = 0u; i < n; i++) {"
    assert loop("i", "8u", 2) == "for (size_t i = 0u; i < 8u; i += 2u) {"


def test_each_test_of_several_is_in_parentheses():
    assert (either(["a"]), either(["a", "b"])) == ("a", "(a) || (b)")
    assert either(["a", "b"], " && ") == "(a) && (b)"


def test_calls_and_heads_have_a_line_for_each_argument_if_they_are_too_long():
    assert call("f", ["a", "b"]) == "f(a, b);"
    assert call("f", []) == "f();"
    long = "x" * 60
    assert call("f", [long, long]) == f"f(\n        {long},\n        {long});"
    assert call("f", [long, long], 2) == (
        f"f(\n            {long},\n            {long});"
    )
    assert head("bool ", "f", "int a", "int b") == "static inline bool f(int a, int b)"
    assert head("bool ", "f", long, long) == (
        f"static inline bool f(\n    {long},\n    {long})"
    )
    # Statements of a function have an indentation of one step.
    assert_limits(lambda n: "\n" not in call("f", ["x" * (n - 8)]), most=120)
    assert_limits(lambda n: "\n" not in head("", "f", "x" * (n - 17)), most=120)


@pytest.mark.parametrize(
    ("test", "passed", "failed"),
    [
        (LengthTest("equal", 4), "length == LONGEST", "length != LONGEST"),
        (LengthTest("at least", 2), "length >= 2u", "length < 2u"),
        (LengthTest("at most", 9), "length <= LONGEST", "length > LONGEST"),
        (LengthTest("multiple", 3), "(length % 3u) == 0u", "(length % 3u) != 0u"),
        (
            LengthTest("multiple", 3, 1),
            "((length - 1u) % 3u) == 0u",
            "((length - 1u) % 3u) != 0u",
        ),
    ],
)
def test_a_length_passes_or_fails_a_test(test, passed, failed):
    assert length_test(test, "LONGEST") == passed
    assert length_test(test, "LONGEST", FAILED) == failed
