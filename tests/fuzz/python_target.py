"""atheris harness on the dispatchers of the generated package, which must be on the path. See README.md.

``python python_target.py PACKAGE [libFuzzer options] [corpus]``
"""

from __future__ import annotations

import pkgutil
import sys
from importlib import import_module

import atheris

DIRECTION, FIT, HIGH_ID = 1, 2, 4
PACKAGE = sys.argv.pop(1)

with atheris.instrument_imports(include=[PACKAGE]):
    package = import_module(PACKAGE)
    for _info in pkgutil.walk_packages(package.__path__, f"{PACKAGE}."):
        if not _info.name.endswith(("_columns", "testee")):
            import_module(_info.name)
    nodes = [getattr(package, name) for name in package.NODES]
    for _node in nodes:
        for _message in (*_node.TELECOMMANDS.items(), *_node.TELEMETRY.items()):
            _message[1]()


def one(data: bytes) -> None:
    """Decodes, encodes, and compares."""
    if len(data) < 3:
        return
    node, flags, id, frame = nodes[data[0] % len(nodes)], data[1], data[2], data[3:]
    messages = node.TELEMETRY if flags & DIRECTION else node.TELECOMMANDS
    decode = node.decode_telemetry if flags & DIRECTION else node.decode_telecommand
    if flags & HIGH_ID:
        id += 256
    if flags & FIT and id in messages:
        length = messages[id].LENGTH
        frame = ((frame or b"\0") * length)[:length]
    try:
        message = decode(id, frame)
    except package.UnknownIdError:
        assert id not in messages
        return
    except package.LengthError as error:
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


if __name__ == "__main__":
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
