"""Protocol section: I2C addresses, check values of checksums, and rows of layouts.

Every key is optional. ICD090 compares the forms of an address, ICD091 compares check
values of checksums with computed ones, and ICD092 finds overlaps in lists of rows.
`sections` yields all mappings of the section, also for the rules in other modules, most
of which are named ``protocol_*``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from icdgen.icd import checksum
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node
from icdgen.icd.rules.context import PATH_OF_BUSES, Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.trees import at_path, mappings
from icdgen.wording import count, quote

# Input of the check value of a CRC, in the Rocksoft model and the catalogues that
# follow it.
CHECKED = b"123456789"
MAX_WIDTH = 64


def sections(node: Node) -> Iterator[Map]:
    """Yield the protocol section of a node and every mapping in it, at any depth."""
    yield from _mappings_in(node.source.get("protocol"))


def _mappings_in(tree: object) -> Iterator[Map]:
    queue: list[object] = [tree]
    while queue:
        item = queue.pop()
        if isinstance(item, Map):
            yield item
            queue += item.values()
        elif isinstance(item, Seq):
            queue += item


@rule("ICD090")
def i2c_address_forms_agree(ctx: Context) -> Iterator[Fault]:
    for i2c in ctx.sections(*PATH_OF_BUSES, "i2c"):
        for key, bit in (("write", 0), ("read", 1)):
            if isinstance(i2c.get(key), Map):
                yield from _forms_agree(i2c[key], key, bit)
        write, read = (at_path(i2c, (key, "address_8bit")) for key in ("write", "read"))
        if _is_byte(write) and _is_byte(read) and not write & 1 and read != write | 1:
            message = f"the read address {_hex(read)} does not follow the write address {_hex(write)}"
            correct = _hex(write | 1)
            yield Fault.at(
                i2c["read"],
                "address_8bit",
                message,
                f"the read address is {correct}",
                correct,
            )


def _forms_agree(address: Map, key: str, bit: int) -> Iterator[Fault]:
    """Yield the faults of an address whose 8-bit, 7-bit and binary forms differ;
    ``bit`` is its lowest bit.
    """
    eight, seven, binary = (
        address.get(form) for form in ("address_8bit", "address_7bit", "binary")
    )
    if not _is_byte(eight):
        return
    if eight & 1 != bit:
        message = f"{_hex(eight)} cannot be a {key} address"
        yield Fault.at(
            address,
            "address_8bit",
            message,
            f"correct it: the last bit of a {key} address is {bit}",
        )
    elif isinstance(seven, int) and seven << 1 | bit != eight:
        message = f"the 7-bit address {_hex(seven)} gives the {key} address {_hex(seven << 1 | bit)}, not {_hex(eight)}"
        right = _hex(eight >> 1)
        yield Fault.at(
            address,
            "address_7bit",
            message,
            f"{_hex(eight)} is {right} with 7 bits",
            right,
        )
    if isinstance(binary, str) and _binary(binary) != eight:
        value = _binary(binary)
        states = (
            f"states {_hex(value)}" if value is not None else "is not a binary number"
        )
        message = f"the binary form {quote(binary)} {states}, but the address is {_hex(eight)}"
        yield Fault.at(
            address,
            "binary",
            message,
            f"{_hex(eight)} is 0b{eight:08b}",
            f'"0b{eight:08b}"',
        )


def _is_byte(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and 0 <= value <= 255


def _binary(text: str) -> int | None:
    """Return the value of a binary number such as ``0b1010 0001``; None if the text is
    not one.
    """
    digits = text.removeprefix("0b").replace(" ", "")
    return int(digits, 2) if digits and not digits.strip("01") else None


def _hex(value: int) -> str:
    return f"0x{value:02X}"


@rule("ICD091")
def checksum_parameters_give_the_check_value(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for section in sections(node):
            stated, actual = section.get("check"), _check_value(section)
            if (
                type(stated) is int
                and actual not in (None, stated)
                and 0 <= stated < 1 << section["width"]
            ):
                message = f"these parameters give {_hex(actual)} over 123456789, not the check value {_hex(stated)}"
                yield Fault.at(
                    section, "check", message, "correct the parameters or `check`"
                )


def _check_value(section: Map) -> int | None:
    """Return the checksum of `CHECKED` with the parameters of a section; None if they
    are incomplete or out of range.
    """
    kind = section.get("kind", checksum.CRC)
    values = [
        section.get("width"),
        section.get("init", 0),
        section.get("xor_out", 0),
        section.get("polynomial"),
    ]
    numbers = [
        value
        for value in (values if kind == checksum.CRC else values[:3])
        if type(value) is int
    ]
    if kind not in checksum.KINDS or len(numbers) != (4 if kind == checksum.CRC else 3):
        return None
    width, init, xor_out, *polynomial = numbers
    if not 1 <= width <= MAX_WIDTH or not all(
        0 <= number < 1 << width for number in numbers[1:]
    ):
        return None
    if kind != checksum.CRC:
        return checksum.plain(kind, CHECKED, width, init, xor_out)
    reflect_in, reflect_out = (
        bool(section.get(key)) for key in ("reflect_in", "reflect_out")
    )
    return checksum.crc(
        CHECKED, width, polynomial[0], init, reflect_in, reflect_out, xor_out
    )


@rule("ICD092")
def rows_do_not_overlap(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for section in sections(node):
            for key, rows in section.items():
                if isinstance(rows, Seq):
                    yield from _rows(section, key, rows, "byte", "bytes")
                    yield from _rows(section, key, rows, "at", "bits")


def _name_of_row(row: Map, otherwise: str) -> str:
    """Return the name of a row for a message: its name, or else its role."""
    name = row.get("name", row.get("role"))
    return quote(name) if isinstance(name, str) else otherwise


def _rows(section: Map, key: str, rows: Seq, at: str, size: str) -> Iterator[Fault]:
    """Yield the faults of rows that overlap or end outside of the section.

    ``at`` and ``size`` are their keys.
    """
    named = f"{key}_{size}" if f"{key}_{size}" in section else size
    room = section.get(named)
    placed = [
        row
        for row in mappings(rows)
        if isinstance(row.get(at), int) and isinstance(row.get(size), int)
    ]
    last: Map | None = None  # the row that ends last, of those before
    for row in sorted(placed, key=lambda row: row[at]):
        end = row[at] + row[size]
        name = _name_of_row(row, "this row")
        if last is not None and row[at] < last[at] + last[size]:
            other = f"{_name_of_row(last, 'another row')} ({line_of(last.place, row.place)})"
            message = f"{name} overlaps {other} in {size[:-1]} {row[at]}"
            yield Fault.at(row, at, message, f"correct `{at}` or `{size}`")
        if isinstance(room, int) and end > room:
            message = (
                f"{name} ends behind {size[:-1]} {end - 1}, but the whole has {count(room, size[:-1])} "
                f"(`{named}: {room}`, {line_of(section.at(named), row.place)})"
            )
            sizes = f"`{size}` or `{named}`" if named != size else f"or a `{size}`"
            yield Fault.at(row, size, message, f"correct `{at}`, {sizes}")
        # A long row can end after the rows that follow it.
        if last is None or end > last[at] + last[size]:
            last = row
