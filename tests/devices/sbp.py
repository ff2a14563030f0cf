"""Messages of the Swift Binary Protocol as the sbp package defines them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tests.devices.definition import (
    Definition,
    Definitions,
    NotSupported,
    node,
    variable_length_field,
    variable_length_structs,
)

LONGEST = 255  # bytes of a payload

LETTERS = {"B": ("uint", 8), "H": ("uint", 16), "L": ("uint", 32), "Q": ("uint", 64), "b": ("int", 8), "h": ("int", 16),
           "l": ("int", 32), "q": ("int", 64), "f": ("float", 32), "d": ("float", 64)}  # fmt: skip


def tables() -> Iterator[Definitions]:
    """Yield the table of all message classes."""
    from sbp.table import _SBP_TABLE

    messages = [_definition(id, message) for id, message in sorted(_SBP_TABLE.items())]
    yield Definitions(node("sbp", "Swift Binary Protocol", id_bits=16), messages)


def _definition(id: int, message: Any) -> Definition:
    parser = getattr(message, "_parser", None)
    fields: list[dict] = []
    structs: list[dict] = []
    try:
        end = (
            _fields(parser.subcons, fields, 0, "", structs, message.__name__)
            if parser is not None
            else 0
        )
    except NotSupported as error:
        return Definition(message.__name__, id, "telemetry", 0, [], cause=str(error))
    read = lambda data: _read(parser, data, fields[-1]) if fields else {}  # noqa: E731
    return Definition(
        message.__name__, id, "telemetry", end // 8, fields, raw=read, structs=structs
    )


def _fields(
    parts: list[Any],
    fields: list[dict],
    at: int,
    before: str,
    structs: list[dict],
    owner: str,
) -> int:
    """Append the fields of ``parts``, and the struct of a variable-length array.

    Return the bit at which they end. Raises `NotSupported`.
    """
    for part in parts:
        name, inner = before + part.name, part.subcon
        kind = type(inner).__name__
        if kind == "Struct":
            at = _fields(inner.subcons, fields, at, f"{name} ", structs, owner)
        elif kind == "FormatField":
            type_, bits = LETTERS[inner.fmtstr[-1]]
            fields.append({"at": at, "bits": bits, "name": name, "type": type_})
            at += bits
        elif kind == "Bytes":
            fields.append(
                {"at": at, "bits": 8 * inner.length, "name": name, "type": "bytes"}
            )
            at += 8 * inner.length
        elif kind == "Array" and type(inner.subcon).__name__ == "FormatField":
            type_, bits = LETTERS[inner.subcon.fmtstr[-1]]
            fields.append(
                {
                    "at": at,
                    "bits": bits,
                    "name": name,
                    "type": type_,
                    "count": inner.count,
                }
            )
            at += bits * inner.count
        elif kind == "Array":
            for number in range(inner.count):
                at = _fields(
                    inner.subcon.subcons,
                    fields,
                    at,
                    f"{name} {number + 1} ",
                    structs,
                    owner,
                )
        elif kind.startswith("Greedy"):
            if part is not parts[-1] or before:
                raise NotSupported("more behind what goes up to the end")
            fields.append(_end(name, kind, inner, at, structs, owner))
        else:
            raise NotSupported(kind)
    return at


def _end(
    name: str, kind: str, inner: Any, at: int, structs: list[dict], owner: str
) -> dict:
    """Return the variable-length field that goes up to the end of a frame.

    Raises `NotSupported`.
    """
    available = LONGEST - at // 8
    if kind == "GreedyBytes":
        return variable_length_field(name, at, 8, "bytes", "rest", available)
    if type(inner.subcon).__name__ == "FormatField":
        type_, bits = LETTERS[inner.subcon.fmtstr[-1]]
        return variable_length_field(
            name, at, bits, type_, "rest", available * 8 // bits
        )
    parts: list[dict] = []
    bits = _fields(inner.subcon.subcons, parts, 0, "", [], owner)
    end, struct = variable_length_structs(
        owner, name, at, parts, bits, "rest", available * 8 // bits
    )
    structs.append(struct)
    return end


def _read(parser: Any, data: bytes, end: dict) -> dict[str, object]:
    values: dict[str, object] = {}
    _flat(parser.parse(data), "", values, end)
    return values


def _flat(values: Any, before: str, flat: dict[str, object], end: dict) -> None:
    """Add values to ``flat``, with the names of nested parts that `_fields` gives
    them.
    """
    for name, value in values.items():
        path = before + name
        if name == "_io":
            continue
        if hasattr(value, "items"):
            _flat(value, f"{path} ", flat, end)
        elif isinstance(value, list) and value and hasattr(value[0], "items"):
            for number, item in enumerate(value):
                _flat(
                    item,
                    (
                        f"{path}[{number}]."
                        if path == end["name"]
                        else f"{path} {number + 1} "
                    ),
                    flat,
                    end,
                )
        else:
            flat[path] = list(value) if isinstance(value, list) else value
