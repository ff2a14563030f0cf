"""What the Python harness does with an input; needs no atheris. See README.md."""

from __future__ import annotations

from types import ModuleType

DIRECTION, FIT, HIGH_ID = 1, 2, 4


class Dispatch:
    """Tries inputs on the dispatchers of a generated package."""

    def __init__(self, package: ModuleType) -> None:
        self.package = package
        self.nodes = [getattr(package, name) for name in package.NODES]

    def one(self, data: bytes) -> None:
        """Decodes, encodes, and compares. Raises what the package should not have raised."""
        if len(data) < 3:
            return
        node, flags, id, frame = self.nodes[data[0] % len(self.nodes)], data[1], data[2], data[3:]
        messages = node.TELEMETRY if flags & DIRECTION else node.TELECOMMANDS
        decode = node.decode_telemetry if flags & DIRECTION else node.decode_telecommand
        if flags & HIGH_ID:
            id += 256
        if flags & FIT and id in messages:
            length = messages[id].LENGTH
            frame = ((frame or b"\0") * length)[:length]
        try:
            message = decode(id, frame)
        except self.package.UnknownIdError:
            assert id not in messages
            return
        except self.package.LengthError as error:
            assert error.actual == len(frame) != error.expected
            return
        check(message, frame)


def check(message, frame: bytes) -> None:
    """Encoding gives the frame, but for reserved bits; so does setting every physical value."""
    assert len(frame) == message.LENGTH
    first = message.to_bytes()
    again = type(message).from_bytes(first)
    for info in message.FIELDS:
        if info.physical and info.bits <= 52:
            setattr(again, info.physical, getattr(again, info.physical))
    assert again.to_bytes() == first
    repr(message)
    message.as_dict(physical=True)
