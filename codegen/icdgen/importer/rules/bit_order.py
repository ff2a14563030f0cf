"""Bits of a frame in the four orders that an ICD knows, and the order in which given
bits are a run.

A bit of a frame is a pair: its byte, and its weight within the byte (0 is the least
significant bit). The bits of a value are listed from the least to the most significant
one.
"""

from __future__ import annotations

from icdgen.frozen import NamedTuple

Bit = tuple[int, int]


class Order(NamedTuple):
    """Byte order ("little" or "big") and bit order ("lsb0" or "msb0") as an ICD names
    them.
    """

    byte_order: str
    bit_order: str


# `positions.MONOTONIC` relies on the first two: their bit numbers ascend through a
# value of several bytes.
ORDERS = (
    Order("little", "lsb0"),
    Order("big", "msb0"),
    Order("big", "lsb0"),
    Order("little", "msb0"),
)


def bits_of(at: int, size: int, order: Order) -> list[Bit]:
    """Return the bits of a value whose first bit has the number ``at`` in the frame."""
    numbered = [
        (n // 8, n % 8 if order.bit_order == "lsb0" else 7 - n % 8)
        for n in range(at, at + size)
    ]
    return sorted(
        numbered,
        key=lambda bit: (bit[0] if order.byte_order == "little" else -bit[0], bit[1]),
    )


def bits_of_register(lowest: int, size: int, length: int, byte_order: str) -> list[Bit]:
    """Return the bits of a value that a register of ``length`` bytes counts from its
    least significant bit.
    """
    numbers = range(lowest, lowest + size)
    return [
        (n // 8 if byte_order == "little" else length - 1 - n // 8, n % 8)
        for n in numbers
    ]


def run_of(bits: list[Bit], preferred: Order) -> tuple[int, Order] | None:
    """Return the number of the first bit and the order in which the bits are one value;
    None if they are in no order.
    """
    for order in (preferred, *ORDERS):
        numbers = [
            8 * byte + (weight if order.bit_order == "lsb0" else 7 - weight)
            for byte, weight in bits
        ]
        at = min(numbers)
        # No gaps, and in the order of significance.
        if max(numbers) - at == len(bits) - 1 and bits_of(at, len(bits), order) == bits:
            return at, order
    return None
