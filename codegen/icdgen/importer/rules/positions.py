"""Positions as tables print them -> bits of the frame: lists of numbers, and ranges
from a bit of one byte to a bit of another.
"""

from __future__ import annotations

import re

from icdgen.importer.rules.bit_order import ORDERS, Bit, Order

SEPARATOR = r"\s*(?:,|;|&|\+|/|\band\b)\s*"
_ITEM = r"[0-9]+(?:\s*(?:-|–|to|\.\.)\s*[0-9]+)?"
_LIST = re.compile(rf"{_ITEM}(?:{SEPARATOR}{_ITEM})+", re.I)
_PARTING = re.compile(SEPARATOR, re.I)
# Bit numbers ascend from byte to byte: the least (or most) significant bit is always
# first.
MONOTONIC = ORDERS[:2]


def is_list(text: str) -> bool:
    """Return whether a text lists several numbers or ranges: ``0, 2``, ``3 and 5-7``."""
    return _LIST.fullmatch(text.strip()) is not None


def is_separator(text: str) -> bool:
    """Return whether the text between two numbers separates list items.

    A dash makes a range.
    """
    return _PARTING.fullmatch(text) is not None


def runs_of(text: str) -> list[tuple[int, int]]:
    """Return the first and last number of each run of consecutive numbers in a list,
    ascending.
    """
    numbers: set[int] = set()
    for item in _PARTING.split(text.strip()):
        ends = [int(number) for number in re.findall(r"[0-9]+", item)]
        numbers.update(range(min(ends), max(ends) + 1))
    runs: list[tuple[int, int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][1] + 1:
            runs[-1] = runs[-1][0], number
        else:
            runs.append((number, number))
    return runs


def bits_between(first: Bit, last: Bit, size: int, order: Order) -> list[Bit] | None:
    """Return the bits of a value of ``size`` bits from a numbered bit of one byte to a
    numbered bit of a later byte.

    For orders in which bit numbers do not ascend from byte to byte (`big` with `lsb0`,
    `little` with `msb0`), manuals print the range in two ways: by ascending numbers
    (``0.0-1.7`` is two whole bytes), or in the order of significance (``0.7-1.0`` is
    the same two bytes). The size decides between them. None if no reading, or both,
    have this size.
    """
    (low, first_number), (high, last_number) = first, last
    between = [(byte, number) for byte in range(low + 1, high) for number in range(8)]
    ascending = (
        [(low, n) for n in range(first_number, 8)]
        + between
        + [(high, n) for n in range(last_number + 1)]
    )
    by_weight = (
        [(low, n) for n in range(first_number + 1)]
        + between
        + [(high, n) for n in range(last_number, 8)]
    )
    # If both readings have the size, as for `0.3-1.3`, the text does not tell which
    # bits are meant.
    readings = [
        numbered for numbered in (ascending, by_weight) if len(numbered) == size
    ]
    if len(readings) != 1:
        return None
    bits = [
        (byte, number if order.bit_order == "lsb0" else 7 - number)
        for byte, number in readings[0]
    ]
    return sorted(
        bits,
        key=lambda bit: (bit[0] if order.byte_order == "little" else -bit[0], bit[1]),
    )
