"""Help and fixes for common mistakes in the YAML text and the keys of an ICD.

`of_syntax` and `of_ambiguous` return the help for errors that `icdgen.icd.source`
reports. `of_key` and `of_value` return a `Remedy` for violations that
`icdgen.icd.schema` reports, `of_type` the spelling of a value in another type. Most
results are empty or None if no correction is likely.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from icdgen.diagnostics import Remedy
from icdgen.suggest import close_to

_QUOTES = "put the text in quotes"

# Common words for values and keys of the format, with the correct value or the help.
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
    "offset": "`at:`, in bits",
    "scale": "`formula: raw*0.01`", "factor": "`formula: raw*0.01`", "size": "`bits:`, or the `length:` of a message in bytes",
    "width": "`bits:`", "description": "`summary:`", "comment": "`summary:`", "values": "`enum:`, with the members under `enums:`",
}  # fmt: skip

# Keys of earlier versions, which `icdgen fmt` converts.
_EARLIER = frozenset(
    {"stream", "checksums", "client", "message_id", "errors", "uart", "i2c", "can"}
)
_EARLIER_IN_LINKS = frozenset(
    {"reasons", "acknowledge", "unsolicited", "message_types", "telecommand", "telemetry", "extended"}
)  # fmt: skip

_IN_BYTES = {
    "byte": ("at", "the first bit, if bytes count from 0"),
    "bytes": ("bits", "the width in bits"),
}
_REPEATED = frozenset({"count", "repeat", "array", "times", "elements", "length"})
_MOST_DIGITS = 30
_BOOLEANS = dict.fromkeys(("true", "yes", "y", "on"), "true") | dict.fromkeys(
    ("false", "no", "n", "off"), "false"
)
_PLAIN = re.compile(r"[-+.:\w]+")
_PREFIXED_NUMBER = re.compile(r"0[xX][0-9A-Fa-f]+|0[bB][01]+|0[oO][0-7]+")
_SCIENTIFIC = re.compile(
    r"(-?)([0-9]*)(?:\.([0-9]*))?(?:[eE](?=[-+]?([0-9]+)\Z)([-+]?)[0-9]+)?"
)
# Text before a value and the value itself, in block style and in flow style (within
# brackets).
_BEFORE_BLOCK, _BLOCK_VALUE = (
    re.compile(r":[ ]+|-[ ]+(?=[^ \w])"),
    re.compile(r"[^'\"{\[].*?(?=\s*(?:\s#.*)?\Z)"),
)
_BEFORE_FLOW, _FLOW_VALUE = (
    re.compile(r"(?<=[:,]) |[{\[]"),
    re.compile(r"[^'\"{}\[\],]+"),
)
_RENAMED = re.compile(r"`(\w+):`")


def of_syntax(problem: str, line: str, column: int) -> str:
    """Return the help for a syntax error of YAML at a column (from 0) of a line; empty
    if the cause is unclear.
    """
    character = line[column : column + 1]
    if "tab character" in problem or character == "\t":
        return "indent with spaces: YAML does not allow tabs"
    if "cannot start any token" in problem and character:
        return f"a text cannot begin with {character}: {_QUOTES}"
    if "mapping values are not allowed" in problem:
        return f"a colon followed by a space begins a value: {_QUOTES} if they belong to it, or correct the indentation"
    if "expected ',' or" in problem:
        if character in ("[", "{", "]"):
            return f"within {{ }}, {_QUOTES} if it has brackets"
        return "a bracket before this place is not closed, or a comma is missing: `{at: 0, bits: 8, name: Mode}`"
    return ""


def value_around(line: str, column: int) -> tuple[int, int]:
    """Return start and end of the unquoted value at a column (from 0) of a line; equal
    if there is no value.
    """
    is_flow = any(bracket in line[:column] for bracket in "{[")
    starts = [
        match.end()
        for match in (_BEFORE_FLOW if is_flow else _BEFORE_BLOCK).finditer(
            line, 0, column + 1
        )
    ]
    begin = column
    if starts:
        begin = starts[-1] if is_flow else starts[0]
    value = (_FLOW_VALUE if is_flow else _BLOCK_VALUE).match(line, begin)
    return (begin, begin) if value is None else value.span()


def in_quotes(text: str) -> str:
    """Return a text in double quotes, as YAML."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def of_value(
    key: str, value: object, owner: Mapping[str, Any], allowed: Iterable[str]
) -> Remedy | None:
    """Return the help for a word that is not an ``allowed`` value of a key of
    ``owner``; None if no value is similar.
    """
    word = str(value).strip().lower()
    synonyms = {"kind": _KINDS, "byte_order": _ORDERS, "bit_order": _BITS}.get(key, {})
    if word in synonyms:
        return Remedy(f"write `{key}: {synonyms[word]}`", synonyms[word])
    sized = _SIZED.fullmatch(word) if key == "type" else None
    if sized:
        bits = sized[2] or sized[4] or sized[5]
        kind = "uint" if sized[1] else "int"
        if sized[5]:
            kind = "float"
        # `u16` means a type and a width. The fix replaces only the type, so it needs
        # the right width.
        is_complete = owner.get("bits") == int(bits)
        return Remedy(
            f"write `type: {kind}` with `bits: {bits}`", kind if is_complete else ""
        )
    if key == "type" and word in _TYPES:
        kind = _TYPES[word].split("`")[1].removeprefix("type: ")
        return Remedy(
            f"write {_TYPES[word]}",
            kind if f"`bits: {owner.get('bits')}`" in _TYPES[word] else "",
        )
    close = close_to(word, allowed)
    return Remedy(f"did you mean `{close}`?", close) if close else None


def of_type(wanted: str | list[str], written: str) -> str:
    """Return the spelling of a value as the ``wanted`` type of JSON Schema; empty if it
    cannot be converted safely.
    """
    word = written.lower()
    if "boolean" in wanted:
        return _BOOLEANS.get(word, "")
    if "string" in wanted:
        # Only for plain words: a tag or a text with quotes can mean something else.
        return f'"{written}"' if _PLAIN.fullmatch(written) else ""
    number = plain_number(written.strip("'\""))
    return (
        number
        if "number" in wanted or ("integer" in wanted and "." not in number)
        else ""
    )


def of_ambiguous(written: str) -> str:
    """Return the help for a word that readers of YAML interpret as values of different
    types.
    """
    truth = of_type("boolean", written)
    if truth or written[:1].isalpha():
        return f'write "{written}" in quotes if it is text' + (
            f", {truth} if it is a boolean" if truth else ""
        )
    number = plain_number(written) or "a plain decimal or 0x number"
    return f'write "{written}" in quotes if it is text, {number} if it is a number'


def plain_number(written: str) -> str:
    """Return the plain spelling of a number, such as ``1.0e+20`` for ``1e20``; empty if
    its value is uncertain.
    """
    text = written.replace("_", "").removeprefix("+")
    if len(text) > _MOST_DIGITS:
        return ""
    if _PREFIXED_NUMBER.fullmatch(text):
        return f"0x{text[2:]}" if text[1] in "xX" else str(int(text, 0))
    exact = _SCIENTIFIC.fullmatch(text)
    # The format allows exponents of up to two digits.
    if exact is None or len(exact[4] or "") > 2:
        return ""
    sign, integer, fraction, exponent = exact[1], exact[2] or "0", exact[3], exact[4]
    if integer != "0" and integer.startswith("0"):
        return ""  # an octal number in YAML 1.1
    if exponent is None:
        return f"{sign}{integer}" + (f".{fraction}" if fraction else "")
    return f"{sign}{integer}.{fraction or '0'}e{exact[5] or '+'}{exponent}"


def of_key(key: str, value: object, known_keys: list[str]) -> Remedy | None:
    """Return the help for an unknown key with a value; None if no known key is similar."""
    target, meaning = _IN_BYTES.get(key.lower(), ("", ""))
    if target in known_keys:
        written = f" {8 * value}" if type(value) is int and 0 <= value < 1 << 16 else ""
        return Remedy(f"write `{target}:{written}`, {meaning}")
    if key in _EARLIER and "link" in known_keys:
        return Remedy("it is in `link:` now; `icdgen fmt` converts the file")
    if key in _EARLIER_IN_LINKS and "commands" in known_keys:
        return Remedy(
            "it is in `packets:`, `commands:` and `requests:` now; `icdgen fmt` converts the file"
        )
    if key == "covers":
        return Remedy("write it at the field with the role `checksum`")
    if key.lower() in _REPEATED:
        if "count" in known_keys:
            return Remedy(
                "write `count:`: `{at: 0, bits: 16, count: 6, name: Temperatures, type: int}` is an array of six numbers"
            )
        return Remedy(
            "only fields can be repeated, with `count:`; write anything else as often as it occurs"
        )
    if key.isdecimal():
        return Remedy(
            "write decimals with a point, not with a comma: `formula: raw*0.1`"
        )
    meant = _KEYS.get(key.lower(), "")
    # `meant` begins with a key, which the mapping must allow.
    if meant and re.search(r"`(\w+):", meant)[1] in known_keys:  # type: ignore[index]
        renamed = _RENAMED.fullmatch(meant)
        return Remedy(f"write {meant}", renamed[1] if renamed else "")
    close = close_to(key, known_keys)
    return Remedy(f"did you mean `{close}`?", close) if close else None
