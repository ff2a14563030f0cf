"""Lengths of frames: bytes of elements, and the comparisons by which a decoder accepts
the lengths of a message.

A backend spells each `LengthTest` as one comparison. Comparisons that are always true
are left out, because compilers and linters report them.
"""

from __future__ import annotations

from typing import Literal

from icdgen.frozen import NamedTuple


class LengthTest(NamedTuple):
    """Comparison that every length of a message passes. ``value`` is in bytes."""

    kind: Literal["equal", "at least", "at most", "multiple"]
    value: int
    without: int = 0  # bytes to subtract first, for a multiple


class ElementBytes(NamedTuple):
    """Number of bytes that depends on a number of elements: ``before`` plus ``step``
    for each element.
    """

    before: int
    step: int


def length_tests(lengths: range, minimum: int = 0) -> tuple[LengthTest, ...]:
    """Return the tests that only these lengths pass, among all lengths of at least
    ``minimum`` bytes.
    """
    least, most, step = lengths[0], lengths[-1], lengths.step
    # A comparison that is always true is an error of compilers and linters (`length >=
    # 0u`).
    tests = [LengthTest("at least", least)] if least > minimum else []
    tests.append(LengthTest("at most", most))
    if step > 1:
        tests.append(LengthTest("multiple", step, least))
    return tuple(tests)


def length_tests_of_frame(lengths: range) -> tuple[LengthTest, ...]:
    """Return the tests for frames of a message: a single one if all have the same
    length.
    """
    return (
        (LengthTest("equal", lengths[0]),)
        if len(lengths) == 1
        else length_tests(lengths)
    )
