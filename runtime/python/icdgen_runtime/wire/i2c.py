"""I2C: bytes that the master writes and reads.

A telecommand is one write. Telemetry is a write of its id, then a read.
"""

from __future__ import annotations

from typing import NamedTuple

from .._errors import LengthError, UnknownIdError
from .checks import checksum
from .errors import ChecksumError, need
from .link import Link


class I2cTransfer(NamedTuple):
    """One transaction: bytes to write, then number of bytes to read."""

    write: bytes
    read: int


def i2c_write(link: Link, id: int, data: bytes = b"", crc: bool = False) -> bytes:
    """Return the bytes of a telecommand, or of a request, which has no data.

    The UART uses these bytes, too. Raise `UnsupportedError`.
    """
    message = bytes((id,)) + data
    if crc:
        message += _checksum(link, id, data)
    return message


def i2c_read_length(link: Link, id: int, crc: bool = False) -> int:
    """Return the number of bytes to read for a frame.

    Raise `UnknownIdError` and `UnsupportedError`.
    """
    length = _length(link, id)
    return length + (need(link.checksum, "checksums of messages").bytes if crc else 0)


def i2c_reply(link: Link, id: int, data: bytes, crc: bool = False) -> bytes:
    """Return the frame in the bytes read.

    Raise `UnknownIdError`, `LengthError`, `ChecksumError` and `UnsupportedError`.
    """
    length, expected = _length(link, id), i2c_read_length(link, id, crc)
    if len(data) != expected:
        raise LengthError("the reply", expected, len(data))
    frame = data[:length]
    if crc and data[length:] != _checksum(link, id, frame):
        numbers = (_checksum(link, id, frame), data[length:])
        raise ChecksumError(*(int.from_bytes(number, link.order) for number in numbers))
    return frame


def _length(link: Link, id: int) -> int:
    if id not in link.frames:
        raise UnknownIdError(link.node, "telemetry", id)
    return link.frames[id]


def _checksum(link: Link, id: int, data: bytes) -> bytes:
    form = need(link.checksum, "checksums of messages")
    covered = bytes((id,)) + data if form.covers_id else data
    return checksum(link, form.name, covered).to_bytes(form.bytes, link.order)
