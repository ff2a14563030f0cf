"""Conversion of a model to JSON and back, for the cache.

Reading creates only objects of the classes of the model.

An object is ``{"is": class, attribute: value ...}`` without attributes that have their
default. An object that was written before is ``{"same": number}``. An array of JSON
becomes a tuple, because the model has lists only in values that are written as ``{"is":
"raw", ...}``.
"""

from __future__ import annotations

import json
from dataclasses import MISSING, Field, fields, is_dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from icdgen.icd import layout, model
from icdgen.icd.curve import Curve, CurvePiece
from icdgen.icd.derived import Derivation, Operation
from icdgen.icd.formula import Scale
from icdgen.icd.units import Unit

_TUPLES = (Scale, Curve, CurvePiece, Derivation, Operation, Unit)
_SCALARS = frozenset((str, int, bool, float, type(None)))
_CLASSES: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (*_TUPLES, *vars(layout).values(), *vars(model).values())
    if isinstance(kind, type) and (is_dataclass(kind) or kind in _TUPLES)
}


def json_of_model(icd: model.Icd, inputs: dict[Path, str]) -> bytes:
    """Return the JSON of a model and of its input files with their fingerprints."""
    tree = [
        _ModelWriter().plain(icd),
        [[str(path), fingerprint] for path, fingerprint in inputs.items()],
    ]
    return json.dumps(tree, separators=(",", ":"), check_circular=False).encode()


def model_of_json(data: bytes) -> tuple[model.Icd, dict[Path, str]] | None:
    """Return the model and the fingerprints that `json_of_model` wrote; None if the data was not
    written by `json_of_model`.
    """
    try:
        icd, inputs = json.loads(data, object_hook=_ModelReader().object)
        fingerprints = {Path(path): str(fingerprint) for path, fingerprint in inputs}
    except (ValueError, TypeError, LookupError, ArithmeticError, RecursionError):
        return None
    return (icd, fingerprints) if isinstance(icd, model.Icd) else None


class _ModelWriter:
    """Converts objects of a model to values that `json` can write."""

    def __init__(self) -> None:
        # id() of an object -> its number, in the order of writing
        self.numbers: dict[int, int] = {}

    def plain(self, value: Any) -> Any:
        """Return a value of the model as a value for JSON."""
        kind: Any = type(value)
        if kind in _SCALARS:
            return value
        if kind is tuple:
            return [
                item if type(item) in _SCALARS else self.plain(item) for item in value
            ]
        if kind is Fraction:
            return {"is": "/", "parts": [value.numerator, value.denominator]}
        if kind.__name__ not in _CLASSES:
            return {"is": "raw", "json": json.dumps(value)}
        if id(value) in self.numbers:
            return {"same": self.numbers[id(value)]}
        written = {"is": kind.__name__}
        for name, default in _defaults(kind):
            item = getattr(value, name)
            # Compare types too: True == 1, but they differ in JSON.
            if item is not default and (
                item != default or type(item) is not type(default)
            ):
                written[name] = item if type(item) in _SCALARS else self.plain(item)
        # After its parts: the reader creates objects from the inside out, and counts in
        # that order.
        self.numbers[id(value)] = len(self.numbers)
        return written


@cache
def _defaults(kind: Any) -> list[tuple[str, Any]]:
    """Return the attributes of a class with their defaults, without `source`, which
    does not take part in comparisons.
    """
    if issubclass(kind, tuple):
        return [
            (name, kind._field_defaults.get(name, MISSING)) for name in kind._fields
        ]
    return [(field.name, _default(field)) for field in fields(kind) if field.compare]


def _default(field: Field[Any]) -> Any:
    """Return the default of an attribute, `MISSING` without one."""
    if field.default_factory is MISSING:
        return field.default
    return field.default_factory()


class _ModelReader:
    """Converts JSON objects to objects of the model, as a hook of `json.loads`."""

    def __init__(self) -> None:
        self.objects: list[Any] = []  # by number, in the order of writing

    def object(self, attributes: dict[str, Any]) -> Any:
        """Return the object of the model that a JSON object stands for."""
        if "same" in attributes:
            return self.objects[attributes["same"]]
        name = attributes.pop("is")
        if name == "/":
            return Fraction(*attributes["parts"])
        if name == "raw":
            value = json.loads(attributes["json"])
            # `_tuples` compares the exact type, so it leaves this list alone.
            return _List(value) if type(value) is list else value
        for key, value in attributes.items():
            if type(value) is list:
                attributes[key] = _tuples(value)
        kind = _CLASSES[name]
        self.objects.append(kind(**attributes))
        return self.objects[-1]


class _List(list[Any]):
    """List of a raw value, which `_tuples` does not convert."""


def _tuples(value: list[Any]) -> tuple[Any, ...]:
    """Return nested lists as nested tuples."""
    return tuple([_tuples(item) if type(item) is list else item for item in value])
