"""Arithmetic of physical values: which integers and floats hold every step of it
without an error.

Languages differ in how they spell a step. They do not differ in which steps are exact,
so that is decided here.
"""

from __future__ import annotations

from functools import lru_cache

from icdgen.describe.integer_scale import (
    IntegerScale,
    fits_bits,
    integer_bits,
    integer_scale,
    is_computable,
)
from icdgen.describe.steps import EXACT_DOUBLE, EXACT_SINGLE, Steps
from icdgen.describe.storage import Storage
from icdgen.frozen import NamedTuple, dataclass
from icdgen.once import cached_property

_INT64_MAX = (1 << 63) - 1
_BITS_IN_DOUBLE = 32
"""The widest integers that every language converts to a double without a loss; the next
ones have 64 bits.
"""
_BITS_IN_SINGLE = 16
"""The widest integers that every language converts to a 32-bit float without a loss."""


class IntegerAccess(NamedTuple):
    """Accessors of a physical value in whole parts of its unit, without floating point."""

    scale: IntegerScale
    bits: int  # 32 | 64: of the signed integer that callers give and get
    setter_bits: int  # 32 | 64: of the integer in which a setter subtracts the offset
    least: int | None  # a setter refuses smaller values; None if the integer holds none
    most: int | None  # a setter refuses larger values; None if the integer holds none


class Int64Terms(NamedTuple):
    """p, c and q of `Steps` as literals of 64 bits; of a negated scale p and c have the
    opposite signs.
    """

    p: int
    c: int
    q: int
    is_negated: bool


@dataclass(frozen=True)
class ScaleArithmetic:
    """Arithmetic of a scale for raw values in an integer: physical = (raw*p + c) / q."""

    steps: Steps
    storage: Storage

    @property
    def is_exact_in_int64(self) -> bool:
        """Whether raw*p + c is exact in a signed integer of 64 bits and as a double, so
        that only the division rounds.

        The integer does not overflow for any value of the storage. The double is exact
        for the values of the field, which are fewer if the field has fewer bits than
        its storage.
        """
        p, c, _ = self.steps.terms
        return (
            not self.steps.is_wide
            and self.steps.exact_in_doubles
            and is_computable(self.storage, p, c, 64)
        )

    @property
    def is_exact_in_doubles(self) -> bool:
        """Whether the raw value, raw*p and raw*p + c are exact as doubles, so that only
        the division rounds.
        """
        return self._is_exact(_BITS_IN_DOUBLE, EXACT_DOUBLE)

    @property
    def is_exact_in_singles(self) -> bool:
        """Whether the raw value, raw*p and raw*p + c are exact as floats of 32 bits, so
        that only the division rounds.
        """
        return self._is_exact(_BITS_IN_SINGLE, EXACT_SINGLE)

    def _is_exact(self, most_bits: int, largest: int) -> bool:
        return (
            # Languages convert the integer of the storage, which can be wider than the
            # field.
            self.storage.bits <= most_bits
            and not self.steps.is_wide
            and self.steps.exact_up_to(largest)
        )

    @property
    def int64_terms(self) -> Int64Terms:
        """The terms of a scale that is not wide.

        An offset of 2**63 has no literal, but its negative has.
        """
        p, c, q = self.steps.terms
        return (
            Int64Terms(-p, -c, q, True)
            if c > _INT64_MAX
            else Int64Terms(p, c, q, False)
        )

    @cached_property
    def integers(self) -> IntegerAccess | None:
        """The integer accessors; None if the values are not whole thousandths or
        millionths, or a step may overflow.
        """
        scale = integer_scale(self.steps)
        bits = None if scale is None else integer_bits(scale, self.storage)
        if scale is None or bits is None:
            return None
        ends = Storage(bits, True)
        least, most = max(scale.least, ends.min), min(scale.most, ends.max)
        # A setter subtracts the offset before it divides, so both ends of its range
        # must fit after the subtraction.
        setter_bits = (
            32
            if bits == 32 and fits_bits(32, least - scale.offset, most - scale.offset)
            else 64
        )
        return IntegerAccess(
            scale,
            bits,
            setter_bits,
            least if least > ends.min else None,
            most if most < ends.max else None,
        )


@lru_cache(maxsize=4096)
def arithmetic_of(steps: Steps, storage: Storage) -> ScaleArithmetic:
    """Return the arithmetic of a scale."""
    return ScaleArithmetic(steps, storage)
