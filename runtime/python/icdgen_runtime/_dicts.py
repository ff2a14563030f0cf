"""Conversion of messages from and to dictionaries and JSON.

JSON has raw values by the names of attributes; bytes are hexadecimal digits.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ._errors import IcdError, RangeError
from ._types import FieldInfo, S, StructFacts

OCTETS = ("bytes", "text")  # types whose raw values are bytes


def filled(struct: type[S], values: Mapping[str, Any]) -> S:
    """Return a struct or message with these values and defaults.

    See `Struct.from_dict`.
    """
    result, remaining = struct(), dict(values)
    for info in struct.FIELDS:
        if info.when:  # the value of a field that is not present is ignored
            setattr(result, info.attribute, info.default)
    for info in struct.FIELDS:
        if info.attribute in remaining:
            setattr(result, info.attribute, _raw(info, remaining.pop(info.attribute)))
        if info.physical in remaining:
            setattr(result, info.physical, remaining.pop(info.physical))
    for info in struct.VIEWS:  # computed from the fields
        remaining.pop(info.attribute, None)
        remaining.pop(info.physical, None)
    for name in remaining:
        raise IcdError(f"{struct.NAME} has no field {name!r}")
    return result


def to_json(values: Mapping[str, Any]) -> str:
    """Implement `Struct.to_json`."""
    return json.dumps(values, default=bytes.hex)


def values_of_json(data: str) -> dict[str, Any]:
    """Return the values by name. Raise `IcdError` if ``data`` is not a JSON object."""
    try:
        values = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise IcdError(f"this is no JSON: {error}") from None
    if not isinstance(values, dict):
        raise IcdError("this is JSON, and no object of values by name")
    return values


def _raw(info: FieldInfo, value: Any) -> Any:
    """Return a raw value of the type of the attribute.

    Bytes may be given as hexadecimal digits, structs as dictionaries.
    """
    if info.struct is not None:
        return _structs(info, info.struct, value)
    if info.elements and isinstance(value, (list, tuple)):
        return tuple(_member(info, element) for element in value)
    return _member(info, value)


def _member(info: FieldInfo, value: Any) -> Any:
    """Return the member of an enumeration if the value is one, or the bytes of digits."""
    if info.type in OCTETS and isinstance(value, str):
        try:
            return bytes.fromhex(value)
        except ValueError:
            allowed = f"{info.bits // 8} bytes in hexadecimal digits"
            raise RangeError(info.attribute, allowed, value) from None
    if info.enum is None or type(value) is not int:
        return value
    try:
        return info.enum(value)
    except ValueError:
        return value


def _structs(info: FieldInfo, struct: type[StructFacts], value: Any) -> Any:
    if not info.elements:
        return filled(struct, value) if isinstance(value, Mapping) else value
    if isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__iter__"):
        raise RangeError(info.attribute, f"{info.elements} values", value)
    return tuple(
        filled(struct, element) if isinstance(element, Mapping) else element
        for element in value
    )
