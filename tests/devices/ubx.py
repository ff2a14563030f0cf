"""Messages of u-blox receivers as pyubx2 has them, by the direction in which they go."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterator
from decimal import Decimal

from tests.devices.definition import (
    Definition,
    Definitions,
    NotSupported,
    formula,
    node,
    open_end,
    open_structs,
    twice,
)

# bytes of a payload, where only its length says how many elements there are
LONGEST = 1024

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
    ("set", "ESF-MEAS"): ("ESF-MEAS", {"calibTtagValid": 0}),
    ("set", "ESF-MEAS-TTAG"): ("ESF-MEAS", {"calibTtagValid": 1}),
    ("set", "RXM-PMP-V0"): ("RXM-PMP", {"version": 0}),
    ("set", "RXM-PMP-V1"): ("RXM-PMP", {}),
    ("set", "RXM-PMREQ-S"): ("RXM-PMREQ", {}),
    ("set", "TIM-VCOCAL-V0"): ("TIM-VCOCAL", {"type": 0}),
    ("poll", "CFG-TP5-TPX"): ("CFG-TP5", {}),
}
"""Layouts that share an id: whose id it is, and the constants that tell them; without
any, lengths do or it is the general one.
"""

TYPES = {
    "U": "uint",
    "E": "uint",
    "L": "uint",
    "I": "int",
    "R": "float",
    "X": "bytes",
    "C": "bytes",
    "A": "bytes",
}

KNOWN = (*TYPES, "CH", "UPMP")
"""How the names of types begin."""

CAUSES = {
    ("get", "CFG-VALGET"): "values whose types a table of keys tells",
    ("set", "CFG-VALSET"): "values whose types a table of keys tells",
}
"""What the library does by code of its own."""

PLUS = {("set", "ESF-MEAS-TTAG"): 1}
"""So many elements more than the counter says: one payload of the library, in which a
flag adds them, is two messages.
"""


def tables() -> Iterator[Definitions]:
    """What is received, what is sent, and what asks for data."""
    import pyubx2

    sets = (
        ("get", "telemetry", pyubx2.GET, pyubx2.UBX_PAYLOADS_GET),
        ("set", "telecommand", pyubx2.SET, pyubx2.UBX_PAYLOADS_SET),
        ("poll", "telecommand", pyubx2.POLL, pyubx2.UBX_PAYLOADS_POLL),
    )
    for name, kind, mode, payloads in sets:
        layouts = dict(payloads)
        layouts |= {
            key: payloads[VARIANTS[way, key][0]] for way, key in PLUS if way == name
        }
        messages = [
            _definition(name, key, kind, mode, one) for key, one in layouts.items()
        ]
        yield Definitions(node(f"ubx_{name}", f"u-blox {name}", id_bits=16), messages)


def _key(direction: str, name: str) -> tuple[bytes | None, dict[str, int]]:
    """Class and number of a message, and the constants that its frames have."""
    import pyubx2

    ids = {name: key for key, name in pyubx2.UBX_MSGIDS.items()}
    owner, constants = VARIANTS.get((direction, name), (name, {}))
    key = ids.get(owner)
    if key is None:
        return None, {}
    return key[:2], (
        constants if len(key) == 2 else {"type": key[2]}
    )  # the table of ids has the type behind the number


def _definition(
    direction: str, name: str, kind: str, mode: int, payload: dict
) -> Definition:
    fields: list[dict] = []
    structs: list[dict] = []
    key, constants = _key(direction, name)
    if key is None:
        return Definition(
            name,
            0,
            kind,
            0,
            [],
            unread="layouts without an id, which the library never reads",
        )
    if any(isinstance(what, str) and what[0] not in KNOWN for what in payload.values()):
        return Definition(
            name,
            0,
            kind,
            0,
            [],
            unread="a dummy of the library's tests, of types that it does not know",
        )
    if (direction, name) in CAUSES:
        return Definition(name, 0, kind, 0, [], cause=CAUSES[direction, name])
    try:
        end = _fields(
            payload, fields, 0, "", structs, name, PLUS.get((direction, name), 0)
        )
    except NotSupported as error:
        return Definition(name, 0, kind, 0, [], cause=str(error))
    high = {
        one["name"][3:] for one in fields if one["name"].startswith("_HP")
    }  # the library adds the second to the first
    for one in fields:
        if one["name"] in constants:
            one["const"] = constants[one["name"]]
    of_struct = {one["name"]: one["fields"] for one in structs}
    _tell_apart(fields)
    for parts in of_struct.values():
        _tell_apart(parts)
    scaled = {
        one["name"]
        for one in (*fields, *(part for one in structs for part in one["fields"]))
        if "formula" in one
    }

    def read(data: bytes) -> dict[str, object]:
        import pyubx2

        try:
            with contextlib.redirect_stdout(
                io.StringIO()
            ):  # one of its functions prints
                found = pyubx2.UBXMessage(key[:1], key[1:], mode, payload=data)
                other = data and found._get_dict(payload=data) is not payload
        except (pyubx2.UBXTypeError, pyubx2.UBXMessageError, KeyError) as error:
            raise NotSupported("another layout under the same id") from error
        if other:
            raise NotSupported("another layout under the same id")
        values = {
            k: v
            for k, v in found.__dict__.items()
            if not k.startswith("_") and k not in high
        }
        for end in fields:
            if "struct" in end:
                values = _of_structs(values, end["name"], of_struct[end["struct"]])
            elif "up_to" in end:
                values = _gathered(values, end)
        return values

    return Definition(
        name, int.from_bytes(key, "big"), kind, end // 8, fields, structs=structs,
        raw=lambda data: {k: v for k, v in read(data).items() if k.rpartition("].")[2] not in scaled},
        physical=lambda data: {k: v for k, v in read(data).items() if k.rpartition("].")[2] in scaled},
    )  # fmt: skip


def _tell_apart(fields: list[dict]) -> None:
    """Gives fields of the same name names of their own."""
    double = twice(fields)
    for one in fields:
        if one["name"] in double:
            one["name"] = f"{one['name']} at {one['at']}"
        one["name"] = one["name"].lstrip("_")


def _of_structs(
    values: dict[str, object], end: str, parts: list[dict]
) -> dict[str, object]:
    """With the fields of structs by their whole names: the library numbers attributes,
    the outer number before the inner.
    """
    known, number = dict(values), 0
    inner = [re.fullmatch(r"(.*?)((?:_\d\d+)*)", one["name"]) for one in parts]
    names = {one[0]: one for one in inner if one}
    while True:
        numbered = {
            name: f"{one[1]}_{number + 1:02d}{one[2]}" for name, one in names.items()
        }
        found = {
            name: known.pop(whole) for name, whole in numbered.items() if whole in known
        }
        if not found:
            return known
        known |= {f"{end}[{number}].{name}": value for name, value in found.items()}
        number += 1


def _gathered(values: dict[str, object], end: dict) -> dict[str, object]:
    """With what is open at the end as one value: the library has an attribute of each
    element, or one number of all bytes.
    """
    name, known = end["name"], dict(values)
    if "size" in end and end["type"] == "text":
        return known | {name: str(known.get(name, "")).encode()}
    if name in known:
        number, count = int(str(known[name])), int(str(known[end["count"]]))
        return known | {name: list(number.to_bytes(count, "little"))}
    elements = []
    while f"{name}_{len(elements) + 1:02d}" in known:
        elements.append(known.pop(f"{name}_{len(elements) + 1:02d}"))
    return known | {name: elements}


def _fields(
    payload: dict,
    fields: list[dict],
    at: int,
    before: str,
    structs: list[dict],
    owner: str,
    plus: int = 0,
) -> int:
    """Appends the fields of a payload, and the struct of an open group; where those of
    every frame end. Raises `NotSupported`.

    ``plus``: so many elements more than its counter says.
    """
    for name, what in payload.items():
        factor = "1"
        is_group = (
            isinstance(what, tuple)
            and isinstance(what[1], dict)
            and not isinstance(what[0], int)
        )
        if (
            fields
            and "up_to" in fields[-1]
            and not (is_group and "rest" not in fields[-1].values())
        ):
            raise NotSupported("more behind a counted group")
        if isinstance(what, tuple) and isinstance(what[1], dict):
            count, inner = what
            if isinstance(count, int):
                for number in range(count):
                    at = _fields(
                        inner, fields, at, f"{before}_{number + 1:02d}", structs, owner
                    )
                continue
            if not (isinstance(count, str) and count[0] == "X"):
                after = (
                    {"after": fields[-1]["name"]}
                    if fields and "up_to" in fields[-1]
                    else {}
                )
                fields.append(
                    _group(name, inner, count, fields, at, structs, owner, plus) | after
                )
                continue
            bit = at
            for member, type_ in inner.items():
                width = int(type_[1:])
                fields.append(
                    {"at": bit, "bits": width, "name": member + before, "type": "uint"}
                )
                bit += width
            at += 8 * int(count[1:])
            continue
        if what in ("CH", "UPMP"):
            text = what == "CH"
            counter = "rest" if text else "numBytesUserData"
            fields.append(
                open_end(
                    name + before, at, 8, "text" if text else "uint", counter, LONGEST
                )
            )
            continue
        if isinstance(what, tuple):
            what, factor = what[0], format(Decimal(str(what[1])))
        at = _single(name + before, what, factor, fields, at)
    return at


def _group(
    group: str,
    inner: dict,
    count: str,
    fields: list[dict],
    at: int,
    structs: list[dict],
    owner: str,
    plus: int,
) -> dict:
    """A group that a field counts, or up to the end: an array of numbers or texts, else
    of structs.

    Raises `NotSupported`.
    """
    parts: list[dict] = []
    bits = _fields(inner, parts, 0, "", structs, owner)
    counter = next((one for one in fields if one["name"] == count), None)
    most = LONGEST * 8 // bits
    most = most if counter is None else min(most, (1 << counter["bits"]) - 1 + plus)
    told: str | dict = (
        "rest" if count == "None" else {"field": count, "plus": plus} if plus else count
    )
    if (
        len(inner) == 1
        and "formula" not in parts[0]
        and not isinstance(next(iter(inner.values())), tuple)
    ):
        if next(iter(inner.values()))[0] == "C":
            return {
                "at": at,
                "bits": bits,
                "name": parts[0]["name"],
                "type": "text",
                "count": told,
                "up_to": most,
            }
        if parts[0]["type"] == "bytes":
            raise NotSupported("an array of bytes")
        return open_end(parts[0]["name"], at, bits, parts[0]["type"], told, most)
    end, struct = open_structs(owner, group, at, parts, bits, told, most)
    structs.append(struct)
    return end


def _single(name: str, what: str, factor: str, fields: list[dict], at: int) -> int:
    type_, bits = TYPES[what[0]], 8 * int(what[1:])
    if bits > 64:
        type_ = "bytes"
    fields.append(
        {
            "at": at,
            "bits": bits,
            "name": name,
            "type": type_,
            **formula(factor.replace("E", "e").replace("+", "")),
        }
    )
    return at + bits
