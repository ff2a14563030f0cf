"""A model as JSON and back, for keeping: values, and objects of the model's own classes, nothing else.

An object is ``{"is": class, attribute: value ...}`` without what it has by default; one that was written before is
``{"same": number}``. A sequence becomes a tuple, for the model has no lists outside of what stands as ``{"is": "raw", ...}``.
"""

from __future__ import annotations

import json
from dataclasses import MISSING, fields, is_dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from icdgen.icd import layout, model
from icdgen.icd.curve import Curve, Piece
from icdgen.icd.derived import Derivation, Operation
from icdgen.icd.formula import Scale
from icdgen.icd.units import Unit

_TUPLES = (Scale, Curve, Piece, Derivation, Operation, Unit)
_SCALARS = frozenset((str, int, bool, float, type(None)))
_CLASSES: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (*_TUPLES, *vars(layout).values(), *vars(model).values())
    if isinstance(kind, type) and (is_dataclass(kind) or kind in _TUPLES)
}


def text(icd: model.Icd, inputs: dict[Path, str]) -> bytes:
    """The model, and what it was read from with the fingerprint of each."""
    tree = [_Writer().plain(icd), [[str(path), seen] for path, seen in inputs.items()]]
    return json.dumps(tree, separators=(",", ":"), check_circular=False).encode()


def read(data: bytes) -> tuple[model.Icd, dict[Path, str]] | None:
    """What `text` was given; None if this is not of its making."""
    try:
        icd, inputs = json.loads(data, object_hook=_Reader().object)
        found = {Path(path): str(seen) for path, seen in inputs}
    except (ValueError, TypeError, LookupError, ArithmeticError, RecursionError):
        return None
    return (icd, found) if isinstance(icd, model.Icd) else None


class _Writer:
    def __init__(self) -> None:
        self.known: dict[int, int] = {}  # id of an object -> its number

    def plain(self, value: Any) -> Any:
        kind: Any = type(value)
        if kind in _SCALARS:
            return value
        if kind is tuple:
            return [item if type(item) in _SCALARS else self.plain(item) for item in value]
        if kind is Fraction:
            return {"is": "/", "parts": [value.numerator, value.denominator]}
        if kind.__name__ not in _CLASSES:
            return {"is": "raw", "json": json.dumps(value)}
        if id(value) in self.known:
            return {"same": self.known[id(value)]}
        made = {"is": kind.__name__}
        for name, default in _defaults(kind):  # what is as it is by default is left out
            item = getattr(value, name)
            if item is not default and (item != default or type(item) is not type(default)):
                made[name] = item if type(item) in _SCALARS else self.plain(item)
        self.known[id(value)] = len(self.known)
        return made


@cache
def _defaults(kind: Any) -> list[tuple[str, Any]]:
    """The names of a class's attributes, but for positions, and what each is by default."""
    if issubclass(kind, tuple):
        return [(name, kind._field_defaults.get(name, MISSING)) for name in kind._fields]
    return [
        (one.name, one.default if one.default_factory is MISSING else one.default_factory())
        for one in fields(kind)
        if one.compare
    ]


class _Reader:
    def __init__(self) -> None:
        self.known: list[Any] = []

    def object(self, made: dict[str, Any]) -> Any:
        if "same" in made:
            return self.known[made["same"]]
        name = made.pop("is")
        if name == "/":
            return Fraction(*made["parts"])
        if name == "raw":
            value = json.loads(made["json"])
            return _List(value) if type(value) is list else value
        for key, value in made.items():
            if type(value) is list:
                made[key] = _tuples(value)
        kind = _CLASSES[name]
        self.known.append(kind(**made))
        return self.known[-1]


class _List(list[Any]):
    """A list that stays one."""


def _tuples(value: list[Any]) -> tuple[Any, ...]:
    return tuple([_tuples(item) if type(item) is list else item for item in value])
