"""What a plain scalar of YAML means: only spellings that every YAML reader takes alike mean anything."""

from __future__ import annotations

import re

MAX_SCALAR = 20_000

_INTEGER = re.compile(r"-?(?:0|[1-9][0-9]*)\Z")
_HEX = re.compile(r"0x[0-9A-Fa-f]+\Z")
_DECIMAL = re.compile(r"-?(?:0|[1-9][0-9]*)\.[0-9]+(?:[eE][-+][0-9]{1,2})?\Z")
_LONGEST_WORD = len("false")  # of those that mean something else to some reader of YAML
_WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}
# What YAML 1.1 or 1.2 reads as something other than the text it looks like.
_TREACHEROUS = re.compile(
    r"""(?: [-+.][-+0-9_.:eExXobA-Fa-f]*
          | 0[bBoOxX][0-9A-Fa-f_]+
          | [0-9][0-9_]* (?: : [0-9_]+ )* (?: \. [0-9_.]* )? (?: e [-+]? [0-9]+ )?
          | [-+]?\.(?:inf|nan)
          | y(?:es)? | no? | on | off | true | false | null
          | [0-9]{4}-[0-9]{1,2}-[0-9]{1,2}(?:[Tt ].*)?
        )\Z""",
    re.VERBOSE | re.IGNORECASE,
)


def value_of(text: str) -> str | int | float | bool | None:
    """The value of an unquoted scalar. Raises `ValueError` if YAML readers disagree about it."""
    if len(text) > _LONGEST_WORD and text[0].isalpha():
        return text
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.match(text):
        return int(text) if len(text) < 40 else text
    if _HEX.match(text):
        return int(text, 16) if len(text) < 40 else text
    if _DECIMAL.match(text):
        return _number(text) if len(text) < 40 else text
    if _TREACHEROUS.match(text) and text not in (".", "-"):
        raise ValueError(text)
    return text


def _number(text: str) -> int | float:
    """A decimal; ``4.0`` is 4, as it is a whole number by JSON Schema, too."""
    whole, _, rest = text.partition(".")
    return float(text) if rest.strip("0") else int(whole)
