"""CRC checksums, also of data in several pieces.

``Crc(form).feed(data).result()`` returns the CRC. The form has the width, polynomial,
initial value, bit orders and final XOR of the ICD. `checks` uses it for packets.
"""

from __future__ import annotations

from binascii import crc_hqx
from functools import cache

from .._hints import Buffer
from .packet_formats import CrcForm


class Crc:
    """A CRC of data in several pieces. Without ``table``, it is computed bit by bit."""

    def __init__(self, form: CrcForm, table: bool = True) -> None:
        self._form = form
        self._is_fed = False
        self._register = (
            _reversed(form.init, form.width)
            if form.reflect_in
            else form.init << _padding(form)
        )
        self._rows = _table(form) if table else None
        # `crc_hqx` has this polynomial and bit order, and takes any initial value.
        self._is_known = table and form[:4] == (16, 0x1021, form.init, False)

    def feed(self, data: Buffer) -> Crc:
        """Add bytes. Return the object itself."""
        data = memoryview(data).cast("B")
        self._is_fed = self._is_fed or bool(data)
        if self._is_known:  # implemented in C by the standard library
            self._register = crc_hqx(data, self._register)
        elif self._rows is None:
            for byte in data:
                self._register = _step(self._form, self._register, byte)
        elif self._form.reflect_in:
            rows, register = self._rows, self._register
            for byte in data:
                register = register >> 8 ^ rows[(register ^ byte) & 0xFF]
            self._register = register
        else:
            rows, register = self._rows, self._register
            width = self._form.width + _padding(self._form)
            shift, mask = width - 8, (1 << width) - 1
            for byte in data:
                register = register << 8 & mask ^ rows[register >> shift ^ byte]
            self._register = register
        return self

    def result(self) -> int:
        """Return the CRC of all bytes so far."""
        form, value = self._form, self._register >> _padding(self._form)
        if not self._is_fed and form.empty is not None:
            return form.empty
        if form.reflect_in != form.reflect_out:
            value = _reversed(value, form.width)
        return value ^ form.xor_out


@cache
def _table(form: CrcForm) -> tuple[int, ...]:
    return tuple(_step(form, 0, byte) for byte in range(256))


def _step(form: CrcForm, register: int, byte: int) -> int:
    """Return the register after one more byte, computed bit by bit."""
    if form.reflect_in:
        polynomial = _reversed(form.polynomial, form.width)
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (polynomial if register & 1 else 0)
        return register
    width, polynomial = form.width + _padding(form), form.polynomial << _padding(form)
    top, mask = 1 << (width - 1), (1 << width) - 1
    register ^= byte << (width - 8)
    for _ in range(8):
        carry = polynomial if register & top else 0
        register = (register << 1 & mask) ^ carry
    return register


def _padding(form: CrcForm) -> int:
    """Return the number of zeros below the lowest bit of the register.

    They widen a register of less than 8 bits, as bytes enter at its top.
    """
    return 0 if form.reflect_in else max(8 - form.width, 0)


def _reversed(value: int, width: int) -> int:
    return int(f"{value:0{width}b}"[::-1], 2)
