"""I2C: the bytes that the master writes and reads, and polling for an acknowledge."""

from __future__ import annotations

from icdgen.icd.model import Message
from icdgen.protocol import crc
from icdgen.protocol.facts import Facts, need


class ChecksumError(ValueError):
    """The checksum of a reply is wrong."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"the checksum is {actual:#04x}, of the data it is {expected:#04x}")
        self.expected, self.actual = expected, actual


class WrongLength(ValueError):
    """A message does not have the length that it must have."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"{expected} bytes are expected, {actual} given")
        self.expected, self.actual = expected, actual


def checksum(facts: Facts, id: int, data: bytes) -> int:
    """The checksum of a message's data."""
    form = need(facts.checksum, "crc8")
    return crc.compute(form.crc, bytes([id]) + data if form.covers_id else data)


def telecommand(facts: Facts, id: int, data: bytes, checked: bool) -> bytes:
    """Id, parameters and, if asked for, the checksum: the same on the UART and on I2C."""
    form = need(facts.checksum, "crc8") if checked else None
    extra = facts.bytes_of(checksum(facts, id, data), form.bytes) if form else b""
    return bytes([id]) + data + extra


def read_length(facts: Facts, message: Message, checked: bool) -> int:
    """Bytes to read for a frame."""
    return message.length + (need(facts.checksum, "crc8").bytes if checked else 0)


def reply(facts: Facts, id: int, data: bytes, checked: bool) -> bytes:
    """The frame in what was read. Raises `WrongLength` and `ChecksumError`."""
    message = facts.telemetry[id]
    if len(data) != read_length(facts, message, checked):
        raise WrongLength(read_length(facts, message, checked), len(data))
    frame, extra = data[: message.length], data[message.length :]
    if checked and facts.number(extra) != checksum(facts, id, frame):
        raise ChecksumError(checksum(facts, id, frame), facts.number(extra))
    return frame
