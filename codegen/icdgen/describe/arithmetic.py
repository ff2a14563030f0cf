"""Arithmetic of linear scales, physical = (raw*p + c) / q: which integers and floats
represent every step of it without an error.

`arithmetic_of` is the entry. Which steps are exact is decided here for all languages.
The languages differ in which type they use: C computes raw*p + c in integers of 64
bits, Rust in floats.
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
# Rust has `f64::from` only for integers of up to 32 bits, and `f32::from` only for
# integers of up to 16 bits. Wider types have values that are no such floats.
_WIDEST_STORAGE_FOR_DOUBLE = 32
_WIDEST_STORAGE_FOR_SINGLE = 16


class IntegerAccess(NamedTuple):
    """Integer types and limits of the accessors of a physical value in thousandths or
    millionths of its unit, for programs without floating point.
    """

    scale: IntegerScale
    bits: int  # 32 | 64: of the signed integer that callers give and get
    setter_bits: int  # 32 | 64: of the difference `value - offset` in a setter in C
    # A setter refuses smaller values than `least` and larger ones than `most`. None: no
    # check, since the type has no such values.
    least: int | None
    most: int | None


class Int64Terms(NamedTuple):
    """Terms p, c and q of a scale as literals of 64 bits.

    If ``is_negated``, they compute the negative of the physical value. This is so only
    for c = 2**63, for which there is no literal; -2**63 has one.
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
    def is_exact_in_int64_and_double(self) -> bool:
        """Whether raw*p + c is exact in a signed integer of 64 bits and also as a
        double, so that only the division rounds. Generated C computes the integer and
        divides it as a double (`icdgen_quotient`).

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
    def is_computable_in_doubles(self) -> bool:
        """Whether code can compute in doubles so that only the division rounds.

        In addition to `Steps.exact_in_doubles`, every value of the storage type is a
        double, so that languages convert it without a loss.
        """
        return self._is_exact(_WIDEST_STORAGE_FOR_DOUBLE, EXACT_DOUBLE)

    @property
    def is_computable_in_singles(self) -> bool:
        """Whether code can compute in floats of 32 bits so that only the division
        rounds.
        """
        return self._is_exact(_WIDEST_STORAGE_FOR_SINGLE, EXACT_SINGLE)

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
        """Terms of a scale that is not wide."""
        p, c, q = self.steps.terms
        return (
            Int64Terms(-p, -c, q, True)
            if c > _INT64_MAX
            else Int64Terms(p, c, q, False)
        )

    @cached_property
    def integer_access(self) -> IntegerAccess | None:
        """Types and limits of the accessors in thousandths or millionths; None if the
        values are not whole numbers of these, or a step may overflow.
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
    """Return the arithmetic of a scale; the same object for the same arguments, so
    that `integer_access` is computed once.
    """
    return ScaleArithmetic(steps, storage)
