"""What the Python harness does with an input; needs no atheris. See README.md."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

DIRECTION, FIT, AS_ID = 1, 2, 4
LONGEST = 65535  # bytes of a frame; a field that counts may tell of more
# physical values of wider fields need not lead back to the same raw value
EXACT_BITS = 52


class Dispatch:
    """Tries inputs on the dispatchers of a generated package."""

    def __init__(self, package: ModuleType) -> None:
        self.package = package
        self.nodes = [getattr(package, name) for name in package.NODES]

    def one(self, data: bytes) -> None:
        """Decodes, encodes, and compares.

        Raises what the package should not have raised.
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
    """Encoding gives the frame, but for reserved bits; so does setting every physical
    value.
    """
    first = message.to_bytes()
    assert len(first) == (len(frame) if message.TAIL else message.LENGTH)
    again = type(message).from_bytes(first)
    for part in _parts(again):
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
                assert value != value  # what a table refuses reads as no number
            if (
                getattr(part, info.attribute) != raw
            ):  # raw values that have the same double
                assert getattr(part, info.physical) == value
                setattr(part, info.attribute, raw)
    assert again.to_bytes() == first
    repr(message)
    message.as_dict(physical=True)


def _parts(whole) -> Iterator:
    """A message and the structs in it."""
    yield whole
    for info in whole.FIELDS:
        if info.struct is not None:
            found = getattr(whole, info.attribute)
            for one in found if isinstance(found, tuple) else (found,):
                yield from _parts(one)
