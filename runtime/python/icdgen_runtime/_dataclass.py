"""Attributes of messages that `dataclasses` and `inspect` read, created at their first use."""

from __future__ import annotations

import dataclasses
import sys
from inspect import Parameter, Signature
from typing import Any

from ._types import FieldInfo

_KEYWORDS: dict[str, Any] = {"kw_only": True} if sys.version_info >= (3, 10) else {}

PARAMS: Any = vars(dataclasses.make_dataclass("Message", [], **_KEYWORDS))[
    "__dataclass_params__"
]


def dataclass_fields(message: Any) -> dict[str, Any]:
    """Return the dataclass fields of a message class, which stores them."""
    owner = next(one for one in message.__mro__ if "FIELDS" in vars(one))
    notes = vars(owner).get("__annotations__", {})
    fields = [
        (one.attribute, notes[one.attribute], _field(one)) for one in owner.FIELDS
    ]
    made = dataclasses.make_dataclass(owner.__name__, fields, **_KEYWORDS)
    owner.__dataclass_fields__ = found = vars(made)["__dataclass_fields__"]
    return found  # type: ignore[no-any-return]


def _field(one: FieldInfo) -> Any:
    if one.struct is not None:
        return dataclasses.field(default_factory=lambda: one.fresh)
    return dataclasses.field(default=one.default)


def signature(message: Any, shared: Any) -> Signature:
    """Return the signature of a message class.

    ``shared`` is the constructor of `Struct`, which takes the fields as keywords.
    """
    if message.__init__ is not shared:
        own = Signature.from_callable(message.__init__)
        return own.replace(parameters=list(own.parameters.values())[1:])
    notes = message.__annotations__
    found = []
    for one in message.FIELDS:
        note = notes.get(one.attribute, Parameter.empty)
        kind = Parameter.KEYWORD_ONLY
        found.append(Parameter(one.attribute, kind, default=one.fresh, annotation=note))
        if one.physical:
            type_name = "str" if one.type == "text" else "float"
            type_name = f"tuple[{type_name}, ...]" if one.elements else type_name
            fresh = getattr(message(), one.physical)
            found.append(
                Parameter(one.physical, kind, default=fresh, annotation=type_name)
            )
    return Signature(found)
