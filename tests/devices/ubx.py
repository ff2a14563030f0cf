"""Messages of u-blox receivers as pyubx2 has them, by the direction in which they go."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal

from tests.devices.definition import Definition, Definitions, NotHeld, formula, node, twice


def tables() -> Iterator[Definitions]:
    """What is received, what is sent, and what asks for data."""
    import pyubx2

    ids = {name: key for key, name in pyubx2.UBX_MSGIDS.items() if len(key) == 2}
    sets = (
        ("get", "telemetry", pyubx2.GET, pyubx2.UBX_PAYLOADS_GET),
        ("set", "telecommand", pyubx2.SET, pyubx2.UBX_PAYLOADS_SET),
        ("poll", "telecommand", pyubx2.POLL, pyubx2.UBX_PAYLOADS_POLL),
    )
    for name, kind, mode, payloads in sets:
        messages = [_definition(key, ids.get(key), kind, mode, one) for key, one in payloads.items()]
        yield Definitions(node(f"ubx_{name}", f"u-blox {name}", id_bits=16), messages)


def _definition(name: str, key: bytes | None, kind: str, mode: int, payload: dict) -> Definition:
    fields: list[dict] = []
    if key is None:
        return Definition(name, 0, kind, 0, [], cause="one of several layouts under one id")
    try:
        end = _fields(payload, fields, 0, "")
    except NotHeld as error:
        return Definition(name, 0, kind, 0, [], cause=str(error))
    double = twice(fields)
    high = {
        one["name"][3:] for one in fields if one["name"].startswith("_HP")
    }  # the library adds the second to the first
    for one in fields:
        if one["name"] in double:
            one["name"] = f"{one['name']} at {one['at']}"
        one["name"] = one["name"].lstrip("_")
    scaled = {one["name"] for one in fields if "formula" in one}

    def read(data: bytes) -> dict[str, object]:
        import pyubx2

        try:
            found = pyubx2.UBXMessage(key[:1], key[1:], mode, payload=data)
        except (pyubx2.UBXTypeError, pyubx2.UBXMessageError) as error:
            raise NotHeld("another layout under the same id") from error
        if data and found._get_dict(payload=data) is not payload:
            raise NotHeld("another layout under the same id")
        return {k: v for k, v in found.__dict__.items() if not k.startswith("_") and k not in high}

    return Definition(
        name, int.from_bytes(key, "big"), kind, end // 8, fields,
        raw=lambda data: {k: v for k, v in read(data).items() if k not in scaled},
        physical=lambda data: {k: v for k, v in read(data).items() if k in scaled},
    )  # fmt: skip


def _fields(payload: dict, fields: list[dict], at: int, before: str) -> int:
    """Appends the fields of a payload; where they end. Raises `NotHeld`."""
    for name, what in payload.items():
        factor = "1"
        if isinstance(what, tuple) and isinstance(what[1], dict):
            count, inner = what
            if isinstance(count, int):
                for number in range(count):
                    at = _fields(inner, fields, at, f"{before}_{number + 1:02d}")
                continue
            if not (isinstance(count, str) and count[0] == "X"):
                raise NotHeld("a group that goes up to the end" if count == "None" else "a counted group")
            bit = at
            for member, type_ in inner.items():
                width = int(type_[1:])
                fields.append({"at": bit, "bits": width, "name": member + before, "type": "uint"})
                bit += width
            at += 8 * int(count[1:])
            continue
        if isinstance(what, tuple):
            what, factor = what[0], format(Decimal(str(what[1])))
        at = _single(name + before, what, factor, fields, at)
    return at


def _single(name: str, what: str, factor: str, fields: list[dict], at: int) -> int:
    if not what[1:].isdigit():
        raise NotHeld("text up to the end" if what == "CH" else f"type {what}")
    letter, bits = what[0], 8 * int(what[1:])
    type_ = {"U": "uint", "E": "uint", "L": "uint", "I": "int", "R": "float"}.get(letter, "bytes")
    if bits > 64:
        type_ = "bytes"
    fields.append(
        {"at": at, "bits": bits, "name": name, "type": type_, **formula(factor.replace("E", "e").replace("+", ""))}
    )
    return at + bits
