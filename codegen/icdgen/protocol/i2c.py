"""I2C transactions: bytes that the master writes and reads."""

from __future__ import annotations

from icdgen.icd.model import Message
from icdgen.protocol import crc
from icdgen.protocol.errors import ChecksumError, LengthError
from icdgen.protocol.facts import Facts, need


def checksum(facts: Facts, id: int, data: bytes) -> int:
    """Return the checksum of the data of a message."""
    form = need(facts.checksum, "crc8")
    return crc.compute(form.crc, bytes([id]) + data if form.covers_id else data)


def telecommand(facts: Facts, id: int, data: bytes, with_crc: bool) -> bytes:
    """Return id, parameters and, if ``with_crc``, the checksum.

    UART and I2C share this format.
    """
    form = need(facts.checksum, "crc8") if with_crc else None
    extra = facts.bytes_of(checksum(facts, id, data), form.bytes) if form else b""
    return bytes([id]) + data + extra


def read_length(facts: Facts, message: Message, with_crc: bool) -> int:
    """Return the number of bytes to read for a frame."""
    return message.length + (need(facts.checksum, "crc8").bytes if with_crc else 0)


def reply(facts: Facts, id: int, data: bytes, with_crc: bool) -> bytes:
    """Return the frame in the bytes read.

    Raises `LengthError` and `ChecksumError`.
    """
    message = facts.telemetry[id]
    if len(data) != read_length(facts, message, with_crc):
        raise LengthError(read_length(facts, message, with_crc), len(data))
    frame, extra = data[: message.length], data[message.length :]
    if with_crc and facts.number(extra) != checksum(facts, id, frame):
        raise ChecksumError(checksum(facts, id, frame), facts.number(extra))
    return frame
