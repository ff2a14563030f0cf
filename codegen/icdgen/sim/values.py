"""What the frames of a simulated program hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import ceil, floor

from icdgen import codec
from icdgen.icd.curve import Curve
from icdgen.icd.model import Field, Icd, Message, Node
from icdgen.values.frame import violations


class Values:
    """The frame of every message, by its name. A composite frame and the frames in it always agree."""

    def __init__(self, icd: Icd, node: Node) -> None:
        self.icd = icd
        self.messages = {m.name: m for m in icd.messages_of(node)}
        self.frames = {
            m.name: self.encode(m, allowed_values(m)) for m in self.messages.values() if m.telemetry_id is not None
        }

    def frame(self, message: Message) -> bytes:
        """The frame as it is now."""
        data = bytearray(self.frames[message.name])
        for part, first, last in self._parts(message):
            data[first:last] = self.frame(part)
        return bytes(data)

    def put(self, message: Message, data: bytes) -> None:
        """Takes a whole frame."""
        self.frames[message.name] = bytes(data)
        for part, first, last in self._parts(message):
            self.put(part, data[first:last])

    def raw(self, message: Message) -> dict[str, int | bytes]:
        return codec.decode(self.icd.node(message.node), message, self.frame(message))

    def update(self, message: Message, raw: Mapping[str, int | bytes]) -> dict[str, int | bytes]:
        """Sets some fields; what was set, with what counts elements of open parts. Raises `icdgen.codec.CodecError`.

        Of bytes and text at an open end there are as many as are set; an element is there once it is set.
        """
        before, given = self.raw(message), dict(raw)
        for part in message.open_parts:
            octets, count = given.get(part.name), codec.elements_of(part, {**before, **raw})
            if isinstance(octets, bytes):
                given[part.name], count = octets.ljust(part.most, b"\0"), len(octets)
            paths = (one.path[0] for one in message.fields if one.path and one.name in raw)
            count = max([count, *((one.index or 0) + 1 for one in paths if one.name == part.name)])
            given.setdefault(part.counter, count - part.plus)
        self.put(message, self.encode(message, {**before, **given}))
        return given

    def encode(self, message: Message, raw: Mapping[str, int | bytes]) -> bytes:
        return codec.encode(self.icd.node(message.node), message, raw)

    def _parts(self, message: Message) -> Iterable[tuple[Message, int, int]]:
        for part in message.contains:
            inner = self.messages.get(part.message)
            if inner and inner.name in self.frames and part.at % 8 == 0:
                yield inner, part.at // 8, part.at // 8 + inner.length


def allowed_values(message: Message) -> dict[str, int | bytes]:
    """Values that the ICD allows, 0 where it does; views read what comes of them."""
    return {field.name: _allowed_value(field) for field in message.owners}


def _allowed_value(field: Field) -> int | bytes:
    if field.is_bytes:
        return bytes(field.bits // 8)
    for raw in _candidates(field):
        if field.raw_min <= raw <= field.raw_max and not violations(field, raw):
            return raw
    return field.fresh


def _candidates(field: Field) -> Iterable[int]:
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
            yield from (codec.float_bits(field, float(bound) + step) for step in (0, 1, -1))
            continue
        raw: Fraction = field.scale.raw(bound) if field.scale else bound
        yield from (floor(raw), ceil(raw), floor(raw) - 1, ceil(raw) + 1)


def _on_curve(field: Field, bound: Fraction) -> Iterable[int]:
    """Raw values about that of a physical one."""
    for step in (0, 1, -1):
        try:
            yield codec.raw_from_physical(field, bound + step)
        except codec.CodecError:
            continue


def raw_of(field: Field, value: float) -> int:
    """The raw value nearest to a physical one, held within what the field can hold."""
    if field.curve is not None:
        return _held(field, field.curve, value)
    if field.type == "float":
        return codec.float_bits(field, value)
    exact = Fraction(value)
    raw = round(field.scale.raw(exact) if field.scale else exact)
    return min(max(raw, field.raw_min), field.raw_max)


def _held(field: Field, curve: Curve, value: float) -> int:
    """Of a curve; 0 where it does not lead back."""
    if not field.leads_back:
        return 0
    if field.type == "float":
        return codec.float_bits(field, curve.inverse(value))
    ends = sorted(map(curve.double, field.ends))
    return codec.raw_from_physical(field, min(max(value, ends[0]), ends[1]))
