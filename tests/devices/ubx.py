"""Messages of u-blox receivers as pyubx2 defines them, by direction."""

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
    repeated_names,
    variable_length_field,
    variable_length_structs,
)

# Largest payload in bytes of a message whose length determines the number of elements.
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
"""Layouts that share an id: the message that has the id, and the constants that
distinguish the layout. A layout without constants is distinguished by its length, or is
the general layout.
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

TYPE_PREFIXES = (*TYPES, "CH", "UPMP")
"""Prefixes of the names of types."""

CAUSES = {
    ("get", "CFG-VALGET"): "types of values that a table of keys determines",
    ("set", "CFG-VALSET"): "types of values that a table of keys determines",
}
"""Messages that the library decodes with special code."""

PLUS = {("set", "ESF-MEAS-TTAG"): 1}
"""Number of elements in addition to the counter. In a payload of the library a flag adds
them; this is two messages of an ICD.
"""


def tables() -> Iterator[Definitions]:
    """Yield the received messages, the sent messages, and the polls."""
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
            _definition(name, key, kind, mode, payload)
            for key, payload in layouts.items()
        ]
        yield Definitions(node(f"ubx_{name}", f"u-blox {name}", id_bits=16), messages)


def _key(direction: str, name: str) -> tuple[bytes | None, dict[str, int]]:
    """Return class and number of a message, and the constants of its frames."""
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
    if any(
        isinstance(what, str) and what[0] not in TYPE_PREFIXES
        for what in payload.values()
    ):
        return Definition(
            name,
            0,
            kind,
            0,
            [],
            unread="a dummy of the library's tests, with unknown types",
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
        field["name"][3:] for field in fields if field["name"].startswith("_HP")
    }  # the library adds the second to the first
    for field in fields:
        if field["name"] in constants:
            field["const"] = constants[field["name"]]
    of_struct = {struct["name"]: struct["fields"] for struct in structs}
    _make_names_unique(fields)
    for parts in of_struct.values():
        _make_names_unique(parts)
    scaled = {
        part["name"]
        for parts in (fields, *of_struct.values())
        for part in parts
        if "formula" in part
    }

    def read(data: bytes) -> dict[str, object]:
        import pyubx2

        try:
            with contextlib.redirect_stdout(
                io.StringIO()
            ):  # one of its functions prints
                message = pyubx2.UBXMessage(key[:1], key[1:], mode, payload=data)
                is_other_layout = (
                    data and message._get_dict(payload=data) is not payload
                )
        except (pyubx2.UBXTypeError, pyubx2.UBXMessageError, KeyError) as error:
            raise NotSupported("another layout under the same id") from error
        if is_other_layout:
            raise NotSupported("another layout under the same id")
        values = {
            k: v
            for k, v in message.__dict__.items()
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


def _make_names_unique(fields: list[dict]) -> None:
    """Give fields of the same name different names."""
    repeated = repeated_names(fields)
    for field in fields:
        if field["name"] in repeated:
            field["name"] = f"{field['name']} at {field['at']}"
        field["name"] = field["name"].lstrip("_")


def _of_structs(
    values: dict[str, object], end: str, parts: list[dict]
) -> dict[str, object]:
    """Return the values with the fields of structs by their full names.

    The library numbers attributes, the outer number before the inner.
    """
    remaining, number = dict(values), 0
    inner = [re.fullmatch(r"(.*?)((?:_\d\d+)*)", part["name"]) for part in parts]
    names = {match[0]: match for match in inner if match}
    while True:
        numbered = {
            name: f"{match[1]}_{number + 1:02d}{match[2]}"
            for name, match in names.items()
        }
        element = {
            name: remaining.pop(attribute)
            for name, attribute in numbered.items()
            if attribute in remaining
        }
        if not element:
            return remaining
        remaining |= {
            f"{end}[{number}].{name}": value for name, value in element.items()
        }
        number += 1


def _gathered(values: dict[str, object], end: dict) -> dict[str, object]:
    """Return the values with a variable-length field as one value.

    The library has an attribute for each element, or one number of all bytes.
    """
    name, gathered = end["name"], dict(values)
    if "size" in end and end["type"] == "text":
        return gathered | {name: str(gathered.get(name, "")).encode()}
    if name in gathered:
        number, count = int(str(gathered[name])), int(str(gathered[end["count"]]))
        return gathered | {name: list(number.to_bytes(count, "little"))}
    elements = []
    while f"{name}_{len(elements) + 1:02d}" in gathered:
        elements.append(gathered.pop(f"{name}_{len(elements) + 1:02d}"))
    return gathered | {name: elements}


def _fields(
    payload: dict,
    fields: list[dict],
    at: int,
    before: str,
    structs: list[dict],
    owner: str,
    plus: int = 0,
) -> int:
    """Append the fields of a payload, and the struct of a variable-length group.

    Return the bit at which the fields of fixed length end. ``plus`` is the number of
    elements in addition to the counter. Raises `NotSupported`.
    """
    for name, type_or_group in payload.items():
        factor = "1"
        is_group = (
            isinstance(type_or_group, tuple)
            and isinstance(type_or_group[1], dict)
            and not isinstance(type_or_group[0], int)
        )
        if (
            fields
            and "up_to" in fields[-1]
            and not (is_group and "rest" not in fields[-1].values())
        ):
            raise NotSupported("more behind a counted group")
        if isinstance(type_or_group, tuple) and isinstance(type_or_group[1], dict):
            count, inner = type_or_group
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
        if type_or_group in ("CH", "UPMP"):
            is_text = type_or_group == "CH"
            counter = "rest" if is_text else "numBytesUserData"
            fields.append(
                variable_length_field(
                    name + before,
                    at,
                    8,
                    "text" if is_text else "uint",
                    counter,
                    LONGEST,
                )
            )
            continue
        if isinstance(type_or_group, tuple):
            type_or_group, factor = (
                type_or_group[0],
                format(Decimal(str(type_or_group[1]))),
            )
        at = _single(name + before, type_or_group, factor, fields, at)
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
    """Return a group that a field counts or that goes up to the end of the frame.

    It is an array of numbers or texts, else of structs. Raises `NotSupported`.
    """
    parts: list[dict] = []
    bits = _fields(inner, parts, 0, "", structs, owner)
    counter = next((field for field in fields if field["name"] == count), None)
    most = LONGEST * 8 // bits
    most = most if counter is None else min(most, (1 << counter["bits"]) - 1 + plus)
    counted_by: str | dict = "rest" if count == "None" else count
    if plus and count != "None":
        counted_by = {"field": count, "plus": plus}
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
                "count": counted_by,
                "up_to": most,
            }
        if parts[0]["type"] == "bytes":
            raise NotSupported("an array of bytes")
        return variable_length_field(
            parts[0]["name"], at, bits, parts[0]["type"], counted_by, most
        )
    end, struct = variable_length_structs(
        owner, group, at, parts, bits, counted_by, most
    )
    structs.append(struct)
    return end


def _single(name: str, what: str, factor: str, fields: list[dict], at: int) -> int:
    # Names of types are a letter and a number of bytes: `U004`.
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
