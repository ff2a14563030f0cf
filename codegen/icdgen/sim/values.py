"""Values in the frames of a simulated program.

Each frame starts with values that the ICD allows (`allowed_values`); scripts and the
user set others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import ceil, floor

from icdgen import codec
from icdgen.icd.curve import Curve
from icdgen.icd.frames import FrameField, PathStep
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.responses import field_of
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.responding import place_of
from icdgen.values.frame import violations_of_value


def number_places(icd: Icd, message: Message) -> list[NumberPlace | None]:
    """Return the place of each field of the longest frame of a message; None if its
    bits are no number in at most 4 bytes.
    """
    node = icd.node(message.node)
    return [
        place_of(node, field_of(message, field.name))
        for field in icd.longest_frame(message)
    ]


class Values:
    """The frame of each message, by name.

    A composite frame is consistent with its parts.
    """

    def __init__(self, icd: Icd, node: Node) -> None:
        self.icd = icd
        self.messages = {m.name: m for m in icd.messages_of(node)}
        self.frames = {
            m.name: self.encode(m, allowed_values(icd, m))
            for m in self.messages.values()
            if m.telemetry_id is not None
        }

    def frame(self, message: Message) -> bytes:
        """Return the current frame."""
        data = bytearray(self.frames[message.name])
        # The frame of a part is the original: it may have been set after the composite
        # frame.
        for part, first, last in self._parts(message):
            data[first:last] = self.frame(part)
        return bytes(data)

    def put(self, message: Message, data: bytes) -> None:
        """Store a complete frame."""
        self.frames[message.name] = bytes(data)
        for part, first, last in self._parts(message):
            self.put(part, data[first:last])

    def raw(self, message: Message) -> dict[str, int | bytes]:
        """Return the raw values of the current frame."""
        return codec.decode(self.icd.node(message.node), message, self.frame(message))

    def update(
        self, message: Message, raw: Mapping[str, int | bytes]
    ) -> dict[str, int | bytes]:
        """Set fields.

        Return the values set, including counters. Raise `icdgen.codec.CodecError`.

        Variable-length bytes and text get the length of the new value. A
        variable-length array becomes long enough for all elements that are set.
        """
        current, new = self.raw(message), dict(raw)
        steps: list[PathStep] = []  # arrays and structs around the fields that are set
        for field in self.icd.longest_frame(message):
            if field.name in raw:
                steps += field.steps
        counters: dict[str, int] = {}
        for part in message.layout.counted_parts:
            octets = new.get(part.name)
            count = codec.size_from_counter(part, {**current, **raw})
            if isinstance(octets, bytes):
                new[part.name], count = octets.ljust(part.most, b"\0"), len(octets)
            elements = (step.element for step in steps if step.node is part.node)
            count = max(
                [count, *(element + 1 for element in elements if element is not None)]
            )
            # Several arrays can have one counter.
            counters[part.counter] = max(
                count - part.plus, counters.get(part.counter, 0)
            )
        new = {**counters, **new}
        self.put(message, self.encode(message, {**current, **new}))
        return new

    def encode(self, message: Message, raw: Mapping[str, int | bytes]) -> bytes:
        """Return the frame of these raw values. Raise `icdgen.codec.CodecError`."""
        return codec.encode(self.icd.node(message.node), message, raw)

    def _parts(self, message: Message) -> Iterable[tuple[Message, int, int]]:
        for part in message.contains:
            inner = self.messages.get(part.message)
            if inner and inner.name in self.frames and part.at % 8 == 0:
                yield inner, part.at // 8, part.at // 8 + inner.length


def allowed_values(icd: Icd, message: Message) -> dict[str, int | bytes]:
    """Return allowed values of all raw fields of the longest frame, 0 if that is
    allowed.

    Overlay fields read the bits of raw fields and have no values.
    """
    return {
        field.name: _allowed_value(message, field)
        for field in icd.longest_frame(message)
        if field.is_raw
    }


def _allowed_value(message: Message, field: FrameField) -> int | bytes:
    if field.is_bytes:
        return bytes(field.bits // 8)
    for raw in _candidates(field):
        if field.raw_min <= raw <= field.raw_max and not violations_of_value(
            field, raw
        ):
            return raw
    return codec.initial_value(message, field)


def _candidates(field: FrameField) -> Iterable[int]:
    """Return raw values that may be allowed: the constant, 0, enumeration members,
    limits.
    """
    if field.const is not None:
        yield field.const
    yield 0
    yield from (m.value for m in field.enum.members) if field.enum else ()
    limits = field.limits
    for bound in (limits.min, limits.max, limits.above, limits.below) if limits else ():
        if bound is None:
            continue
        if field.curve is not None:
            yield from _on_curve(field, bound)
            continue
        if field.type == "float":
            yield from (
                codec.float_bits(field, float(bound) + step) for step in (0, 1, -1)
            )
            continue
        raw: Fraction = field.scale.raw(bound) if field.scale else bound
        # The limit itself can be excluded, or lie between two raw values.
        yield from (floor(raw), ceil(raw), floor(raw) - 1, ceil(raw) + 1)


def _on_curve(field: FrameField, bound: Fraction) -> Iterable[int]:
    """Return raw values near a physical value."""
    for step in (0, 1, -1):
        try:
            yield codec.raw_from_physical(field, bound + step)
        except codec.CodecError:
            continue


def raw_of(field: FrameField, value: float) -> int:
    """Return the raw value nearest to a physical one, limited to the range of the
    field.
    """
    if field.curve is not None:
        return _raw_on_curve(field, field.curve, value)
    if field.type == "float":
        return codec.float_bits(field, value)
    exact = Fraction(value)
    raw = round(field.scale.raw(exact) if field.scale else exact)
    return min(max(raw, field.raw_min), field.raw_max)


def _raw_on_curve(field: FrameField, curve: Curve, value: float) -> int:
    """Return the raw value of a calibration, limited to its range; 0 without an
    inverse.
    """
    if not field.is_invertible:
        return 0
    if field.type == "float":
        return codec.float_bits(field, curve.inverse(value))
    ends = sorted(map(curve.double, field.settable_raws))
    return codec.raw_from_physical(field, min(max(value, ends[0]), ends[1]))
