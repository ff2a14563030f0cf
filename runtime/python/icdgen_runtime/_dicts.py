"""Messages from and to dictionaries and JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ._base import Message
from ._errors import IcdError, RangeError
from ._fields import FieldInfo
from ._hints import M

OCTETS = ("bytes", "text")  # types whose raw values are bytes


def from_dict(message: type[M], values: Mapping[str, Any]) -> M:
    """See `Message.from_dict`."""
    made, left = message(), dict(values)
    for info in message.FIELDS:
        setattr(
            made, info.attribute, info.default
        )  # what is not there is not looked at
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
    return message.from_bytes(made.to_bytes())


def to_json(message: Message, physical: bool) -> str:
    """See `Message.to_json`."""
    return json.dumps(message.as_dict(physical), default=bytes.hex)


def from_json(message: type[M], data: str) -> M:
    """See `Message.from_json`."""
    try:
        values = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise IcdError(f"this is no JSON: {error}") from None
    if not isinstance(values, dict):
        raise IcdError("this is JSON, and no object of values by name")
    return from_dict(message, values)


def _raw(info: FieldInfo, value: Any) -> Any:
    """A raw value as the attribute holds it: bytes may be given as digits."""
    if info.type in OCTETS and isinstance(value, str):
        try:
            return bytes.fromhex(value)
        except ValueError:
            allowed = f"{info.bits // 8} bytes in hexadecimal digits"
            raise RangeError(info.attribute, allowed, value) from None
    return value
