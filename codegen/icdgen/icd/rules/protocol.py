"""Protocol facts that can be checked against each other. Every key is optional."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, quote
from icdgen.icd.trees import at_path, mappings

CHECKED = b"123456789"  # what the check value of a CRC is computed over, by convention
MAX_WIDTH = 64


def sections(node: Node) -> Iterator[Map]:
    """The protocol section and every mapping in it."""
    queue: list[object] = [node.source.get("protocol")]
    while queue:
        item = queue.pop()
        if isinstance(item, Map):
            yield item
            queue += item.values()
        elif isinstance(item, Seq):
            queue += item


@rule("ICD090")
def i2c_addresses(ctx: Context) -> Iterator[Fault]:
    for i2c in ctx.sections("i2c"):
        for key, bit in (("write", 0), ("read", 1)):
            if isinstance(i2c.get(key), Map):
                yield from _forms_agree(i2c[key], key, bit)
        one, other = (at_path(i2c, (key, "address_8bit")) for key in ("write", "read"))
        if _is_byte(one) and _is_byte(other) and not one & 1 and other != one | 1:
            message = f"the read address {_hex(other)} does not follow the write address {_hex(one)}"
            yield Fault.at(i2c["read"], "address_8bit", message, f"the read address is {_hex(one | 1)}")


def _forms_agree(address: Map, key: str, bit: int) -> Iterator[Fault]:
    eight, seven, binary = (address.get(k) for k in ("address_8bit", "address_7bit", "binary"))
    if not _is_byte(eight):
        return
    if eight & 1 != bit:
        message = f"{_hex(eight)} is no {key} address"
        yield Fault.at(address, "address_8bit", message, f"its last bit is {bit}")
    elif isinstance(seven, int) and seven << 1 | bit != eight:
        message = f"the 7-bit address {_hex(seven)} gives the {key} address {_hex(seven << 1 | bit)}, not {_hex(eight)}"
        yield Fault.at(address, "address_7bit", message, f"{_hex(eight)} is {_hex(eight >> 1)} with 7 bits")
    if isinstance(binary, str) and _binary(binary) != eight:
        message = f"the binary form {quote(binary)} is {_hex(_binary(binary))}, not {_hex(eight)}"
        yield Fault.at(address, "binary", message, f"{_hex(eight)} is 0b{eight:08b}")


def _is_byte(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and 0 <= value <= 255


def _binary(text: str) -> int | None:
    digits = text.removeprefix("0b").replace(" ", "")
    return int(digits, 2) if digits and not digits.strip("01") else None


def _hex(value: int | None) -> str:
    return "no number" if value is None else f"0x{value:02X}"


@rule("ICD091")
def crc_checks(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for section in sections(node):
            values = [section.get(k) for k in ("width", "polynomial", "check")]
            numbers = [v for v in (*values, section.get("init", 0), section.get("xor_out", 0)) if isinstance(v, int)]
            if len(numbers) != 5:
                continue
            width, polynomial, wanted, init, xor_out = numbers
            if not 1 <= width <= MAX_WIDTH:
                continue
            if not all(0 <= one < 1 << width for one in (polynomial, wanted, init, xor_out)):
                continue
            reflect_in, reflect_out = (bool(section.get(k)) for k in ("reflect_in", "reflect_out"))
            got = crc(CHECKED, width, polynomial, init, reflect_in, reflect_out, xor_out)
            if got != wanted:
                message = f"these parameters give {_hex(got)} over 123456789, not the check value {_hex(wanted)}"
                yield Fault.at(section, "check", message, "correct the parameters or `check`")


def crc(data: bytes, width: int, polynomial: int, init: int, reflect_in: bool, reflect_out: bool, xor_out: int) -> int:
    """The CRC of ``data``, bit by bit, in the parameters of the usual catalogues."""
    mask = (1 << width) - 1
    register = init
    for byte in data:
        for position in range(8):
            bit = byte >> (position if reflect_in else 7 - position) & 1
            feedback = register >> (width - 1) ^ bit
            register = register << 1 & mask
            if feedback:
                register ^= polynomial
    if reflect_out:
        register = int(f"{register:0{width}b}"[::-1], 2)
    return register ^ xor_out


@rule("ICD092")
def rows_apart(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for section in sections(node):
            for key, rows in section.items():
                if isinstance(rows, Seq):
                    yield from _rows(section, key, rows, "byte", "bytes")
                    yield from _rows(section, key, rows, "at", "bits")


def _called(row: Map, otherwise: str) -> str:
    """What a row is known by: its name, or else its role."""
    known = row.get("name", row.get("role"))
    return quote(known) if isinstance(known, str) else otherwise


def _rows(section: Map, key: str, rows: Seq, at: str, size: str) -> Iterator[Fault]:
    named = f"{key}_{size}" if f"{key}_{size}" in section else size
    room = section.get(named)
    placed = [r for r in mappings(rows) if isinstance(r.get(at), int) and isinstance(r.get(size), int)]
    last: Map | None = None
    for row in sorted(placed, key=lambda r: r[at]):
        end = row[at] + row[size]
        name = _called(row, "this row")
        if last is not None and row[at] < last[at] + last[size]:
            other = f"{_called(last, 'another row')} ({line_of(last.place, row.place)})"
            message = f"{name} overlaps {other} in {size[:-1]} {row[at]}"
            yield Fault.at(row, at, message, f"correct `{at}` or `{size}`")
        if isinstance(room, int) and end > room:
            message = f"{name} ends at {end}, but `{named}` is {room}"
            sizes = f"`{size}` or `{named}`" if named != size else f"or a `{size}`"
            yield Fault.at(row, size, message, f"correct `{at}`, {sizes}")
        if last is None or end > last[at] + last[size]:
            last = row
