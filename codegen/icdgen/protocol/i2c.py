"""I2C: the bytes that the master writes and reads, and polling for an acknowledge."""

from __future__ import annotations

from icdgen.icd.model import Message
from icdgen.protocol import crc
from icdgen.protocol.errors import ChecksumError, LengthError
from icdgen.protocol.facts import Facts, need


def checksum(facts: Facts, id: int, data: bytes) -> int:
    """The checksum of a message's data."""
    form = need(facts.checksum, "crc8")
    return crc.compute(form.crc, bytes([id]) + data if form.covers_id else data)


def telecommand(facts: Facts, id: int, data: bytes, with_crc: bool) -> bytes:
    """Id, parameters and, if asked for, the checksum: the same on the UART and on I2C."""
    form = need(facts.checksum, "crc8") if with_crc else None
    extra = facts.bytes_of(checksum(facts, id, data), form.bytes) if form else b""
    return bytes([id]) + data + extra


def read_length(facts: Facts, message: Message, with_crc: bool) -> int:
    """Bytes to read for a frame."""
    return message.length + (need(facts.checksum, "crc8").bytes if with_crc else 0)


def reply(facts: Facts, id: int, data: bytes, with_crc: bool) -> bytes:
    """The frame in what was read. Raises `LengthError` and `ChecksumError`."""
    message = facts.telemetry[id]
    if len(data) != read_length(facts, message, with_crc):
        raise LengthError(read_length(facts, message, with_crc), len(data))
    frame, extra = data[: message.length], data[message.length :]
    if with_crc and facts.number(extra) != checksum(facts, id, frame):
        raise ChecksumError(checksum(facts, id, frame), facts.number(extra))
    return frame
