"""Statements of decoders and encoders. The first line stands without its indentation, which the template gives."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.backends.python.black import WIDTH, assignment, bracketed, exploded

BODY, INNER = 8, 12  # indentation of a method's statements, and of those in its `try`


def table(name: str, kind: str, *arguments: str) -> str:
    """The definition of a table at module level."""
    items = [_tuple(one) for one in arguments]
    return bracketed(0, f"{name} = _codec.{kind}(", items, ")")


def _tuple(item: str) -> str:
    if len(item) + 5 <= WIDTH or not item.startswith("("):
        return item
    return exploded(4, "(", item[1:-1].split(", "), ")").lstrip()


def call(target: str, function: str, *arguments: str) -> str:
    """``target = function(arguments)`` in the `try` of an encoder."""
    return bracketed(INNER, f"{target} = {function}(", arguments, ")").lstrip()


def to_bytes(target: str, value: str, call: str) -> str:
    """``target = value.to_bytes(...)`` in the `try` of an encoder."""
    line = f"{target} = {value}.{call}"
    if len(line) + INNER <= WIDTH:
        return line
    local = f"{target}_value"
    return f"{assignment(INNER, local, value).lstrip()}\n{' ' * INNER}{target} = {local}.{call}"


def moved(name: str, right: int, bits: int, left: int) -> str:
    """``bits`` bits (0: all) of a variable from its bit ``right`` up, ``left`` bits higher."""
    term = f"{name} >> {right}" if right else name
    if bits:
        term = f"({term})" if right else term
        term = f"{term} & 0x{(1 << bits) - 1:02X}"
    if left:
        term = f"({term})" if " " in term else term
        term = f"{term} << {left}"
    return term


def unpacked(indent: int, targets: Sequence[str], value: str) -> str:
    """The assignment of a tuple to its targets."""
    if len(targets) == 1:
        line = f"({targets[0]},) = {value}"
        return line if len(line) + indent <= WIDTH else f"(value,) = {value}\n{assignment(indent, targets[0], 'value')}"
    line = f"{', '.join(targets)} = {value}"
    if len(line) + indent <= WIDTH:
        return line
    return exploded(indent, "(", targets, f") = {value}").lstrip()


def total(indent: int, values: Sequence[str]) -> str:
    """The sum of floats, which is NaN if one of them is. (`sum` of a tuple takes longer.)"""
    if len(values) == 1:
        return assignment(indent, "total", values[0]).lstrip()
    line = f"total = {' + '.join(values)}"
    if len(line) + indent <= WIDTH:
        return line
    pad = " " * indent
    return f"total = (\n{pad}    " + f"\n{pad}    + ".join(values) + f"\n{pad})"
