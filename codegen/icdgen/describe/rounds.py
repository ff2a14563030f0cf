"""Arrays of flags, and of numbers that are no words: as many elements as are whole bytes are read and written alike, in rounds."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from math import gcd
from typing import NamedTuple

from icdgen.describe.description import FieldDescription

MANY_ENOUGH = 4
"""From this many elements on there are rounds; of fewer, each is read and written by itself."""


class Rounds(NamedTuple):
    """``turns`` rounds of ``in_round`` elements; what is left of the array is none."""

    in_round: int
    turns: int
    begin: int  # the first byte of the first
    step: int  # bytes of each

    @property
    def elements(self) -> int:
        """How many there are in all rounds."""
        return self.turns * self.in_round

    @property
    def length(self) -> int:
        """Bytes of all rounds."""
        return self.turns * self.step

    def members(self, first: FieldDescription, name: Callable[[int], str]) -> tuple[FieldDescription, ...]:
        """The elements of one round, counted from where its bytes begin; ``name`` is what they are called by in code."""
        found = []
        for element in range(self.in_round):
            one = copy(first)
            one.model = replace(first.model, at=element * first.model.bits, count=0)
            one.member = name(element)
            found.append(one)
        return tuple(found)


def rounds_of(first: FieldDescription, count: int) -> Rounds | None:
    """Those of an array of ``count`` elements, which begins with ``first``; None of few, and of what begins within a byte."""
    at, bits = first.model.at, first.model.bits
    if at % 8 or first.model.is_bytes or first.model.when:
        return None
    in_round = 8 // gcd(8, bits)
    rounds = Rounds(in_round, count // in_round, at // 8, in_round * bits // 8)
    return rounds if rounds.turns > 1 and rounds.elements >= MANY_ENOUGH else None
