"""Run statements of generated C that read and write bytes, without a compiler.

`read` and `write` run them in Python. Operands have the types of C after the integer
promotions, and an operation that C leaves undefined or to the compiler raises
`UndefinedError`: a shift into the sign bit, a shift of a negative value, or a cast to a
signed type that cannot represent the value.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

INT = 32  # bits of an `int`

_LITERAL = re.compile(
    r"UINT64_C\((0x[0-9A-F]+)\)|\b(0x[0-9A-F]+)(u?)(?!\w)|(?<!\[)\b(\d+)(u?)(?![\w\]])"
)
_MEMBER = re.compile(r"message->(\w+)")
_COPY = re.compile(r"\(void\)mem(?:cpy|set)\((.*), (.*), (\d+)u\);")
_STORE = re.compile(r"icdgen_store_u(\d+)(le|be)\(&buffer\[(\d+)\], (.*)\);")
_SET_FLOAT = re.compile(r"icdgen_set_f(\d+)\(\s*&message->(\w+),\s*(.*)\);", re.DOTALL)
_ASSIGNMENT = re.compile(r"(?:uint\d+_t )?([\w>\[\]-]+) (\|?)= (.*);", re.DOTALL)


class UndefinedError(Exception):
    """Operation without a defined result."""


class Operand(int):
    """Integer of C: its value, the bits of its type, and whether that is signed."""

    bits: int
    signed: bool

    def __new__(cls, value: int, bits: int, signed: bool) -> Operand:
        if bits < INT:  # the integer promotions (C99 6.3.1.1)
            bits, signed = INT, True
        operand = super().__new__(cls, value)
        operand.bits, operand.signed = bits, signed
        return operand

    def _common(self, other: Operand) -> tuple[int, int, int, bool]:
        """Return both operands in their common type (C99 6.3.1.8)."""
        bits = max(self.bits, other.bits)
        signed = all(each.signed or each.bits < bits for each in (self, other))
        if signed:
            return int(self), int(other), bits, True
        mask = (1 << bits) - 1
        return int(self) & mask, int(other) & mask, bits, False

    def _result(self, other: Operand, operation: Callable[[int, int], int]) -> Operand:
        left, right, bits, signed = self._common(other)
        return Operand(operation(left, right), bits, signed)

    def __and__(self, other: Operand) -> Operand:
        return self._result(other, int.__and__)

    def __or__(self, other: Operand) -> Operand:
        return self._result(other, int.__or__)

    def __add__(self, other: Operand) -> Operand:
        left, right, bits, signed = self._common(other)
        if signed:
            raise UndefinedError("signed sum")
        return Operand(left + right & (1 << bits) - 1, bits, False)

    def __ne__(self, other: object) -> bool:
        assert isinstance(other, Operand)
        left, right, *_ = self._common(other)
        return left != right

    __hash__ = int.__hash__

    def __lshift__(self, count: int) -> Operand:
        value = int(self) << int(count)
        if self < 0 or int(count) >= self.bits:
            raise UndefinedError(f"{int(self)} << {int(count)}")
        if self.signed and value >> self.bits - 1:
            raise UndefinedError(f"{int(self)} << {int(count)} in an int")
        return Operand(value & (1 << self.bits) - 1, self.bits, self.signed)

    def __rshift__(self, count: int) -> Operand:
        if self < 0 or int(count) >= self.bits:
            raise UndefinedError(f"{int(self)} >> {int(count)}")
        return Operand(int(self) >> int(count), self.bits, self.signed)


class _Bytes(bytearray):
    """Buffer whose items are operands, and whose slices are pointers."""

    def __getitem__(self, index: Any) -> Any:
        item = super().__getitem__(index)
        return item if isinstance(index, slice) else Operand(item, 8, False)


def _unsigned(bits: int) -> Callable[[int], Operand]:
    return lambda value: Operand(int(value) & (1 << bits) - 1, bits, False)


def _signed(bits: int) -> Callable[[int], Operand]:
    def cast(value: int) -> Operand:
        if not -(1 << bits - 1) <= int(value) < 1 << bits - 1:
            raise UndefinedError(f"{int(value)} as int{bits}_t")
        return Operand(int(value), bits, True)

    return cast


def _reinterpreted(bits: int) -> Callable[[int], Operand]:
    return lambda value: Operand(
        int.from_bytes(int(value).to_bytes(bits // 8, "big"), "big", signed=True),
        bits,
        True,
    )


def _extended(bits: int) -> Callable[[int, int], Operand]:
    return lambda value, sign: Operand((value ^ int(sign)) - int(sign), bits, True)


def _load(bits: int, order: str) -> Callable[[bytes], Operand]:
    return lambda at: Operand(
        int.from_bytes(at[: bits // 8], "little" if order == "le" else "big"),
        bits,
        False,
    )


_FUNCTIONS: dict[str, object] = {
    "unsigned": lambda value: Operand(value, INT, False),
    "unsigned64": lambda value: Operand(value, 64, False),
    "signed": lambda value: Operand(value, INT, True),
    **{f"ICDGEN_U{bits}": _unsigned(bits) for bits in (8, 16, 32, 64)},
    **{f"ICDGEN_I{bits}": _signed(bits) for bits in (8, 16, 32, 64)},
    **{f"icdgen_i{bits}": _reinterpreted(bits) for bits in (8, 16, 32, 64)},
    **{f"icdgen_extend{bits}": _extended(bits) for bits in (32, 64)},
    **{
        f"icdgen_load_u{bits}{order}": _load(bits, order)
        for bits in (16, 32, 64)
        for order in ("le", "be")
    },
    # The members of floats have the bits as their value.
    **{f"icdgen_bits_f{bits}": lambda value: value for bits in (32, 64)},
}


def evaluate(expression: str, **names: object) -> Any:
    """Return the value of an expression of C."""

    def literal(match: re.Match[str]) -> str:
        wide, hexadecimal, hexadecimal_u, decimal, decimal_u = match.groups()
        if wide:
            return f"unsigned64({wide})"
        suffix = hexadecimal_u or decimal_u
        number = hexadecimal or decimal
        return f"{'unsigned' if suffix else 'signed'}({number})"

    text = re.sub(r"&buffer\[(\d+)\]", r"buffer[\1:]", " ".join(expression.split()))
    text = re.sub(r"&message->", "message->", text)
    text = _MEMBER.sub(r"message.\1", _LITERAL.sub(literal, text))
    return eval(text, {**_FUNCTIONS, **names})


class Members:
    """Members of a message as operands of their types."""

    def __init__(
        self, values: dict[str, int], types: dict[str, tuple[int, bool]]
    ) -> None:
        for name, value in values.items():
            setattr(self, name, Operand(value, *types[name]))


def read(statements: Iterable[str], frame: bytes) -> dict[str, int | bytes]:
    """Run the statements of a decode function; return the members that they assign."""
    buffer, message, local = _Bytes(frame), {}, {}
    for block in statements:
        for statement in re.split(r"(?<=;)\n    ", block):
            if copy := _COPY.fullmatch(statement):
                name = copy[1].removeprefix("message->")
                start = int(copy[2].removeprefix("&buffer[").rstrip("]"))
                message[name] = bytes(buffer[start : start + int(copy[3])])
                continue
            if assigned := _SET_FLOAT.fullmatch(statement):
                target, joined, value = f"message->{assigned[2]}", "", assigned[3]
            else:
                match = _ASSIGNMENT.fullmatch(statement)
                assert match, statement
                target, joined, value = match.groups()
            result = evaluate(value, buffer=buffer, **local)
            if target.startswith("message->"):
                message[target.removeprefix("message->")] = int(result)
            else:
                local[target] = local[target] | result if joined else result
    return message


def write(
    statements: Iterable[str],
    length: int,
    values: dict[str, Any],
    types: dict[str, tuple[int, bool]],
) -> bytes:
    """Run the statements of an encode function for members with these values; return
    the frame.

    ``types``: bits of the type of each member that is no bytes, and whether it is
    signed. Fails unless each byte is written once, in order.
    """
    numbers = {name: value for name, value in values.items() if name in types}
    message, frame = Members(numbers, types), b""
    for statement in statements:
        if copy := _COPY.fullmatch(statement):
            start, count = (
                int(copy[1].removeprefix("&buffer[").rstrip("]")),
                int(copy[3]),
            )
            source = copy[2].removeprefix("message->")
            data = bytes(count) if source == "0" else values[source]
            assert len(data) == count, statement
        elif store := _STORE.fullmatch(statement):
            bits, order, start = int(store[1]), store[2], int(store[3])
            value = int(evaluate(store[4], message=message))
            data = value.to_bytes(bits // 8, "little" if order == "le" else "big")
        else:
            match = _ASSIGNMENT.fullmatch(statement)
            assert match, statement
            start = int(match[1].removeprefix("buffer[").rstrip("]"))
            data = bytes([evaluate(match[3], message=message)])
        assert start == len(frame), statement
        frame += data
    assert len(frame) == length
    return frame
