"""Requests that must not crash a testee, with the expected refusal. They need a node
with any message.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from tests.conformance.cases import MessageCases

ANY_REFUSAL = {"ok": False, "error": ..., ...: ...}


def bad_lines() -> Iterator[bytes]:
    """Lines that are no valid request."""
    yield from (
        b"", b" ", b"{", b"}", b"[]", b"null", b"7", b'"decode"', b"{}", b'{"op"}', b'{"op":}', b'{"op":"decode"', b"{]",
        b'{"op":"decode"} {"op":"decode"}', b'{"op":"decode",}', b"{'op':'decode'}", b'{"op":7}', b'{"op":null}', b"[{}",
        b'{"op":"no such"}', b'{"op":"decode"}', b'{"op":"encode"}', b'{"op":"constants"}', b'{"op":"enum"}', b'{"op":"node"}',
        b'{"op":"sweep"}', b"\xff\xfe{}", b'{"op":"\xc3\x28"}', b'{"op":"dec\\u006fde","node":7}', b'{"op":"\\ud800"}',
        b'{"op":"\\u12"}', b'{"op":"\\x"}', b'{"op":"decode\\u0000"}', b'{"a":1e999}', b'{"a":01}', b'{"a":-}', b'{"a":1.}',
        b'{"a":tru}', b'{"a":+1}', b"\x00", b"[" * 100_000, b'{"a":' * 100_000, b'{"op":"' + b"x" * 1_000_000 + b'"}',
        b"9" * 10_000,
    )  # fmt: skip


def bad_requests(cases: MessageCases) -> Iterator[tuple[dict, dict]]:
    """Yield requests with a single mistake each, and the expected refusals."""
    refusal = {"ok": False, "error": "request"}
    zeros = "00" * cases.message["length"]
    decode = cases.request("decode", bytes=zeros)
    encode = cases.request("encode", raw=cases.given)
    for key in ("op", "node", "kind", "id", "bytes"):
        yield {name: value for name, value in decode.items() if name != key}, refusal
    for key in decode:
        for value in (None, [], {}, 1.5):
            yield {**decode, key: value}, refusal
    yield {**decode, "kind": "no such"}, refusal
    yield {**decode, "names": "yes"}, refusal
    yield {**decode, "id": str(cases.id)}, refusal
    yield {**decode, "bytes": zeros + "0"}, refusal
    yield {**decode, "bytes": zeros[:-2] + "0g" if zeros else "zz"}, refusal
    yield {**decode, "bytes": zeros + " "}, refusal
    yield {**decode, "id": 2**64}, {"ok": False, "error": "unknown-id"}
    yield {**decode, "id": -(2**70)}, {"ok": False, "error": "unknown-id"}
    yield {**decode, "node": ""}, {"ok": False, "error": "unknown-node"}
    yield (
        {**decode, "node": "no such node \U0001f6f0"},
        {
            "ok": False,
            "error": "unknown-node",
        },
    )
    for value in (None, [], "", 7):
        yield {**encode, "raw": value}, refusal
        yield {**encode, "physical": value}, refusal
    strange = 'no such field \U0001f6f0 "\\\n\0'
    yield (
        {**encode, "raw": {**cases.given, strange: 0}},
        {
            "ok": False,
            "error": "unknown-field",
            "field": strange,
        },
    )
    yield (
        {**encode, "physical": {strange: "0" * 16}},
        {
            "ok": False,
            "error": "unknown-field",
            "field": strange,
        },
    )
    for field in one_of_each_kind(cases.fields):
        if field["name"] in cases.views:
            continue  # see `MessageCases.set_views`
        yield from bad_field(cases, encode, field)
    yield (
        {**cases.request("enum"), "enum": "no such", "value": 0},
        {
            "ok": False,
            "error": "unknown-enum",
        },
    )


def one_of_each_kind(fields: Iterable[dict]) -> list[dict]:
    """Return the first of all fields whose vectors differ only in names and numbers.
    The refusal of a request only depends on the kind.
    """
    kinds: dict[object, dict] = {}
    for field in fields:
        kind = (field["type"], field["bits"], frozenset(field), "[" in field["name"])
        kinds.setdefault(kind, field)
    return list(kinds.values())


def bad_field(
    cases: MessageCases, encode: dict, field: dict
) -> Iterator[tuple[dict, dict]]:
    """Yield encode requests with a mistake in one field."""
    name, refusal = field["name"], {"ok": False, "error": "request"}
    without = {
        key: value
        for key, value in cases.values_with_field(field).items()
        if key != name
    }
    is_conditional = name in cases.conditional  # absent fields need no value
    if not is_conditional:
        yield (
            {**encode, "raw": without},
            {
                "ok": False,
                "error": "missing-field",
                "field": name,
            },
        )
    if "set" not in field:
        request = {**encode, "raw": without, "physical": {name: "0" * 16}}
        yield request, {"ok": False, "error": "unknown-field", "field": name}
    elif field["type"] == "text":
        for value in (None, 0, "0", "zz", True):
            yield {**encode, "raw": without, "physical": {name: value}}, refusal
    else:
        for value in (None, 0, "0" * 15, "0" * 18, "0" * 15 + "x", True):
            yield {**encode, "raw": without, "physical": {name: value}}, refusal
        yield from bad_sweep(cases, name)
    wrong: tuple[object, ...] = (
        ([], {}, 1.5, 1e3) if is_conditional else (None, [], {}, 1.5, 1e3)
    )
    if field["type"] in ("float", "bytes", "text"):
        wrong += (0, True, "0", "zz" * (field["bits"] // 8), " ")
    else:
        wrong += ("0", "")
    if field["type"] not in ("float", "bytes", "text", "bool"):
        wrong += (True,)
    for value in wrong:
        yield {**encode, "raw": {**without, name: value}}, refusal
    sizes = ("", "00" * (field["bits"] // 8 + 1))
    unfit = {"float": (), "bytes": sizes, "text": sizes, "bool": (2, -1)}.get(
        field["type"], ()
    )
    if field["type"] not in ("float", "bytes", "text"):
        unfit = (*unfit, 2**64, -(2**63) - 1, 10**40, -(10**40))
    for value in unfit:
        yield (
            {**encode, "raw": {**without, name: value}},
            {
                "ok": False,
                "error": "range",
                "field": name,
            },
        )
    if field["type"] == "float":
        yield (
            {
                **encode,
                "raw": {**without, name: "0" * (field["bits"] // 4 + 2)},
            },
            refusal,
        )


def bad_sweep(cases: MessageCases, name: str) -> Iterator[tuple[dict, dict]]:
    refusal = {"ok": False, "error": "request"}
    sweep = cases.request("sweep", field=name)
    yield sweep, refusal
    yield {**sweep, "from": 0, "to": 65536}, refusal
    yield {**sweep, "from": 0, "to": 2**63}, refusal
    yield {**sweep, "from": 0}, refusal
    yield {**sweep, "values": [0] * 65537}, refusal
    yield {**sweep, "values": [1.5]}, refusal
    yield {**sweep, "values": [None]}, refusal
    yield {**sweep, "values": {}}, refusal
    yield {**sweep, "values": [2**64]}, {"ok": False, "error": "range", "field": name}
    yield (
        {**sweep, "field": "no such"} | {"values": []},
        {
            "ok": False,
            "error": "unknown-field",
            "field": "no such",
        },
    )
    yield {**sweep, "values": []}, {"ok": True, "physical": "", "failures": 0}


def line(request: dict) -> bytes:
    return json.dumps(request).encode()
