"""Position of a field in the frame, from the numbers of bytes and bits in a row.

Manuals count bytes from 0 or 1, state ranges or lengths, or only the size. `fields` has
the other facts of a field.
"""

from __future__ import annotations

from collections.abc import Callable

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.rules import positions
from icdgen.importer.rules.bit_order import Bit, Order, bits_of_register
from icdgen.importer.rules.rule import TableRule


class PlaceReader:
    """Places of the fields of one table; ``order`` is the node's, ``error`` reports a
    place that is not clear.
    """

    def __init__(
        self,
        rule: TableRule,
        order: Order,
        error: Callable[[str, str, SourcePlace, str], None],
    ) -> None:
        self.rule, self.order, self.error = rule, order, error

    @property
    def _orders(self) -> str:
        """Orders of the node, as a profile states them."""
        return f"byte_order: {self.order.byte_order}, bit_order: {self.order.bit_order}"

    def place(
        self, numbers: dict[str, int], byte_shift: int, size: int
    ) -> tuple[int, int] | None:
        """Number of the first bit and size of the range, 0 if only its beginning is
        given; None without a position.
        """
        if "byte" not in numbers and "bit" not in numbers:
            return None
        # `origin` is the byte of the table at which the message begins.
        origin = 8 * (self.rule.origin - byte_shift)
        if "end_bit" in numbers:
            first, last = self.ends(numbers)
            is_plain = self.counts_through(numbers)
            start, end = 8 * first[0] + first[1], 8 * last[0] + last[1]
            return (
                (start - origin, end - start + 1)
                if is_plain
                else (8 * first[0] - origin, size)
            )
        first_bit = numbers.get("bit", 0)
        range_size = 0
        if "last_bit" in numbers:
            first_bit, last_bit = sorted((first_bit, numbers["last_bit"]))
            range_size = last_bit - first_bit + 1
        first_byte = numbers.get("byte", 0)
        if "last_byte" in numbers:
            first_byte, last_byte = sorted((first_byte, numbers["last_byte"]))
            range_size = (
                range_size if "bit" in numbers else 8 * (last_byte - first_byte + 1)
            )
        return 8 * first_byte - origin + first_bit, range_size

    def ends(self, numbers: dict[str, int]) -> list[Bit]:
        """Byte and bit number of both ends of a range such as ``0.4-1.3``, the first
        byte first.
        """
        byte = numbers["byte"]
        return sorted(
            [
                (byte, numbers["bit"]),
                (numbers.get("last_byte", byte), numbers["end_bit"]),
            ]
        )

    def counts_through(self, numbers: dict[str, int]) -> bool:
        """Return whether bit numbers ascend from the first to the last byte of a range."""
        is_in_one_byte = numbers.get("last_byte", numbers["byte"]) == numbers["byte"]
        return (
            is_in_one_byte
            or self.order in positions.MONOTONIC
            or self.rule.what != "message"
        )

    def is_range_clear(
        self, numbers: dict[str, int], size: int, where: str, spot: SourcePlace
    ) -> bool:
        """Check a range from a bit of one byte to a bit of another; report one that can
        be read in two ways.
        """
        lacking = [role for role in ("byte", "bit") if role not in numbers]
        outside = [role for role in ("bit", "end_bit") if numbers.get(role, 0) > 7]
        problem = ""
        if lacking:
            problem, help = (
                f"`end_bit` without `{lacking[0]}`",
                "give both ends of the range: `{byte}.{bit}-{last_byte}.{end_bit}`",
            )
        elif outside:
            problem = f"a byte has no bit {numbers[outside[0]]}"
            help = "`end_bit` and `bit` count from 0 to 7 within their bytes"
        elif "last_bit" in numbers:
            problem, help = (
                "`end_bit` and `last_bit` exclude each other",
                "remove one of the roles",
            )
        if problem:
            self.error("IMP105", f"{where}: {problem}", spot, help)
            return False
        if self.counts_through(numbers):
            return True
        first, last = self.ends(numbers)
        if positions.bits_between(first, last, size, self.order) is not None:
            return True
        self.error(
            "IMP105",
            f"{where}: the place from bit {first[1]} of byte {first[0]} to bit {last[1]} of byte {last[0]} is not clear"
            f"{f' with a size of {size}' if size else ''}",
            spot,
            f"with `{self._orders}`, such a range can be read in two ways: give a column of sizes the role `bits`, "
            "or a type with a width, and compare both with the table",
        )
        return False

    def frame_bits(
        self, numbers: dict[str, int], at: int, size: int, where: str, spot: SourcePlace
    ) -> list[Bit] | None:
        """Return the bits of a place whose bit numbers do not ascend through the frame.

        Return an empty list if they do. Return None, with a finding, if bytes and bit
        numbers contradict each other. Bit 15 of two big-endian bytes is the most
        significant bit of the first byte.
        """
        if "end_bit" in numbers:
            first, last = self.ends(numbers)
            if self.counts_through(numbers):
                return []
            shift = first[0] - at // 8  # origin of the message within the table
            bits = positions.bits_between(first, last, size, self.order) or []
            return [(byte - shift, weight) for byte, weight in bits]
        if self.rule.what != "message" or "byte" not in numbers or "bit" not in numbers:
            return []
        printed = numbers["byte"], numbers.get("last_byte", numbers["byte"])
        count = max(printed) - min(printed) + 1
        # Bit 0 of the bytes.
        start = at - min(numbers["bit"], numbers.get("last_bit", numbers["bit"]))
        highest = max(numbers["bit"], numbers.get("last_bit", 0))
        is_ambiguous = self.order not in positions.MONOTONIC
        help = ""
        if "last_byte" in numbers and max(highest + 1, at + size - start) > 8 * count:
            help = f"bits are numbered from 0 to {8 * count - 1} in these bytes; give the position by bytes or bits only"
        elif (
            count > 1
            and "last_bit" in numbers
            and highest < 8
            and not self.rule.has_byte_range
        ):
            help = "a bit in the last byte has the role `end_bit`; bits that are numbered in all bytes need `{byte}-{last_byte}`"
        elif "last_byte" not in numbers and highest > 7 and is_ambiguous:
            help = f"with `{self._orders}`, state all bytes in which the bits are numbered: the roles `byte` and `last_byte`"
        elif count > 1 and self.order == Order("little", "msb0"):
            help = f"with `{self._orders}`, bit numbers in several bytes have no order: state that of the source under `node:`"
        if help:
            bytes_ = (
                f"byte {printed[0]}"
                if count == 1
                else f"bytes {printed[0]} to {printed[1]}"
            )
            self.error(
                "IMP105",
                f"{where}: the place of bit {highest} in {bytes_} is not clear",
                spot,
                help,
            )
            return None
        if count == 1 or not is_ambiguous:
            return []
        window = bits_of_register(at - start, size, count, self.order.byte_order)
        return [(start // 8 + byte, weight) for byte, weight in window]
