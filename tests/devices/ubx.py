"""Messages of u-blox receivers as pyubx2 has them, by the direction in which they go."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from decimal import Decimal

from tests.devices.definition import Definition, Definitions, NotHeld, formula, node, open_end, twice

LONGEST = 1024  # bytes of a payload, where only its length says how many elements there are

VARIANTS: dict[tuple[str, str], tuple[str, dict[str, int]]] = {
    ("get", "AID-ALPSRV-REQ"): ("AID-ALPSRV", {}),
    ("get", "AID-ALPSRV-SEND"): ("AID-ALPSRV", {"type": 0xFF}),
    ("get", "CFG-NMEAvX"): ("CFG-NMEA", {}),
    ("get", "CFG-NMEAv0"): ("CFG-NMEA", {}),
    ("get", "NAV-AOPSTATUS-L"): ("NAV-AOPSTATUS", {}),
    ("get", "NAV-DAHEADING"): ("NAV-DAHEADING", {"version": 2}),
    ("get", "NAV-DAHEADINGHP"): ("NAV-DAHEADING", {}),
    ("get", "NAV-RELPOSNED-V0"): ("NAV-RELPOSNED", {"version": 0}),
    ("get", "RXM-PMP-V0"): ("RXM-PMP", {"version": 0}),
    ("get", "RXM-PMP-V1"): ("RXM-PMP", {}),
    ("get", "RXM-RLM-S"): ("RXM-RLM", {"type": 1}),
    ("get", "RXM-RLM-L"): ("RXM-RLM", {}),
    ("get", "SEC-SIG-V1"): ("SEC-SIG", {"version": 1}),
    ("get", "SEC-SIG-V2"): ("SEC-SIG", {}),
    ("set", "CFG-DAT-NUM"): ("CFG-DAT", {}),
    ("set", "RXM-PMP-V0"): ("RXM-PMP", {"version": 0}),
    ("set", "RXM-PMP-V1"): ("RXM-PMP", {}),
    ("set", "RXM-PMREQ-S"): ("RXM-PMREQ", {}),
    ("set", "TIM-VCOCAL-V0"): ("TIM-VCOCAL", {"type": 0}),
    ("poll", "CFG-TP5-TPX"): ("CFG-TP5", {}),
}
"""Layouts that share an id: whose id it is, and the constants that tell them; without any, lengths do or it is the general one."""

TYPES = {"U": "uint", "E": "uint", "L": "uint", "I": "int", "R": "float", "X": "bytes", "C": "bytes", "A": "bytes"}

BY_KEYS = {"CFG-VALGET", "CFG-VALSET"}  # the library reads them as values whose types a table of keys tells


def tables() -> Iterator[Definitions]:
    """What is received, what is sent, and what asks for data."""
    import pyubx2

    sets = (
        ("get", "telemetry", pyubx2.GET, pyubx2.UBX_PAYLOADS_GET),
        ("set", "telecommand", pyubx2.SET, pyubx2.UBX_PAYLOADS_SET),
        ("poll", "telecommand", pyubx2.POLL, pyubx2.UBX_PAYLOADS_POLL),
    )
    for name, kind, mode, payloads in sets:
        messages = [_definition(name, key, kind, mode, one) for key, one in payloads.items()]
        yield Definitions(node(f"ubx_{name}", f"u-blox {name}", id_bits=16), messages)


def _key(direction: str, name: str) -> tuple[bytes | None, dict[str, int]]:
    """Class and number of a message, and the constants that its frames have."""
    import pyubx2

    ids = {name: key for key, name in pyubx2.UBX_MSGIDS.items()}
    owner, constants = VARIANTS.get((direction, name), (name, {}))
    key = ids.get(owner)
    if key is None:
        return None, {}
    return key[:2], constants if len(key) == 2 else {"type": key[2]}  # the table of ids has the type behind the number


def _definition(direction: str, name: str, kind: str, mode: int, payload: dict) -> Definition:
    fields: list[dict] = []
    key, constants = _key(direction, name)
    if key is None:
        return Definition(name, 0, kind, 0, [], cause="a layout without an id, which the library never reads")
    if name in BY_KEYS and direction != "poll":
        return Definition(name, 0, kind, 0, [], cause="values whose types a table of keys tells")
    try:
        end = _fields(payload, fields, 0, "")
    except NotHeld as error:
        return Definition(name, 0, kind, 0, [], cause=str(error))
    double = twice(fields)
    high = {
        one["name"][3:] for one in fields if one["name"].startswith("_HP")
    }  # the library adds the second to the first
    for one in fields:
        if one["name"] in constants:
            one["const"] = constants[one["name"]]
        if one["name"] in double:
            one["name"] = f"{one['name']} at {one['at']}"
        one["name"] = one["name"].lstrip("_")
    scaled = {one["name"] for one in fields if "formula" in one}

    def read(data: bytes) -> dict[str, object]:
        import pyubx2

        try:
            with contextlib.redirect_stdout(io.StringIO()):  # one of its functions prints
                found = pyubx2.UBXMessage(key[:1], key[1:], mode, payload=data)
                other = data and found._get_dict(payload=data) is not payload
        except (pyubx2.UBXTypeError, pyubx2.UBXMessageError, KeyError) as error:
            raise NotHeld("another layout under the same id") from error
        if other:
            raise NotHeld("another layout under the same id")
        values = {k: v for k, v in found.__dict__.items() if not k.startswith("_") and k not in high}
        return _gathered(values, fields[-1]) if fields and "up_to" in fields[-1] else values

    return Definition(
        name, int.from_bytes(key, "big"), kind, end // 8, fields,
        raw=lambda data: {k: v for k, v in read(data).items() if k not in scaled},
        physical=lambda data: {k: v for k, v in read(data).items() if k in scaled},
    )  # fmt: skip


def _gathered(values: dict[str, object], end: dict) -> dict[str, object]:
    """With what is open at the end as one value: the library has an attribute of each element, or one number of all bytes."""
    name, known = end["name"], dict(values)
    if end["type"] == "text":
        return known | {name: str(known.get(name, "")).encode()}
    if name in known:
        number, count = int(str(known[name])), int(str(known[end["count"]]))
        return known | {name: list(number.to_bytes(count, "little"))}
    elements = []
    while f"{name}_{len(elements) + 1:02d}" in known:
        elements.append(known.pop(f"{name}_{len(elements) + 1:02d}"))
    return known | {name: elements}


def _fields(payload: dict, fields: list[dict], at: int, before: str) -> int:
    """Appends the fields of a payload; where those that every frame has end. Raises `NotHeld`."""
    for name, what in payload.items():
        factor = "1"
        if fields and "up_to" in fields[-1]:
            raise NotHeld("more behind a counted group")
        if isinstance(what, tuple) and isinstance(what[1], dict):
            count, inner = what
            if isinstance(count, int):
                for number in range(count):
                    at = _fields(inner, fields, at, f"{before}_{number + 1:02d}")
                continue
            if not (isinstance(count, str) and count[0] == "X"):
                if name != list(payload)[-1]:
                    raise NotHeld("more behind a counted group")
                fields.append(_group(inner, count, fields, at))
                continue
            bit = at
            for member, type_ in inner.items():
                width = int(type_[1:])
                fields.append({"at": bit, "bits": width, "name": member + before, "type": "uint"})
                bit += width
            at += 8 * int(count[1:])
            continue
        if what in ("CH", "UPMP"):
            text = what == "CH"
            counter = "rest" if text else "numBytesUserData"
            fields.append(open_end(name + before, at, 8, "text" if text else "uint", counter, LONGEST))
            continue
        if isinstance(what, tuple):
            what, factor = what[0], format(Decimal(str(what[1])))
        at = _single(name + before, what, factor, fields, at)
    return at


def _group(inner: dict, count: str, fields: list[dict], at: int) -> dict:
    """A group that a field counts, or that goes up to the end, of one number. Raises `NotHeld`."""
    (name, what), *others = inner.items()
    if others or not isinstance(what, str):
        raise NotHeld("structs up to the end" if count == "None" else "counted structs")
    element: list[dict] = []
    bits = _single(name, what, "1", element, 0)
    type_ = element[0]["type"]
    if type_ == "bytes":
        raise NotHeld("an array of bytes or text")
    counter = next((one for one in fields if one["name"] == count), None)
    most = LONGEST * 8 // bits
    most = most if counter is None else min(most, (1 << counter["bits"]) - 1)
    return open_end(name, at, bits, type_, "rest" if count == "None" else count, most)


def _single(name: str, what: str, factor: str, fields: list[dict], at: int) -> int:
    if what[0] not in TYPES:
        raise NotHeld("a type that the library does not know itself")
    type_, bits = TYPES[what[0]], 8 * int(what[1:])
    if bits > 64:
        type_ = "bytes"
    fields.append(
        {"at": at, "bits": bits, "name": name, "type": type_, **formula(factor.replace("E", "e").replace("+", ""))}
    )
    return at + bits
