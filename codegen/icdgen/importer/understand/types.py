"""Names of types: what a value is, how wide, and how many of them."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from icdgen.importer.profile import Profile
from icdgen.importer.words import folded, plain

_SIZED = re.compile(r"([A-Za-z]+)\s*[\[(]?\s*([0-9]+)\s*[\])]?\Z")
_ARRAY = re.compile(r"(?P<base>.*?[^\s\[(x×*])\s*(?:\[\s*(?P<n>[0-9]+)\s*\]|\s[x×*]\s*(?P<m>[0-9]+))\Z")
_TIMES = re.compile(r"(?P<n>[0-9]+)\s*[x×*]\s*(?P<base>[A-Za-z].*)\Z")
_COUNTED = re.compile(r"(?P<n>[0-9]+)\s*-?\s*(?P<unit>bits?|bytes?|octets?)\b", re.I)
_SIGNS = {"unsigned": "uint", "uint": "uint", "signed": "int", "int": "int", "float": "float", "real": "float"}


class Type(NamedTuple):
    """``bits`` of one value, 0 where the name does not tell; ``times`` of them; ``is_said``: whether the name says whether
    the value has a sign."""

    kind: str
    bits: int = 0
    times: int = 1
    is_said: bool = True


def read(text: str, profile: Profile) -> Type | None:
    """The type that a name means; None if it is unknown."""
    text = plain(text)
    rule = profile.types.get("".join(folded(text)))
    if rule is not None:
        return Type(rule["type"], _width(rule))
    if (match := _SIZED.match(text)) and (rule := profile.types.get(match[1].casefold())):
        return Type(rule["type"], int(match[2]) * (8 if rule["type"] == "bytes" else 1))
    match = _ARRAY.match(text) or _TIMES.match(text)
    if match:
        groups = match.groupdict()
        count = int(groups["n"] or groups.get("m") or 1)
        base = read(match["base"], profile)
        if base is not None and base.bits and base.times == 1 and count:
            return base._replace(times=count)
    return _counted(text)


def _width(rule: dict[str, Any]) -> int:
    return int(rule.get("bits", 1 if rule["type"] == "bool" else 0))


def _counted(text: str) -> Type | None:
    """``2BYTE``, ``16-bit unsigned``: a width in words, and a sign where one is said."""
    match = _COUNTED.search(text)
    if match is None:
        return None
    bits = int(match["n"]) * (1 if match["unit"][:3].casefold() == "bit" else 8)
    words = folded(text[: match.start()] + " " + text[match.end() :])
    kinds = {_SIGNS[word] for word in words if word in _SIGNS}
    if "unsigned" in words:
        kinds = {"uint"}
    elif "signed" in words:
        kinds = {"int"}
    if len(kinds) > 1 or (not kinds and words and not set(words) <= {"unit", "value"} and "unit" not in words):
        return None
    return Type(kinds.pop() if kinds else "uint", bits, is_said=bool(kinds))
