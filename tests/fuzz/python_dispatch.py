"""Decodes and encodes inputs with the dispatchers of a generated package.

It does not need atheris. See README.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

DIRECTION, FIT, AS_ID = 1, 2, 4
LONGEST = 65535  # bytes of a frame; a counter may state more
# Physical values of wider fields need not have the same raw value again.
EXACT_BITS = 52


class Dispatch:
    """Runs inputs on the dispatchers of a generated package."""

    def __init__(self, package: ModuleType) -> None:
        self.package = package
        self.nodes = [getattr(package, name) for name in package.NODES]

    def run(self, data: bytes) -> None:
        """Decode, encode, and compare.

        Raises every exception that the package should not have raised.
        """
        if len(data) < 3:
            return
        node, flags, number, frame = (
            self.nodes[data[0] % len(self.nodes)],
            data[1],
            data[2],
            data[3:],
        )
        messages = node.TELEMETRY if flags & DIRECTION else node.TELECOMMANDS
        decode = node.decode_telemetry if flags & DIRECTION else node.decode_telecommand
        ids = sorted(messages)
        id = number if flags & AS_ID or not ids else ids[number % len(ids)]
        try:
            message = decode(id, frame)
        except self.package.LengthError as error:
            assert error.actual == len(frame) != error.expected
            if not flags & FIT or error.expected > LONGEST:
                return
            frame = (frame or b"\0") * (error.expected // (len(frame) or 1) + 1)
            frame = frame[: error.expected]
            try:
                message = decode(id, frame)
            except self.package.IcdError:
                return
        except self.package.UnknownIdError:
            assert id not in messages or len(messages.of(id)) > 1
            return
        check(message, frame, self.package)
        assert type(decode(id, message.to_bytes())) is type(message)


def check(message, frame: bytes, package: ModuleType) -> None:
    """Check that encoding returns the frame, except for reserved bits, also after every
    physical value has been set.
    """
    encoded = message.to_bytes()
    assert len(encoded) == (len(frame) if message.TAIL else message.LENGTH)
    copy = type(message).from_bytes(encoded)
    for part in _parts(copy):
        for info in part.FIELDS:
            if not info.physical:
                continue
            value = getattr(part, info.physical)
            if (
                info.type in ("float", "text")
                or info.bits > EXACT_BITS
                or not info.leads_back
                or value is None
            ):
                continue
            raw = getattr(part, info.attribute)
            try:
                setattr(part, info.physical, value)
            except package.RangeError:
                assert value != value  # NaN: the raw value is outside its lookup table
            if getattr(part, info.attribute) != raw:
                # Two raw values can have the same double.
                assert getattr(part, info.physical) == value
                setattr(part, info.attribute, raw)
    assert copy.to_bytes() == encoded
    repr(message)
    message.as_dict(physical=True)


def _parts(message) -> Iterator:
    """Yield a message and the structs in it."""
    yield message
    for info in message.FIELDS:
        if info.struct is not None:
            value = getattr(message, info.attribute)
            for element in value if isinstance(value, tuple) else (value,):
                yield from _parts(element)
