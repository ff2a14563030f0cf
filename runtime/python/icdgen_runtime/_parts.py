"""Parts of a composite message: messages whose fields it repeats at other positions."""

from __future__ import annotations

from importlib import import_module

from . import _types
from ._errors import IcdError
from ._types import FieldInfo, MessageFacts


def part(kind: type[_types.M], message: MessageFacts, index: int) -> _types.M:
    """Return the part with this class and index.

    Raise `IcdError` if it does not exist.
    """
    key = kind.NODE, kind.__name__
    begins = [begin for *owner, begin in message.PARTS if tuple(owner) == key]
    if not begins:
        raise IcdError(f"{type(message).__name__} does not repeat {kind.__name__}")
    if not 0 <= index < len(begins):
        raise IcdError(
            f"{type(message).__name__} repeats {kind.__name__} {len(begins)} times, "
            f"and has none with the index {index}"
        )
    return _read(kind, _values(message), begins[index])


def parts(message: MessageFacts) -> _types.Iterator[_types.Any]:
    """Iterate over all parts, in the order of the frame."""
    values = _values(message)
    for node, name, begin in message.PARTS:
        kind: type[MessageFacts] = getattr(import_module(f"{__package__}.{node}"), name)
        yield _read(kind, values, begin)


def _values(message: MessageFacts) -> dict[int, _types.Any]:
    """Return the values by their first bit, each element of an array separately."""
    values: dict[int, _types.Any] = {}
    for info in message.FIELDS:
        _collect(info, getattr(message, info.attribute), values)
    return values


def _collect(info: FieldInfo, value: _types.Any, values: dict[int, _types.Any]) -> None:
    for part, raw in zip(info.parts, value if info.elements else (value,)):
        if part.struct is None:
            values[part.at] = raw
            continue
        for inner in part.struct.FIELDS:
            _collect(inner.within(part), getattr(raw, inner.attribute), values)


def _read(kind: type[_types.M], values: dict[int, _types.Any], begin: int) -> _types.M:
    """Return the message whose values begin ``begin`` bits after their own offsets."""
    return kind(**{info.attribute: _value(info, values, begin) for info in kind.FIELDS})


def _value(info: FieldInfo, values: dict[int, _types.Any], begin: int) -> _types.Any:
    elements: list[_types.Any] = []
    for part in info.parts:
        if part.struct is None:
            elements.append(values[begin + part.at])
            continue
        members = {
            inner.attribute: _value(inner.within(part), values, begin)
            for inner in part.struct.FIELDS
        }
        elements.append(part.struct(**members))
    return tuple(elements) if info.elements else elements[0]
