"""Tests of the length of a frame: which comparisons show that a frame is one of a message."""

from __future__ import annotations

from typing import Literal, NamedTuple


class LengthTest(NamedTuple):
    """A comparison that every length of a message passes. ``value`` is in bytes."""

    kind: Literal["equal", "at least", "at most", "multiple"]
    value: int
    without: int = 0  # bytes of the length that are not counted before it is a multiple


def length_tests(lengths: range, known: int = 0) -> tuple[LengthTest, ...]:
    """The tests that tell these lengths from all others, of which there are at least ``known`` bytes."""
    least, most, step = lengths[0], lengths[-1], lengths.step
    tests = [LengthTest("at least", least)] if least > known else []
    tests.append(LengthTest("at most", most))
    if step > 1:
        tests.append(LengthTest("multiple", step, least))
    return tuple(tests)


def length_tests_of_frame(lengths: range) -> tuple[LengthTest, ...]:
    """The tests for the frame of a message: one if all have the same length."""
    return (LengthTest("equal", lengths[0]),) if len(lengths) == 1 else length_tests(lengths)
