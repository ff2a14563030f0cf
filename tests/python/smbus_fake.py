"""Test double of smbus2: the part that a session uses, and a node on the bus."""

from __future__ import annotations

import errno
from typing import Any


class i2c_msg:
    """A part of a transaction."""

    def __init__(self, address: int, is_read: bool, data: bytes) -> None:
        self.address, self.is_read, self.data = address, is_read, data

    @staticmethod
    def write(address: int, data: bytes) -> i2c_msg:
        return i2c_msg(address, False, bytes(data))

    @staticmethod
    def read(address: int, length: int) -> i2c_msg:
        return i2c_msg(address, True, bytes(length))

    def __bytes__(self) -> bytes:
        return self.data


class SMBus:
    """A bus with one node.

    The first transactions raise ``errors``, one each. ``parts`` counts the messages of
    each later transaction.
    """

    def __init__(self, acp: Any, errors: list[int]) -> None:
        self.acp, self.errors, self.last, self.telecommands = acp, errors, 0, []
        self.requested: int | None = None
        self.parts: list[int] = []

    def i2c_rdwr(self, *parts: i2c_msg) -> None:
        if self.errors:
            raise OSError(self.errors.pop(0), "remote I/O")
        self.parts.append(len(parts))
        if any(part.address != self.acp.LINK.i2c_address for part in parts):
            raise OSError(errno.ENXIO, "no such node")
        for part in parts:
            if part.is_read:
                part.data = self.frame(self.requested)[: len(part.data)]
            elif len(part.data) == 1 and part.data[0] in self.acp.LINK.TELEMETRY:
                self.requested = part.data[0]
            else:
                self.last = part.data[0]
                self.telecommands.append(part.data)

    def frame(self, id: int) -> bytes:
        """Telemetry frame that the node returns for an id."""
        kind = self.acp.LINK.TELEMETRY[id]
        if kind is self.acp.TelecommandAcknowledge:
            return kind(last_tc_id=self.last, processed_flag=True).to_bytes()
        return (
            kind(node_type=self.acp.NODE_TYPE).to_bytes()
            if kind is self.acp.Identification
            else kind().to_bytes()
        )
