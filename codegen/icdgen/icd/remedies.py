"""What those who write their first ICD most likely meant."""

from __future__ import annotations

import re

_QUOTES = "put the text in quotes"
_KINDS = {
    "tlm": "telemetry", "tm": "telemetry", "telemetries": "telemetry", "status": "telemetry", "tc": "telecommand",
    "cmd": "telecommand", "command": "telecommand", "tcmd": "telecommand", "telecmd": "telecommand", "config": "configuration",
    "cfg": "configuration", "conf": "configuration",
}  # fmt: skip
_ORDERS = {
    "le": "little",
    "lsb": "little",
    "intel": "little",
    "be": "big",
    "msb": "big",
    "motorola": "big",
    "network": "big",
}
_BITS = {"lsb": "lsb0", "lsb_first": "lsb0", "msb": "msb0", "msb_first": "msb0"}
_SIZED = re.compile(r"(u?)(?:int)?(\d{1,2})(?:_t)?|(s|i)(\d{1,2})|f(?:loat)?(32|64)")
_TYPES = {
    "double": "`type: float` with `bits: 64`, or `int` or `uint` if the raw value is an integer with a formula",
    "unsigned": "`type: uint`", "signed": "`type: int`", "integer": "`type: int`",
    "boolean": "`type: bool` with `bits: 1`", "flag": "`type: bool` with `bits: 1`", "enumeration": "`type: enum`",
    "string": "`type: text`", "str": "`type: text`", "char": "`type: uint` with `bits: 8`", "byte": "`type: uint` with `bits: 8`",
}  # fmt: skip
_KEYS = {
    "byte": "`at:`, in bits: byte 2 is `at: 16`", "bytes": "`bits:`: 2 bytes are `bits: 16`", "offset": "`at:`, in bits",
    "scale": "`formula: raw*0.01`", "factor": "`formula: raw*0.01`", "size": "`bits:`, or the `length:` of a message in bytes",
    "width": "`bits:`", "description": "`summary:`", "comment": "`summary:`", "values": "`enum:`, with the members under `enums:`",
}  # fmt: skip

_REPEATED = frozenset({"count", "repeat", "array", "times", "elements", "length"})


def of_syntax(problem: str, line: str, column: int) -> str:
    """What to do where the YAML breaks off, at a column (from 0) of a line; nothing if there is no telling."""
    character = line[column : column + 1]
    if "tab character" in problem or character == "\t":
        return "indent with spaces: YAML takes no tabs"
    if "cannot start any token" in problem and character:
        return f'a text cannot begin with `{character}`: {_QUOTES}, "{character}"'
    if "mapping values are not allowed" in problem:
        return f"a colon and a space begin a value: {_QUOTES} if they belong to it, or correct the indentation"
    if "expected ',' or" in problem:
        if character in ("[", "{", "]"):
            return f"within {{ }} brackets are part of a text only in quotes: {_QUOTES}"
        return "a bracket before this place is not closed, or a comma is missing: `{at: 0, bits: 8, name: Mode}`"
    return ""


def of_value(key: str, value: object) -> str:
    """What is written instead of a word that the format does not know; nothing if there is no telling."""
    word = str(value).strip().lower()
    known = {"kind": _KINDS, "byte_order": _ORDERS, "bit_order": _BITS}.get(key, {})
    if word in known:
        return f"write `{key}: {known[word]}`"
    if key != "type":
        return ""
    sized = _SIZED.fullmatch(word)
    if sized:
        bits = sized[2] or sized[4] or sized[5]
        kind = "float" if sized[5] else "uint" if sized[1] else "int"
        return f"write `type: {kind}` with `bits: {bits}`"
    return f"write {_TYPES[word]}" if word in _TYPES else ""


def of_key(key: str, known: list[str]) -> str:
    """What is written instead of a key that the format does not know; nothing if there is no telling."""
    if key.lower() in _REPEATED:
        if "count" in known:
            return "write `count:`: `{at: 0, bits: 16, count: 6, name: Temperatures, type: int}` is an array of six numbers"
        return "only fields are repeated, by `count:`: what else there is several times is written as often"
    if key.isdecimal():
        return "decimals have a point and no comma: `formula: raw*0.1`"
    meant = _KEYS.get(key.lower(), "")
    return f"write {meant}" if meant and re.search(r"`(\w+):", meant)[1] in known else ""  # type: ignore[index]
