"""Frames of different lengths.

Each is converted to or from the longest frame, which the compiled functions process.
`decoder`, `filling_decoder` and `encoder` return the methods ``from_bytes`` and
``to_bytes`` of a class. They raise `LengthError` if the length is not possible.
"""

from __future__ import annotations

from . import _types
from ._codec import range_error
from ._errors import LengthError, RangeError


def decoder(owner: _types.Any, longest: _types.Any) -> _types.Any:
    """Return ``from_bytes`` of a class with variable-length fields.

    ``longest`` decodes the longest frames.
    """
    tail = owner.TAIL

    def from_bytes(cls: _types.Any, data: _types.Buffer) -> _types.Any:
        frame, lacking = spread(cls, data)
        count = count_in(cls, frame, lacking)
        self = longest(cls, _completed(cls, frame, data))
        if tail.counter and getattr(self, tail.counter) + tail.plus != count:
            counted = getattr(self, tail.counter) + tail.plus
            expected = _end(cls) - (tail.most - counted) * tail.step - lacking
            raise LengthError(cls.NAME, max(0, expected), memoryview(data).nbytes)
        setattr(self, tail.part, getattr(self, tail.part)[:count])
        return self

    return from_bytes


def filling_decoder(owner: _types.Any, whole: _types.Any) -> _types.Any:
    """Return ``from_bytes`` of a class whose frames may lack the zeros at their end.

    ``whole`` decodes complete frames.
    """

    def from_bytes(cls: _types.Any, data: _types.Buffer) -> _types.Any:
        actual = memoryview(data).nbytes
        if actual == owner.LENGTH:
            return whole(cls, data)
        if not actual:
            raise LengthError(cls.NAME, 1, actual)
        return whole(cls, padded(cls, data))

    return from_bytes


def encoder(owner: _types.Any, longest: _types.Any, padding: _types.Any) -> _types.Any:
    """Return ``to_bytes`` of a class with variable-length fields.

    ``longest`` encodes the longest frames. ``padding`` is the maximum number of
    elements at the end, all of them 0.
    """
    tail = owner.TAIL
    info = next(field for field in owner.FIELDS if field.attribute == tail.part)
    is_array = info.elements > 0
    end = _end(owner)
    least = end - tail.most * tail.step

    def to_bytes(self: _types.Any) -> bytes:
        gaps = (
            _gaps(owner, lambda part, _: _count_of_message(self, part))
            if owner.INNER
            else []
        )
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
        message = object.__new__(type(self))
        for field in self.FIELDS:
            setattr(message, field.attribute, getattr(self, field.attribute))
        setattr(message, tail.part, values + padding[count:])
        frame: bytes = longest(message)
        frame = frame[: least + count * tail.step] + frame[end:]
        for place, lacking in reversed(gaps):
            frame = frame[:place] + frame[place + lacking :]
        return frame

    return to_bytes


def _count_of_message(self: _types.Any, part: _types.Any) -> int:
    """Return the number of elements of a part of a message.

    Raise `RangeError` if the counter is out of range.
    """
    counter: int = getattr(self, part.counter)
    low, high = max(0, -part.plus), part.most - part.plus
    if not low <= counter <= high:
        raise RangeError(part.counter, f"{low} to {high}", counter)
    count: int = counter + part.plus
    return count


def _gaps(
    message: _types.Any, count_of: _types.Callable[[_types.Any, _types.Any], int]
) -> list[tuple[int, int]]:
    """Return place and number of each run of bytes that is only in the longest frame.

    They are in the order of the frame. ``count_of`` returns the number of elements of a
    part, given its counter's pieces.
    """
    counts = [count_of(part, pieces) for part, _, pieces in message.INNER]
    nested = [
        (group, begin + count * part.step, (part.most - count) * part.step)
        for group, part, begin, pieces in message.NESTED
        for count in [count_of(part, pieces)]
    ]
    gaps = []
    for (part, begin, _), count in zip(message.INNER, counts):
        inner = [(place, size) for group, place, size in nested if group == part.part]
        for element in range(begin, begin + count * part.step, part.step):
            gaps += [(element + place, size) for place, size in inner]
        if part.part != message.TAIL.part:
            gaps.append((begin + count * part.step, (part.most - count) * part.step))
    return gaps


def _end(message: _types.Any) -> int:
    """Return the offset of the first byte behind the variable-length end in the longest
    frame.
    """
    end: int = message.LENGTH - (message.TAIL.behind if message.TAIL else 0)
    return end


def _completed(message: _types.Any, frame: bytes, data: _types.Buffer) -> bytes:
    """Return the longest frame, from its beginning as `spread` returns it, with missing
    bytes 0 and the fields that ``data`` has behind the variable-length end.
    """
    end, given = _end(message), memoryview(data).tobytes()
    behind = given[len(given) - (message.LENGTH - end) :]
    return frame.ljust(end, b"\0") + behind


def _shortest(message: _types.Any) -> int:
    """Return the length of the shortest frame."""
    length: int = message.LENGTH
    parts = {part.part: part for part, *_ in message.INNER}
    for part in (parts | {message.TAIL.part: message.TAIL}).values():
        step = part.step - sum(
            _most_missing(inner)
            for group, inner, *_ in message.NESTED
            if group == part.part
        )
        length -= part.most * part.step - max(0, part.plus) * step
    return length


def _most_missing(part: _types.Any) -> int:
    """Return the number of bytes of a part that are only in the longest frame."""
    size: int = (part.most - max(0, part.plus)) * part.step
    return size


def spread(message: _types.Any, data: _types.Buffer) -> tuple[bytes, int]:
    """Insert the missing elements in front of the variable-length end.

    Return the beginning of the longest frame, without fields behind this end, and the
    number of inserted minus removed bytes. Raise `LengthError` if the frame is too
    short, or if its counter is out of range.
    """
    frame, actual = memoryview(data).tobytes(), memoryview(data).nbytes
    behind = message.LENGTH - _end(message)
    if not message.INNER and not behind:
        return frame, 0
    if actual < (shortest := _shortest(message)):
        raise LengthError(message.NAME, shortest, actual)

    def count_of(part: _types.Any, pieces: _types.Any) -> int:
        count: int = part.plus
        for byte, shift, bits, at in pieces:
            count += (frame[byte] >> shift & (1 << bits) - 1) << at
        if not max(0, part.plus) <= count <= part.most:
            # The counter is invalid, so no length is correct. Report one that differs.
            longest = message.LENGTH
            expected = message.INNER[0][1] if actual == longest else longest
            raise LengthError(message.NAME, expected, actual)
        return count

    gaps = _gaps(message, count_of)
    for part, _, pieces in message.INNER:
        if part.part == message.TAIL.part:  # then counters give the whole length
            elements = (part.most - count_of(part, pieces)) * part.step
            expected = message.LENGTH - sum(size for _, size in gaps) - elements
            if actual != expected:
                raise LengthError(message.NAME, expected, actual)
    whole = frame[: actual - behind]
    for place, lacking in gaps:
        whole = whole[:place] + bytes(lacking) + whole[place:]
    return whole, len(whole) - actual


def count_in(message: _types.Any, frame: bytes, lacking: int) -> int:
    """Return the number of elements at the end of a frame.

    ``lacking`` is the number of bytes that `spread` added. Raise `LengthError`.
    """
    tail, actual, end = message.TAIL, len(frame), _end(message)
    begin: int = end - tail.most * tail.step
    step: int = tail.step
    count, part = divmod(actual - begin, step)
    least = begin + max(0, tail.plus) * step
    expected = max(least, min(actual - part, end))
    if expected != actual:
        raise LengthError(message.NAME, expected - lacking, actual - lacking)
    return count


def padded(message: _types.Any, data: _types.Buffer) -> bytes:
    """Return the longest frame: ``data`` with missing bytes 0."""
    return _completed(message, spread(message, data)[0], data)
