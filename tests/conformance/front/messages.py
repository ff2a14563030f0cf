"""Answer requests about messages: their values, constants and enumerations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import hex_bytes, octets, text
from tests.conformance.front.program import Facts, Reply, items, text_of

if TYPE_CHECKING:
    from tests.conformance.front import Front

    Request = dict[str, Any]
    Field = dict[str, Any]

MOST_VALUES = 65536
KINDS = ("telecommand", "telemetry", "configuration")
OCTETS = ("bytes", "text")
ABSENT = "-"
LIMITS = ("min", "max", "above", "below")


def decode(front: Front, request: Request) -> dict[str, Any]:
    frame, names = octets(request), request.get("names", False)
    if type(names) is not bool:
        raise Refusal("request", detail="`names` is neither true nor false")
    route, message = _message(front, request)
    reply = front.ask("decode", *route, frame.hex())
    if (
        message is None
        and "name" in reply.facts
        and front.is_shared(route[0], request["kind"], request["id"])
    ):
        return {"message": text_of(reply.facts["name"]), "bytes": reply.facts["bytes"]}
    if message is None:
        raise Refusal("dispatcher", detail="decodes a message that does not exist")
    return _described(message["fields"], reply, names)


def encode(front: Front, request: Request) -> dict[str, Any]:
    raw, physical = request.get("raw", {}), request.get("physical", {})
    if not isinstance(raw, dict) or not isinstance(physical, dict):
        raise Refusal("request", detail="`raw` or `physical` is no object")
    route, fields = _route_and_fields(front, request)
    settable = {
        field["name"]: field["settable"] for field in fields if not field["view"]
    }
    for name in (
        *(name for name in raw if name not in settable),
        *(name for name in physical if not settable.get(name)),
    ):
        raise Refusal("unknown-field", field=name)
    values = []
    for field in fields:
        name = field["name"]
        if field["view"]:
            break  # these words come last
        if name in physical:
            values.append(f"p{_physical(field, physical[name])}")
        elif field["conditional"] and raw.get(name) is None:
            values.append("n")
        elif name in raw:
            values.append(f"r{_raw(field, raw[name])}")
        else:
            raise Refusal("missing-field", field=name)
    return _described(
        fields, _reply_about_fields(front, fields, "encode", *route, *values)
    )


def constants(front: Front, request: Request) -> dict[str, Any]:
    route, fields = _route_and_fields(front, request)
    reply = front.ask("constants", *route)
    rows = _named(fields, reply)
    limits = {
        name: {key: _double(row[key]) for key in LIMITS if key in row}
        for name, _, row in rows
    }
    return {
        "name": text_of(reply.facts["name"]),
        "ids": [int(id) for id in items(reply.facts["ids"])],
        "length": int(reply.facts["length"]),
        "default": {name: _shown(field, row["raw"]) for name, field, row in rows},
        "special": {
            name: [_shown(field, value) for value in items(row["special"])]
            for name, field, row in rows
            if row.get("special")
        },
        "limits": {name: some for name, some in limits.items() if some},
    }


def enum(front: Front, request: Request) -> dict[str, Any]:
    text(request, "node")
    name, value = text(request, "enum"), _integer(request.get("value"))
    node = front.node(request)
    enums = front.plan["nodes"][node]["enums"]
    if name not in enums:
        raise Refusal("unknown-enum")
    return {
        "name": text_of(
            front.ask("enum", node, enums.index(name), value).facts.get("name")
        )
    }


def node(front: Front, request: Request) -> dict[str, Any]:
    facts = front.ask("node", front.node(request)).facts
    return {
        key: int(facts[key]) if key in facts else None
        for key in ("node_type", "interface_version")
    }


def sweep(front: Front, request: Request) -> dict[str, Any]:
    name, values = text(request, "field"), request.get("values")
    if "values" not in request:
        first, last = _integer(request.get("from")), _integer(request.get("to"))
        values = range(first, min(last, first + MOST_VALUES) + 1)
    elif not isinstance(values, list):
        raise Refusal("request", detail="`values` is no list")
    if len(values) > MOST_VALUES or any(type(value) is not int for value in values):
        raise Refusal("request", detail="these are too many values, or not integers")
    route, fields = _route_and_fields(front, request)
    scaled = (
        (place, field)
        for place, field in enumerate(fields)
        if field["name"] == name and field["type"] != "text"
    )
    place = next((place for place, field in scaled if field["settable"]), None)
    if place is None:
        raise Refusal("unknown-field", field=name)
    doubles_and_back = items(
        _reply_about_fields(front, fields, "sweep", *route, place, *values).facts.get(
            "values", ""
        )
    )
    return {
        "physical": "".join(map(_double, doubles_and_back[::2])),
        "failures": sum(
            back != str(value)
            for back, value in zip(doubles_and_back[1::2], values, strict=True)
        ),
    }


OPS: dict[str, Callable[[Front, Request], dict[str, Any]]] = {
    op.__name__: op for op in (decode, encode, constants, enum, node, sweep)
}


def _message(
    front: Front, request: Request
) -> tuple[tuple[int, int, int | str], dict[str, Any] | None]:
    text(request, "node")
    kind, id = text(request, "kind"), _integer(request.get("id"))
    if kind not in KINDS:
        raise Refusal("request", detail="there is no such kind")
    name = text(request, "message") if "message" in request else None
    return front.route(front.node(request), kind, id, name)


def _route_and_fields(
    front: Front, request: Request
) -> tuple[tuple[int, int, int | str], list[Field]]:
    """Return the route to a message and its fields. For an id without a message the
    program decides on the refusal.
    """
    route, message = _message(front, request)
    if message is None and front.is_shared(route[0], request["kind"], request["id"]):
        raise Refusal(
            "request", detail="several messages have the id, and `message` names none"
        )
    if message is None:
        front.ask("decode", *route, "")
        raise Refusal("dispatcher", detail="decodes a message that does not exist")
    return route, message["fields"]


def _integer(value: object) -> int:
    if type(value) is not int:
        raise Refusal("request", detail="an integer is missing or has the wrong type")
    return value


def _sized(value: object, size: int) -> bytes:
    data = hex_bytes(value)
    if len(data) != size:
        raise Refusal("request", detail=f"these are not {2 * size} hex digits")
    return data


def _raw(field: Field, value: object) -> int | str:
    """Return a raw value of a request in the form for the program, which decides
    whether the value is in range.
    """
    if field["type"] == "float":
        return int.from_bytes(_sized(value, field["bits"] // 8), "big")
    if field["type"] in OCTETS:
        return hex_bytes(value).hex()
    return (
        int(value)
        if field["type"] == "bool" and type(value) is bool
        else _integer(value)
    )


def _shown(field: Field, value: str) -> object:
    """Return a raw value in the form of an answer; null if the field is absent."""
    if value == ABSENT and field["conditional"]:
        return None
    if field["type"] in OCTETS:
        return value
    if field["type"] == "float":
        return f"{int(value):0{field['bits'] // 4}x}"
    return (
        {"0": False, "1": True}.get(value, value)
        if field["type"] == "bool"
        else int(value)
    )


def _physical(field: Field, value: object) -> int | str:
    """Return a physical value of a request: the bits of a double, or the hex of a text."""
    return (
        hex_bytes(value).hex()
        if field["type"] == "text"
        else int.from_bytes(_sized(value, 8), "big")
    )


def _physical_shown(field: Field, row: Facts) -> str | None:
    """Return a physical value in the form of an answer; null if the bytes are no valid
    text.
    """
    if field["type"] == "text" or row["raw"] == ABSENT:
        return row.get("physical")
    return _double(row["physical"])


def _double(bits: str) -> str:
    return f"{int(bits):016x}"


def _reply_about_fields(front: Front, fields: list[Field], *words: object) -> Reply:
    """Return the program's reply. A refusal may name the field by its name or its
    index.
    """
    try:
        return front.ask(*words)
    except Refusal as refusal:
        place = refusal.details.pop("at", None)
        if place is not None:
            refusal.details["field"] = fields[place]["name"]
        raise


def _named(fields: list[Field], reply: Reply) -> list[tuple[str, Field, Facts]]:
    """Return the rows by field name. Names that the language does not know come from
    the ICD.
    """
    rows = reply.rows_of("field")
    return [
        (text_of(row.get("field")) or field["name"], field, row)
        for field, row in zip(fields, rows, strict=True)
    ]


def _described(
    fields: list[Field], reply: Reply, names: bool = False
) -> dict[str, Any]:
    rows = _named(fields, reply)
    answer = {
        "raw": {name: _shown(field, row["raw"]) for name, field, row in rows},
        "physical": {
            name: _physical_shown(field, row)
            for name, field, row in rows
            if field["scaled"]
        },
        "bytes": reply.facts["bytes"],
    }
    if names:
        answer["names"] = {
            name: text_of(row.get("name"))
            for name, field, row in rows
            if field["type"] == "enum"
        }
    return answer
