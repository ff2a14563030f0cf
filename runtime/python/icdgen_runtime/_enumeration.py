"""Enumerations that preserve unknown values."""

from __future__ import annotations

from enum import IntEnum

# Unknown values below this are created once, so that `is` works. Any number of larger
# ones would stay in memory.
_KEPT = 256


class OpenEnum(IntEnum):
    """An integer with a name if the manual gives one.

    An unknown value becomes an additional member such as ``UNKNOWN_7``. Decoding
    therefore never fails, and encoding returns the received value. A value in a range
    of the manual has the label of the range: in ``RESERVED_FIRST`` to
    ``RESERVED_LAST``, 17 is ``RESERVED_17``.
    """

    label: str
    """The manual's name, verbatim; empty for a value that the manual does not list."""

    __ranges__: tuple[tuple[int, int, str, str], ...] = ()

    def __new__(cls, value: int, label: str = "") -> OpenEnum:  # noqa: PYI034
        self = int.__new__(cls, value)
        self._value_ = value
        self.label = label
        return self

    @classmethod
    def _missing_(cls, value: object) -> object:
        low, high = (-(1 << 63), 1 << 63) if is_signed(cls) else (0, 1 << 64)
        if not isinstance(value, int) or not low <= value < high:
            return None
        self = int.__new__(cls, value)
        words, self.label = cls._range_of(value)
        self._name_ = f"{words}_{'MINUS_' if value < 0 else ''}{abs(value)}"
        self._value_ = int(value)
        if abs(value) < _KEPT:
            cls._value2member_map_[int(value)] = self
        return self

    @classmethod
    def _range_of(cls, value: int) -> tuple[str, str]:
        """Return the name in code and the label of a value that is not a member."""
        for first, last, words, label in cls.__ranges__:
            if first <= value <= last:
                return words, label
        return "UNKNOWN", ""

    def __reduce_ex__(self, protocol: object) -> tuple[type[OpenEnum], tuple[int]]:
        return type(self), (int(self),)

    def __str__(self) -> str:
        return str(int(self))

    @property
    def is_known(self) -> bool:
        """Whether the manual lists the value."""
        return self.label != ""


def is_signed(enum: type[OpenEnum]) -> bool:
    """Return whether the values are in two's complement: the manual lists a negative
    one.
    """
    return any(member < 0 for member in enum.__members__.values())
