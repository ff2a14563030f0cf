"""Frames that differ in length: each is the beginning of the longest one, which is decoded and encoded."""

from __future__ import annotations

from . import _lazy
from ._codec import range_error
from ._errors import LengthError, RangeError


def decoder(owner: _lazy.Any, longest: _lazy.Any) -> _lazy.Any:
    """``from_bytes`` of a class whose longest frames ``longest`` decodes."""
    tail = owner.TAIL

    def from_bytes(cls: _lazy.Any, data: _lazy.Buffer) -> _lazy.Any:
        count = count_in(cls, data)
        self = longest(cls, padded(cls, data))
        if tail.counter and getattr(self, tail.counter) + tail.plus != count:
            told = getattr(self, tail.counter) + tail.plus
            expected = max(0, cls.LENGTH - (tail.most - told) * tail.step)
            raise LengthError(cls.NAME, expected, memoryview(data).nbytes)
        setattr(self, tail.part, getattr(self, tail.part)[:count])
        return self

    return from_bytes


def filling_decoder(owner: _lazy.Any, whole: _lazy.Any) -> _lazy.Any:
    """``from_bytes`` of a class whose frames may lack the zeros that they end with; ``whole`` decodes those that do not."""

    def from_bytes(cls: _lazy.Any, data: _lazy.Buffer) -> _lazy.Any:
        actual = memoryview(data).nbytes
        if actual == owner.LENGTH:
            return whole(cls, data)
        if not actual:
            raise LengthError(cls.NAME, 1, actual)
        return whole(cls, padded(cls, data))

    return from_bytes


def encoder(owner: _lazy.Any, longest: _lazy.Any) -> _lazy.Any:
    """``to_bytes`` of a class whose longest frames ``longest`` encodes."""
    tail = owner.TAIL
    info = next(one for one in owner.FIELDS if one.attribute == tail.part)
    is_array = info.elements > 0
    least = owner.LENGTH - tail.most * tail.step
    rest: _lazy.Any = bytes(tail.most)
    if is_array:
        from . import _compiled

        zeros = _compiled.longest(owner, "from_bytes")(owner, bytes(owner.LENGTH))
        rest = getattr(zeros, tail.part)

    def to_bytes(self: _lazy.Any) -> bytes:
        values = getattr(self, tail.part)
        try:
            values = tuple(values) if is_array else memoryview(values).tobytes()
        except TypeError:
            raise range_error(self) from None
        count = len(values)
        if not info.fewest <= count <= tail.most:
            raise range_error(self)
        if tail.counter and getattr(self, tail.counter) != count - tail.plus:
            less = f", of which there are {count}" if tail.plus else ""
            allowed = f"{count - tail.plus}, as many as {tail.part} has{less}"
            raise RangeError(tail.counter, allowed, getattr(self, tail.counter))
        whole = object.__new__(type(self))
        for one in self.FIELDS:
            setattr(whole, one.attribute, getattr(self, one.attribute))
        setattr(whole, tail.part, values + rest[count:])
        frame: bytes = longest(whole)
        return frame[: least + count * tail.step]

    return to_bytes


def count_in(message: _lazy.Any, data: _lazy.Buffer) -> int:
    """How many elements the end of a frame has. Raises `LengthError`."""
    tail, actual = message.TAIL, memoryview(data).nbytes
    begin: int = message.LENGTH - tail.most * tail.step
    step: int = tail.step
    count, part = divmod(actual - begin, step)
    least = begin + max(0, tail.plus) * step
    if actual < least:
        raise LengthError(message.NAME, least, actual)
    if actual > message.LENGTH:
        raise LengthError(message.NAME, message.LENGTH, actual)
    if part:
        raise LengthError(message.NAME, actual - part, actual)
    return count


def padded(message: _lazy.Any, data: _lazy.Buffer) -> bytes:
    """The longest frame, of which the rest is 0."""
    return memoryview(data).tobytes().ljust(message.LENGTH, b"\0")
