"""Attributes of messages that `dataclasses` and `inspect` read, created at their first
use.
"""

from __future__ import annotations

import dataclasses
import sys
from inspect import Parameter, Signature
from typing import Any

from ._types import FieldInfo

# Python 3.9 has no keyword-only dataclass fields.
_KEYWORDS: dict[str, Any] = {"kw_only": True} if sys.version_info >= (3, 10) else {}

PARAMS: Any = vars(dataclasses.make_dataclass("Message", [], **_KEYWORDS))[
    "__dataclass_params__"
]


def dataclass_fields(message: Any) -> dict[str, Any]:
    """Return the dataclass fields of a message class, which stores them."""
    owner = next(base for base in message.__mro__ if "FIELDS" in vars(base))
    notes = vars(owner).get("__annotations__", {})
    fields = [
        (info.attribute, notes[info.attribute], _field(info)) for info in owner.FIELDS
    ]
    template = dataclasses.make_dataclass(owner.__name__, fields, **_KEYWORDS)
    owner.__dataclass_fields__ = result = vars(template)["__dataclass_fields__"]
    return result  # type: ignore[no-any-return]


def _field(info: FieldInfo) -> Any:
    if info.struct is not None:
        return dataclasses.field(default_factory=lambda: info.fresh)
    return dataclasses.field(default=info.default)


def signature(message: Any, shared: Any) -> Signature:
    """Return the signature of a message class.

    ``shared`` is the constructor of `Struct`, which takes the fields as keywords.
    """
    if message.__init__ is not shared:
        own = Signature.from_callable(message.__init__)
        return own.replace(parameters=list(own.parameters.values())[1:])
    notes = message.__annotations__
    parameters = []
    for info in message.FIELDS:
        note = notes.get(info.attribute, Parameter.empty)
        kind = Parameter.KEYWORD_ONLY
        parameters.append(
            Parameter(info.attribute, kind, default=info.fresh, annotation=note)
        )
        if info.physical:
            type_name = "str" if info.type == "text" else "float"
            type_name = f"tuple[{type_name}, ...]" if info.elements else type_name
            default = getattr(message(), info.physical)
            parameters.append(
                Parameter(info.physical, kind, default=default, annotation=type_name)
            )
    return Signature(parameters)
