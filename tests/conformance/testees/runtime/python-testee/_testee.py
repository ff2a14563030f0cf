"""Answers questions about the messages: one JSON object a line in, one out.

    python -m PACKAGE._testee

The protocol is described with icdgen's conformance tests.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

from . import NODES, _codec, _floats
from ._base import FieldInfo, Message
from ._errors import LengthError, RangeError, UnknownIdError

_MOST_VALUES = 65536
_HEX = re.compile("(?:[0-9A-Fa-f]{2})*")


class Refusal(Exception):
    """An answer that is not ``ok``."""

    def __init__(self, error: str, **more: object) -> None:
        super().__init__(error)
        self.answer: dict[str, Any] = {"ok": False, "error": error, **more}


def answer(line: bytes) -> dict[str, Any]:
    """The answer to a request, whatever it is."""
    try:
        request = json.loads(line.decode("utf-8"))
        if not isinstance(request, dict):
            raise Refusal("request")
        name = _key(request, "op", str)
        operation = _OPERATIONS.get(name)
        if operation is None:
            return _wire(name, request)
        return {"ok": True, **operation(request)}
    except Refusal as refusal:
        return refusal.answer
    except UnknownIdError as error:
        return {"ok": False, "error": "unknown-id", "detail": str(error)}
    except LengthError as error:
        counts = {"expected": error.expected, "actual": error.actual}
        return {"ok": False, "error": "length", **counts}
    except (RecursionError, ValueError) as error:
        return {"ok": False, "error": "request", "detail": str(error)}


def main() -> None:
    """Answers every line of standard input."""
    for line in sys.stdin.buffer:
        sys.stdout.write(json.dumps(answer(line.rstrip(b"\r\n"))) + "\n")
        sys.stdout.flush()


def _key(request: dict[str, Any], name: str, kind: type) -> Any:
    value = request.get(name)
    if type(value) is not kind:
        raise Refusal("request", detail=f"`{name}` is missing or has the wrong type")
    return value


def _bytes(text: object, size: int | None = None) -> bytes:
    if not isinstance(text, str) or not _HEX.fullmatch(text):
        raise Refusal("request", detail="these are not hex digits")
    if size is not None and len(text) != 2 * size:
        raise Refusal("request", detail=f"these are not {2 * size} hex digits")
    return bytes.fromhex(text)


def _wire(name: str, request: dict[str, Any]) -> dict[str, Any]:
    """The answer to a request about the wire layer."""
    from .wire import _testee

    if name not in _testee.OPERATIONS:
        raise Refusal("request")
    return _testee.answer(request)


def _node(request: dict[str, Any]) -> Any:
    name = _key(request, "node", str)
    if name not in NODES:
        raise Refusal("unknown-node")
    return import_module(f".{name}", __package__)


def _message(request: dict[str, Any]) -> type[Message]:
    _key(request, "node", str)
    kind, id = _key(request, "kind", str), _key(request, "id", int)
    if kind not in ("telecommand", "telemetry", "configuration"):
        raise Refusal("request", detail="there is no such kind")
    node = _node(request)
    if kind == "telecommand":
        found: type[Message] = node.TELECOMMANDS[id]
    elif kind == "telemetry":
        found = node.TELEMETRY[id]
    else:
        for messages in (node.TELECOMMANDS, node.TELEMETRY):
            if id in messages and kind == messages[id].KIND:
                return messages[id]  # type: ignore[no-any-return]
        raise UnknownIdError(node.NAME, kind, id)
    return found


def _decode(request: dict[str, Any]) -> dict[str, Any]:
    frame = _bytes(_key(request, "bytes", str))
    names = request.get("names", False)
    if type(names) is not bool:
        raise Refusal("request")
    return _described(_message(request).from_bytes(frame), names)


def _encode(request: dict[str, Any]) -> dict[str, Any]:
    raw, physical = request.get("raw", {}), request.get("physical", {})
    if not isinstance(raw, dict) or not isinstance(physical, dict):
        raise Refusal("request")
    message = _message(request)()
    fields = {info.name: info for info in message.FIELDS}
    for name in raw:
        if name not in fields:
            raise Refusal("unknown-field", field=name)
    for name in physical:
        if name not in fields or not fields[name].physical:
            raise Refusal("unknown-field", field=name)
    values: list[tuple[FieldInfo, str, Any]] = []
    for name, info in fields.items():
        if name in physical:
            bits = int.from_bytes(_bytes(physical[name], 8), "big")
            values.append((info, info.physical, _floats.float64(bits)))
        elif name in raw:
            values.append((info, info.attribute, _raw(info, raw[name])))
        else:
            raise Refusal("missing-field", field=name)
    try:
        for info, attribute, value in values:
            setattr(message, attribute, value)
        return _described(message)
    except RangeError as error:
        named = {info.attribute: info.name for info in message.FIELDS}
        refusal = Refusal("range", field=named[error.field], detail=str(error))
        raise refusal from None


def _raw(info: FieldInfo, given: object) -> Any:
    if info.type == "float":
        bits = int.from_bytes(_bytes(given, info.bits // 8), "big")
        return _floats.float32(bits) if info.bits == 32 else _floats.float64(bits)
    if info.type == "bytes":
        return _bytes(given)
    if type(given) is int or (info.type == "bool" and type(given) is bool):
        return given
    raise Refusal("request", detail=f"{info.attribute} has a value of the wrong type")


def _shown(info: FieldInfo, value: Any) -> Any:
    if info.type == "float":
        if info.bits == 32:
            return f"{_floats.float32_bits(value):08x}"
        return f"{_floats.float64_bits(value):016x}"
    if info.type == "bytes":
        return value.hex()
    return bool(value) if info.type == "bool" else int(value)


def _described(message: Message, names: bool = False) -> dict[str, Any]:
    frame = message.to_bytes()
    raw = {
        info.name: _shown(info, getattr(message, info.attribute))
        for info in message.FIELDS
    }
    physical = {
        info.name: f"{_floats.float64_bits(getattr(message, info.physical)):016x}"
        for info in message.FIELDS
        if info.physical
    }
    answer = {"raw": raw, "physical": physical, "bytes": frame.hex()}
    if names:
        answer["names"] = {
            info.name: getattr(message, info.attribute).label or None
            for info in message.FIELDS
            if info.enum
        }
    return answer


def _constants(request: dict[str, Any]) -> dict[str, Any]:
    message = _message(request)()
    return {
        "name": message.NAME,
        "ids": list(message.IDS),
        "length": message.LENGTH,
        "default": {
            info.name: _shown(info, getattr(message, info.attribute))
            for info in message.FIELDS
        },
        "special": {
            info.name: [value for value, _ in info.special]
            for info in message.FIELDS
            if info.special
        },
        "limits": {
            info.name: limits for info in message.FIELDS if (limits := _limits(info))
        },
    }


def _limits(info: FieldInfo) -> dict[str, str]:
    found = {
        "min": info.minimum,
        "max": info.maximum,
        "above": info.above,
        "below": info.below,
    }
    return {
        key: f"{_floats.float64_bits(float(value)):016x}"
        for key, value in found.items()
        if value is not None
    }


def _enum(request: dict[str, Any]) -> dict[str, Any]:
    _key(request, "node", str)
    wanted, value = _key(request, "enum", str), _key(request, "value", int)
    node = _node(request)
    if wanted not in node.ENUMS:
        raise Refusal("unknown-enum")
    enum = getattr(node, node.ENUMS[wanted])
    return {"name": {int(one): one.label for one in enum}.get(value)}


def _about_node(request: dict[str, Any]) -> dict[str, Any]:
    node = _node(request)
    return {
        "node_type": getattr(node, "NODE_TYPE", None),
        "interface_version": getattr(node, "INTERFACE_VERSION", None),
    }


def _sweep(request: dict[str, Any]) -> dict[str, Any]:
    name = _key(request, "field", str)
    values: Any
    if "values" in request:
        values = _key(request, "values", list)
    else:
        values = range(_key(request, "from", int), _key(request, "to", int) + 1)
        if values.stop - values.start > _MOST_VALUES:
            raise Refusal("request")
    if len(values) > _MOST_VALUES or any(type(value) is not int for value in values):
        raise Refusal("request")
    message = _message(request)()
    for info in message.FIELDS:
        if info.name == name and info.physical:
            break
    else:
        raise Refusal("unknown-field", field=name)
    low, high = _codec.raw_range(info)
    found, failures = [], 0
    for raw in values:
        if not low <= raw <= high:
            raise Refusal("range", field=name)
        setattr(message, info.attribute, raw)
        physical = getattr(message, info.physical)
        found.append(f"{_floats.float64_bits(physical):016x}")
        try:
            setattr(message, info.physical, physical)
        except RangeError:
            failures += 1
        else:
            failures += getattr(message, info.attribute) != raw
    return {"physical": "".join(found), "failures": failures}


_OPERATIONS: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "decode": _decode,
    "encode": _encode,
    "constants": _constants,
    "enum": _enum,
    "node": _about_node,
    "sweep": _sweep,
}

if __name__ == "__main__":
    main()
