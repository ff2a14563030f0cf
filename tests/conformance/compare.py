"""Compare an answer with the expected one."""

from __future__ import annotations

import json
import re
from typing import NamedTuple


class Maybe(NamedTuple):
    """A value that an answer may leave out, but must not have wrong."""

    value: object


class Not(NamedTuple):
    """Any value except this one."""

    value: object


def difference(expected: dict, line: bytes | None) -> str | None:
    """Return what is wrong with an answer, or ``None``. ``...`` in ``expected`` matches
    anything.
    """
    if line is None:
        return "no answer: the testee died or fell silent"
    try:
        answer = json.loads(line)
    except ValueError:
        return f"not JSON: {line[:200]!r}"
    if not isinstance(answer, dict):
        return f"not an object: {line[:200]!r}"
    if expected.get("ok") is False:
        answer.pop("detail", None)
        if expected.get("field") != answer.get("field") and _is_array_of(
            answer.get("field"), expected.get("field")
        ):
            # Not every language names the element, or the struct.
            expected = {
                **expected,
                "field": answer["field"],
            }
    return _difference(expected, answer, "")


def _is_array_of(name: object, element: object) -> bool:
    if isinstance(element, Maybe):
        element = element.value
    if not isinstance(element, str):
        return False
    array = re.sub(r"\[\d+\]\Z", "", element)
    return name in (array.rpartition(".")[2], re.sub(r"\[\d+\]\.", "[].", array))


def _difference(expected: object, actual: object, path: str) -> str | None:
    if expected is ...:
        return None
    if isinstance(expected, Not):
        return (
            f"{path}: {_short(actual)}, which it cannot be"
            if actual == expected.value
            else None
        )
    if type(expected) is not type(actual):
        return f"{path or 'answer'}: {_short(actual)}, expected {_short(expected)}"
    if not isinstance(expected, dict):
        return (
            None
            if expected == actual
            else f"{path}: {_short(actual)}, expected {_short(expected)}"
        )
    if expected == actual and all(
        type(value) is type(actual[key]) for key, value in expected.items()
    ):
        if not any(isinstance(value, dict) for value in expected.values()):
            return None
    for key, value in expected.items():
        if key is ...:
            continue
        if isinstance(value, Maybe):
            if key not in actual:
                continue
            value = value.value
        if key not in actual:
            return f"{path or 'answer'}: {key!r} is missing from {_short(actual)}"
        nested = _difference(value, actual[key], f"{path}.{key}" if path else str(key))
        if nested:
            return nested
    extra = [key for key in actual if key not in expected]
    if extra and ... not in expected:
        return f"{path or 'answer'}: {extra[0]!r} is not expected: {_short(actual)}"
    return None


def _short(value: object) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 200 else text[:200] + "..."
