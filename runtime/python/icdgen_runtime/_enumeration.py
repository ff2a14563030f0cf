"""Enumerations that keep values they do not know."""

from __future__ import annotations

from enum import IntEnum

_KEPT = 256  # unknown values below this are made once, so that `is` works


class OpenEnum(IntEnum):
    """An integer with a name where the manual gives one.

    A value that the manual does not list becomes a member of its own, such as
    ``UNKNOWN_7``, so that decoding never fails and encoding gives back what came.
    """

    label: str
    """The manual's name, verbatim; empty for a value that it does not list."""

    def __new__(cls, value: int, label: str = "") -> OpenEnum:  # noqa: PYI034
        self = int.__new__(cls, value)
        self._value_ = value
        self.label = label
        return self

    @classmethod
    def _missing_(cls, value: object) -> object:
        if not isinstance(value, int) or not 0 <= value < 1 << 64:
            return None
        self = int.__new__(cls, value)
        self._name_ = f"UNKNOWN_{value:d}"
        self._value_ = int(value)
        self.label = ""
        if value < _KEPT:
            cls._value2member_map_[int(value)] = self
        return self

    def __reduce_ex__(self, protocol: object) -> tuple[type[OpenEnum], tuple[int]]:
        return type(self), (int(self),)

    def __str__(self) -> str:
        return str(int(self))

    @property
    def is_known(self) -> bool:
        """Whether the manual lists the value."""
        return self.label != ""
