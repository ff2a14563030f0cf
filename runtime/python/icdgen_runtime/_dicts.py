"""Messages from and to dictionaries and JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ._base import Message, Struct
from ._errors import IcdError, RangeError
from ._fields import FieldInfo
from ._hints import S

OCTETS = ("bytes", "text")  # types whose raw values are bytes


def from_dict(struct: type[S], values: Mapping[str, Any]) -> S:
    """See `Struct.from_dict`."""
    made = _filled(struct, values)
    if isinstance(made, Message):
        return type(made).from_bytes(made.to_bytes())
    return made


def _filled(message: type[S], values: Mapping[str, Any]) -> S:
    made, left = message(), dict(values)
    for info in message.FIELDS:
        if info.when:  # what is not there is not looked at
            setattr(made, info.attribute, info.default)
    for info in message.FIELDS:
        if info.attribute in left:
            setattr(made, info.attribute, _raw(info, left.pop(info.attribute)))
        if info.physical in left:
            setattr(made, info.physical, left.pop(info.physical))
    for info in message.VIEWS:  # they follow from the fields
        left.pop(info.attribute, None)
        left.pop(info.physical, None)
    for name in left:
        raise IcdError(f"{message.NAME} has no field {name!r}")
    return made


def to_json(message: Struct, physical: bool) -> str:
    """See `Struct.to_json`."""
    return json.dumps(message.as_dict(physical), default=bytes.hex)


def from_json(message: type[S], data: str) -> S:
    """See `Struct.from_json`."""
    try:
        values = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise IcdError(f"this is no JSON: {error}") from None
    if not isinstance(values, dict):
        raise IcdError("this is JSON, and no object of values by name")
    return from_dict(message, values)


def _raw(info: FieldInfo, value: Any) -> Any:
    """A raw value as the attribute holds it: bytes may be given as digits, structs as their values."""
    if info.struct is not None:
        return _structs(info, info.struct, value)
    if info.elements and isinstance(value, (list, tuple)):
        return tuple(_member(info, one) for one in value)
    return _member(info, value)


def _member(info: FieldInfo, value: Any) -> Any:
    """Of an enumeration the member, if the value is one of it; bytes of their digits."""
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


def _structs(info: FieldInfo, struct: type[Struct], value: Any) -> Any:
    if not info.elements:
        return _filled(struct, value) if isinstance(value, Mapping) else value
    if isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__iter__"):
        raise RangeError(info.attribute, f"{info.elements} values", value)
    return tuple(
        _filled(struct, one) if isinstance(one, Mapping) else one for one in value
    )
