"""Exceptions of this package."""

from __future__ import annotations


class IcdError(ValueError):
    """Base class of all errors of this package."""


class LengthError(IcdError):
    """Length mismatch: a frame has ``actual`` bytes instead of ``expected``."""

    def __init__(self, message: str, expected: int, actual: int) -> None:
        super().__init__(f"{message} has {expected} bytes, {actual} given")
        self.message, self.expected, self.actual = message, expected, actual

    def __reduce__(self) -> tuple[type[LengthError], tuple[str, int, int]]:
        return LengthError, (self.message, self.expected, self.actual)


class RangeError(IcdError):
    """Value out of range: attribute ``field`` accepts ``allowed``, not ``value``."""

    def __init__(self, field: str, allowed: str, value: object) -> None:
        super().__init__(f"{field} takes {allowed}, not {_shortly(value)}")
        self.field, self.allowed, self.value = field, allowed, value

    def __reduce__(self) -> tuple[type[RangeError], tuple[str, str, object]]:
        return RangeError, (self.field, self.allowed, self.value)


class UnknownIdError(IcdError):
    """The node has no message with this ``kind`` and ``id``.

    ``why`` is any further reason.
    """

    def __init__(self, node: str, kind: str, id: object, why: str = "") -> None:
        what = f"{node} has no {kind} {_shortly(id)}"
        super().__init__(f"{what}: {why}" if why else what)
        self.node, self.kind, self.id, self.why = node, kind, id, why

    def __reduce__(self) -> tuple[type[UnknownIdError], tuple[str, str, object, str]]:
        return UnknownIdError, (self.node, self.kind, self.id, self.why)


def _shortly(value: object) -> str:
    try:
        text = repr(value)
    except ValueError:  # an integer of too many digits to print
        return "a very long number"
    return text if len(text) <= 60 else f"{text[:57]}..."


def span_of(least: float, most: float, unit: str = "") -> str:
    """Return a range of values with its unit, for a message.

    >>> span_of(0.0, 6553.5, "m/s")
    '0 to 6553.5 m/s'
    """
    ends = (repr(end).removesuffix(".0") for end in (least, most))
    return f"{' to '.join(ends)} {unit}".rstrip()
