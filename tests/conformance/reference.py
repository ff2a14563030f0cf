"""A testee based on the reference codec: the simplest implementation of the protocol in
``README.md``.

Run ``python -m tests.conformance.reference [ICD ...]``.
"""

from __future__ import annotations

import json
import re
import struct
import sys
from pathlib import Path
from typing import Any

from icdgen import codec
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.runtime_objects import reference
from icdgen.vectors.make import ascii_text
from icdgen.vectors.settings import bits_of
from tests.conformance.icds import icd_of

MOST_VALUES = 65536


class Refusal(Exception):
    """An answer with ``"ok": false``."""

    def __init__(self, error: str, **more: object) -> None:
        self.answer = {"ok": False, "error": error, **more}


class Reference:
    """Answers requests about a set of ICDs."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self.ops = {
            "decode": self.decode, "encode": self.encode, "constants": self.constants, "enum": self.enum, "node": self.about_node,
            "sweep": self.sweep,
        }  # fmt: skip

    def answer(self, line: bytes) -> dict:
        try:
            request = json.loads(line.decode("utf-8"))
            if not isinstance(request, dict):
                raise Refusal("request")
            name = key(request, "op", str)
            if name in reference.OPS:
                return reference.answer(self.icd, request)
            op = self.ops.get(name)
            if op is None:
                raise Refusal("request", detail="there is no such op")
            return {"ok": True, **op(request)}
        except Refusal as refusal:
            return refusal.answer
        except (ValueError, OverflowError, RecursionError) as error:
            return {"ok": False, "error": "request", "detail": str(error)}

    def message(self, request: dict) -> tuple[Node, Any]:
        """Return the node that declares the message, and the message. For a shared id
        the list contains all candidates, so that a frame can decide.
        """
        name, kind, id = (
            key(request, "node", str),
            key(request, "kind", str),
            key(request, "id", int),
        )
        picks = {
            "telecommand": ["telecommand_id"],
            "telemetry": ["telemetry_id"],
            "configuration": ["set_id", "get_id"],
        }
        if kind not in picks:
            raise Refusal("request", detail="there is no such kind")
        node = self.node(name)
        named = key(request, "message", str) if "message" in request else None
        for pick in picks[kind]:
            candidates = [
                message
                for message in self.icd.messages_of(node)
                if getattr(message, pick) == id
            ]
            if len(candidates) > 1 and named is None:
                if request["op"] != "decode":
                    raise Refusal(
                        "request",
                        detail="several messages have the id, and `message` names none",
                    )
                return node, candidates
            candidates = [
                message for message in candidates if named in (None, message.name)
            ]
            if candidates:
                return self.icd.node(candidates[0].node), candidates[0]
        raise Refusal("unknown-id")

    def dispatched(self, messages: list[Message], frame: bytes) -> dict:
        """Return which of the messages of an id a frame is."""
        message = codec.message_of_frame(self.icd, messages, frame)
        if message is None:
            raise Refusal("unknown-id")
        node = self.icd.node(message.node)
        return {
            "message": message.name,
            "bytes": codec.encode(
                node, message, codec.decode(node, message, frame)
            ).hex(),
        }

    def node(self, name: str) -> Node:
        try:
            return self.icd.node(name)
        except KeyError:
            raise Refusal("unknown-node") from None

    def decode(self, request: dict) -> dict:
        frame = hex_bytes(key(request, "bytes", str))
        names = request.get("names", False)
        if not isinstance(names, bool):
            raise Refusal("request")
        node, message = self.message(request)
        try:
            if isinstance(message, list):
                return self.dispatched(message, frame)
            return described(node, message, codec.decode(node, message, frame), names)
        except codec.LengthError as error:
            raise Refusal(
                "length", expected=error.expected, actual=error.actual
            ) from None

    def encode(self, request: dict) -> dict:
        raw_values, physical = request.get("raw", {}), request.get("physical", {})
        if not isinstance(raw_values, dict) or not isinstance(physical, dict):
            raise Refusal("request")
        node, message = self.message(request)
        fields = {
            field.name: field
            for field in frame_fields(message.layout, node.orders)
            if field.is_raw
        }
        for name in raw_values:
            if name not in fields:
                raise Refusal("unknown-field", field=name)
        for name in physical:
            if name not in fields or not settable(fields[name]):
                raise Refusal("unknown-field", field=name)
        raw = {}
        for field in fields.values():
            if field.name in physical and field.type == "text":
                value = hex_bytes(physical[field.name]).decode("utf-8")
                raw[field.name] = fitting(field, codec.raw_from_text, value)
            elif field.name in physical:
                value = struct.unpack(">d", hex_bytes(physical[field.name], 8))[0]
                raw[field.name] = fitting(field, codec.raw_from_physical, value)
            elif field.conditions and raw_values.get(field.name) is None:
                continue
            elif field.name in raw_values:
                raw[field.name] = raw_value(field, raw_values[field.name])
            else:
                raise Refusal("missing-field", field=field.name)
        for part in message.layout.counted_parts:
            try:
                codec.size_from_counter(part, raw)
            except codec.CodecError as error:
                raise Refusal("range", field=part.counter, detail=str(error)) from None
        return described(
            node, message, codec.decode(node, message, codec.encode(node, message, raw))
        )

    def constants(self, request: dict) -> dict:
        node, message = self.message(request)
        default, fields = (
            codec.initial_object_values(node, message),
            frame_fields(message.layout, node.orders),
        )
        return {
            "name": message.name,
            "ids": list(message.ids),
            "length": message.length,
            "default": {f.name: shown(f, default.get(f.name)) for f in fields},
            "special": {
                f.name: [shown(f, special.value) for special in f.special]
                for f in fields
                if f.special
            },
            "limits": {f.name: limits(f) for f in fields if f.limits},
        }

    def enum(self, request: dict) -> dict:
        name, wanted, value = (
            key(request, "node", str),
            key(request, "enum", str),
            key(request, "value", int),
        )
        for enum in self.node(name).enums:
            if enum.name == wanted:
                return {"name": named(enum, value)}
        raise Refusal("unknown-enum")

    def about_node(self, request: dict) -> dict:
        node = self.node(key(request, "node", str))
        return {
            "node_type": node.node_type,
            "interface_version": node.interface_version,
        }

    def sweep(self, request: dict) -> dict:
        name = key(request, "field", str)
        if "values" in request:
            values = key(request, "values", list)
        else:
            values = range(key(request, "from", int), key(request, "to", int) + 1)
        if len(values) > MOST_VALUES or any(type(value) is not int for value in values):
            raise Refusal("request")
        node, message = self.message(request)
        fields = frame_fields(message.layout, node.orders)
        field = next(
            (field for field in fields if field.is_raw and field.name == name), None
        )
        if field is None or not settable(field):
            raise Refusal("unknown-field", field=name)
        doubles, failures = [], 0
        for raw in values:
            fitting(field, codec.check_raw, raw)
            physical = codec.physical_double(field, raw)
            doubles.append(bits_of(physical))
            failures += not comes_back(field, raw, physical)
        return {"physical": "".join(doubles), "failures": failures}


def comes_back(field: FrameField, raw: int, physical: float) -> bool:
    """Return whether setting the physical value returns the same raw value."""
    try:
        return codec.raw_from_physical(field, physical) == raw
    except codec.CodecError:
        return False


def key(request: dict, name: str, type_: type):
    """Return the value of a required key, which must have the given type."""
    value = request.get(name)
    if type(value) is not type_:
        raise Refusal(
            "request", detail=f"`{name}` is missing or is not of the right type"
        )
    return value


def hex_bytes(text: object, size: int | None = None) -> bytes:
    if (
        not isinstance(text, str)
        or not re.fullmatch("([0-9A-Fa-f]{2})*", text)
        or size not in (None, len(text) // 2)
    ):
        raise Refusal("request", detail="not the hex digits that are expected")
    return bytes.fromhex(text)


def raw_value(field: FrameField, value: object) -> int | bytes:
    """Return a checked raw value from a request."""
    if field.type == "float":
        return int.from_bytes(hex_bytes(value, field.bits // 8), "big")
    if field.is_bytes:
        raw: int | bytes = hex_bytes(value)
    elif type(value) is int or (field.type == "bool" and type(value) is bool):
        raw = value  # type: ignore[assignment]
    else:
        raise Refusal("request", detail=f"a value of {field.name!r} has the wrong type")
    fitting(field, codec.check_raw, raw)
    return raw


def fitting(field: FrameField, call, value):
    """Return the result of ``call`` for the value. Raises `Refusal` if the value is out
    of range.
    """
    try:
        return call(field, value)
    except codec.CodecError as error:
        raise Refusal("range", field=field.name, detail=str(error)) from None


def settable(field: FrameField) -> bool:
    """Return whether the field can be set by a physical value."""
    return (field.has_formula and field.is_invertible) or field.type == "text"


def limits(field: FrameField) -> dict[str, str]:
    """Return the limits of a field as doubles."""
    bounds = {
        key: getattr(field.limits, key) for key in ("min", "max", "above", "below")
    }
    return {
        key: bits_of(value.numerator / value.denominator)
        for key, value in bounds.items()
        if value is not None
    }


def shown(field: FrameField, value: int | bytes | None) -> object:
    """Return a raw value in the form of an answer; null if the field is absent."""
    if value is None:
        return None
    if isinstance(value, bytes):
        return value.hex()
    if field.type == "float":
        return f"{value:0{field.bits // 4}x}"
    return bool(value) if field.type == "bool" else value


def physical_value(field: FrameField, raw: int | bytes | None) -> str | None:
    """Return a physical value in the form of an answer: text in hex, null if the bytes
    are no text or the field is absent.
    """
    if raw is None:
        return None
    if not isinstance(raw, bytes):
        return bits_of(codec.physical_double(field, raw))
    text = ascii_text(raw)
    return None if text is None else text.encode().hex()


def named(enum: Enum, value: int | None) -> str | None:
    """Return the enum member name of a value."""
    if value is None:
        return None
    member = enum.member_of(value)
    return member.name if member else None


def described(node: Node, message: Message, raw: dict, names: bool = False) -> dict:
    """Return the answer to decode and encode requests."""
    fields = frame_fields(message.layout, node.orders)
    answer: dict = {
        "raw": {field.name: shown(field, raw.get(field.name)) for field in fields},
        "physical": {
            f.name: physical_value(f, raw.get(f.name))
            for f in fields
            if f.has_formula or f.type == "text"
        },
        "bytes": codec.encode(node, message, raw).hex(),
    }
    if names:
        answer["names"] = {
            f.name: named(f.enum, raw.get(f.name)) for f in fields if f.enum
        }
    return answer


def main() -> None:
    reference = Reference(icd_of([Path(argument) for argument in sys.argv[1:]]))
    for line in sys.stdin.buffer:
        sys.stdout.write(json.dumps(reference.answer(line.rstrip(b"\r\n"))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
