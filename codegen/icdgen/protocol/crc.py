"""CRCs, bit by bit."""

from __future__ import annotations

from icdgen.protocol.sections import Crc


class Register:
    """A CRC that is fed piece by piece."""

    def __init__(self, crc: Crc) -> None:
        self.crc = crc
        self.value = crc.init
        self.fed = False

    def feed(self, data: bytes) -> Register:
        crc, top = self.crc, 1 << (self.crc.width - 1)
        for byte in data:
            self.fed = True
            for position in range(8):
                bit = byte >> (position if crc.reflect_in else 7 - position) & 1
                out = bool(self.value & top) != bool(bit)
                self.value = (self.value << 1 & (top << 1) - 1) ^ (crc.polynomial if out else 0)
        return self

    def result(self) -> int:
        """The CRC of everything fed so far."""
        if not self.fed and self.crc.empty is not None:
            return self.crc.empty
        value = self.value
        if self.crc.reflect_out:
            value = int(f"{value:0{self.crc.width}b}"[::-1], 2)
        return value ^ self.crc.xor_out


def compute(crc: Crc, data: bytes) -> int:
    """The CRC of the bytes."""
    return Register(crc).feed(data).result()
