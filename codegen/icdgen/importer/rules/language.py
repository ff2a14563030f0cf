"""Patterns, roles, numbers and type names of the rule language.

A pattern is a regular expression with roles in braces, such as
``{byte}(?:-{last_byte})?``. `compile_pattern` replaces each role by its expression, and
`take` applies patterns to the text of a cell.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from icdgen.diagnostics import Place
from icdgen.frozen import NamedTuple
from icdgen.importer.rules import positions
from icdgen.importer.words import HYPHENS, join, plain

INTEGER = r"(?:0[xX][0-9A-Fa-f]+|[0-9A-Fa-f]+[hH]\b|[0-9]+)"
NUMBER = r"[-+−–]?(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
TEXT = r".+?"
UNIT = r"[A-Za-zµμΩ°℃%][\w°²³/·%]*"

PLACE_ROLES = {
    "byte": "first byte",
    "last_byte": "last byte",
    "bit": "lowest bit",
    "last_bit": "highest bit",
    "end_bit": "bit of the last byte at which the field ends: `0.4-1.3`",
    "bytes": "size in bytes",
    "bits": "size in bits",
    "count": "number of elements of an array",
    "part": "lowest bit number, or L or H, of a split field",
    "last_part": "highest bit number of a split field",
    "stride": "distance in bytes between the elements of a repeated group",
}
VALUE_ROLES = {
    "scale": "factor: physical = scale * raw",
    "offset": "added after scaling: physical = scale * raw + offset",
    "bias": "subtracted before scaling: physical = scale * (raw - bias)",
    "min": "lowest physical value",
    "max": "highest physical value",
    "value": "value of a member or of a point",
    "up_to": "largest number of elements",
    "const": "the one valid raw value",
}
TEXT_ROLES = {
    "name": "name of the field",
    "type": "type name",
    "unit": "unit",
    "formula": "formula or factor with unit",
    "members": "values and names in one cell",
    "member": "name of a value",
    "text": "description",
    "group": "name of the repeated group",
    "rest": "marks a field that extends to the end of the frame",
    "counter": "name of the field that counts elements",
    "default": "initial value (not represented in an ICD)",
    "access": "access (not represented in an ICD)",
    "points": "physical value of a point of a lookup table",
}
MESSAGE_ROLES = {
    "message": "name of the message",
    "id": "id of the message",
    "set_id": "id that sets a configuration",
    "get_id": "id that reads a configuration",
    "kind": "telecommand, telemetry or configuration",
    "length": "length in bytes",
    "of": "name of the field to which an enumeration, a lookup table or bits belong",
    "message_text": "description of the message",
    "section": "group heading of the message in a list",
    "node": "name of the node that a list is about",
    "enumeration": "name of the enumeration of a field, or that a table of values gives",
    "mask": "mask of bytes in hexadecimal of which one bit selects a frame for a log",
}
ROLES = PLACE_ROLES | VALUE_ROLES | TEXT_ROLES | MESSAGE_ROLES
_FIELD_ROLES = {*PLACE_ROLES, *VALUE_ROLES, *TEXT_ROLES}
_IDS = {"id", "set_id", "get_id"}
# Any rule may give these roles. Where an ICD has no place for the text, they have no
# effect.
_PROSE = {
    "text",
    "message_text",
    "section",
    "default",
    "access",
}
_MESSAGE = {*_FIELD_ROLES, *_IDS, *_PROSE, "message", "kind", "length", "enumeration"}
ROLES_OF = {
    "message": _MESSAGE,
    "registers": _MESSAGE,
    "index": {*_PROSE, "message", "id", "kind", "length"},
    "list": {*_PROSE, *_IDS, "message", "kind", "length", "node"},
    "loggable": {*_PROSE, "message", "id", "mask", "bit"},
    "enumeration": {*_PROSE, "value", "member", "of", "message", "enumeration"},
    "lookup": {*_PROSE, "value", "points", "of", "message"},
    "bits": {*_FIELD_ROLES, *_PROSE, "of", "message", "enumeration"},
}
"""The roles that each kind of rule (`what`) uses."""
INTEGERS = frozenset(
    {*PLACE_ROLES, "value", "id", "set_id", "get_id", "length", "up_to", "const"}
    - {"part"}
)
NUMBERS = frozenset({"scale", "offset", "bias", "min", "max"})
_PATTERN_OF = {
    **dict.fromkeys(ROLES, TEXT),
    **dict.fromkeys(INTEGERS, INTEGER),
    **dict.fromkeys(NUMBERS, NUMBER),
    "unit": UNIT,
    "part": r"(?:[0-9]+|[LlHh])",
    "last_part": r"[0-9]+",
    "value": r"(?:-?[0-9]+|0[xX][0-9A-Fa-f]+|[0-9A-Fa-f]+[hH]\b|0b[01]+)",
}
KINDS = ("telecommand", "telemetry", "configuration")
_ROLE = re.compile(r"\{([a-z_]+)(?::((?:[^{}]|\{[0-9]*,?[0-9]*\})*))?\}")
_BRACE = re.compile(r"(?<!\\)\{(?![0-9]*,?[0-9]*\})")


class PatternError(Exception):
    """A pattern that cannot be used, with the reason and a remedy."""

    def __init__(self, message: str, help: str) -> None:
        super().__init__(message)
        self.message, self.help = message, help


@dataclass(frozen=True)
class Pattern:
    """Pattern of a profile: a bare role without ``regex``, or a regular expression with
    groups that are roles.
    """

    text: str
    place: Place
    regex: re.Pattern[str] | None = None

    @property
    def roles(self) -> frozenset[str]:
        """Roles that the pattern may give."""
        return (
            frozenset({self.text})
            if self.regex is None
            else frozenset(self.regex.groupindex)
        )

    def order_of(self, *roles: str) -> list[str]:
        """Return the roles that the pattern takes, in their order within the pattern."""
        return (
            []
            if self.regex is None
            else [role for role in self.regex.groupindex if role in roles]
        )


class Taken(NamedTuple):
    """Roles that a pattern took out of a text, and the text that no group or literal of
    it covers.
    """

    roles: dict[str, str]
    left: str
    # a list of numbers, such as `0, 2`, that the pattern takes for a range
    listed: str = ""


def compile_pattern(text: str, place: Place) -> Pattern:
    """Return the pattern of a text such as ``{byte}(?:-{last_byte})?`` or ``name``.

    Raises `PatternError`.
    """
    if text in ROLES:
        return Pattern(text, place)
    unknown = next(
        (match[1] for match in _ROLE.finditer(text) if match[1] not in ROLES), None
    )
    if unknown is not None:
        from icdgen.suggest import close_to

        close = close_to(unknown, ROLES)
        help = (
            f"did you mean `{{{close}}}`?"
            if close
            else f"roles are {', '.join(sorted(ROLES))}"
        )
        raise PatternError(f"unknown role `{unknown}` in the pattern `{text}`", help)
    # Cells have the hyphen for each kind of minus sign.
    text = text.translate(HYPHENS)
    expanded = _ROLE.sub(lambda m: f"(?P<{m[1]}>{m[2] or _PATTERN_OF[m[1]]})", text)
    if _BRACE.search(expanded):
        raise PatternError(
            f"a brace of the pattern `{text}` belongs to no role",
            "write `{role}`, `{role:regex}` or `\\{`",
        )
    try:
        regex = re.compile(expanded, re.I)
    except re.error as error:
        help = (
            "each role may stand once in a pattern"
            if "redefinition" in str(error)
            else "check brackets and backslashes"
        )
        raise PatternError(
            f"the pattern `{text}` is not a regular expression: {error}", help
        ) from None
    if not regex.groupindex:
        from icdgen.suggest import close_to

        close = close_to(text, ROLES)
        help = (
            f"did you mean the role `{close}`?"
            if close
            else "put what it finds into braces: `^{name} register$`"
        )
        raise PatternError(
            f"`{text}` is neither a role nor a pattern with a role", help
        )
    return Pattern(text, place, regex)


def take(patterns: Sequence[Pattern], text: str) -> Taken | None:
    """Return the roles of the first pattern that matches; None if none matches."""
    for pattern in patterns:
        # A bare role takes the whole text.
        if pattern.regex is None:
            return Taken({pattern.text: text} if text else {}, "")
        match = pattern.regex.search(text)
        if match is not None:
            roles = {
                role: value.strip()
                for role, value in match.groupdict().items()
                if value and value.strip()
            }
            left = normalised(f"{text[: match.start()]} {text[match.end() :]}")
            return Taken(roles, left, _listed(match, text))
    return None


def _listed(match: re.Match[str], text: str) -> str:
    """Return the text in which a pattern takes two listed numbers for the ends of a
    range.
    """
    for first, last in (("byte", "last_byte"), ("bit", "last_bit")):
        if match.groupdict().get(first) and match.groupdict().get(last):
            (start, end), (begin, stop) = match.span(first), match.span(last)
            numbers = whole_number(match[first]), whole_number(match[last])
            is_apart = (
                None not in numbers and abs((numbers[0] or 0) - (numbers[1] or 0)) > 1
            )
            if is_apart and positions.is_separator(text[end:begin]):
                return text[start:stop]
    return ""


@lru_cache(maxsize=1 << 16)
def normalised(text: str) -> str:
    """Return the text in one line, with ordinary characters for full-width ones and for
    blanks.
    """
    # Documents from East Asia print brackets, colons and digits as full-width
    # characters. NFKC of the whole text would change superscripts of units, too.
    wide = "".join(
        unicodedata.normalize("NFKC", c) if "！" <= c <= "～" or c == "　" else c
        for c in text
    )
    return plain(wide)


def cell_text(text: str, document_words: frozenset[str]) -> str:
    """Return the text of a cell in one line.

    A word that is broken at a hyphen is joined if ``document_words`` contains it.
    """
    return normalised(join(text.split("\n"), document_words) if "\n" in text else text)


def whole_number(text: str, base: int = 10) -> int | None:
    """Return the value of ``16``, ``0x10``, ``10h`` or ``0b10``, or None.

    ``base`` is the base of figures without a prefix or suffix.
    """
    text = text.replace("−", "-").replace("–", "-").replace(" ", "").strip()
    if re.fullmatch(r"0[xX][0-9a-fA-F]+", text):
        return int(text, 16)
    if re.fullmatch(r"[0-9a-fA-F]+[hH]", text):
        return int(text[:-1], 16)
    if base != 2 and re.fullmatch(r"0b[01]+", text):
        return int(text, 2)
    digits = {2: "[01]+", 10: "[-+]?[0-9]+", 16: "[0-9a-fA-F]+"}[base]
    # No id, size or position has 25 digits.
    return int(text, base) if re.fullmatch(digits, text) and len(text) < 25 else None


def decimal(text: str) -> str | None:
    """Return a number as an ICD writes it, with the digits of the source; None for
    another text, and for an exponent of more than two digits.
    """
    text = text.replace("−", "-").replace("–", "-").replace(" ", "").lstrip("+")
    # Some programs print `1e-007`.
    text = re.sub(r"(?<=[eE])([-+]?)0+(?=[0-9])", r"\1", text)
    # Formulas have two digits. A larger exponent can exceed a double and `Decimal`.
    if not re.fullmatch(NUMBER, text) or re.search("[eE][-+]?[0-9]{3}", text):
        return None
    return re.sub(r"^(-?)\.", r"\g<1>0.", text)


class TypeName(NamedTuple):
    """Meaning of a type name: the type in an ICD, and its width in bits or 0."""

    kind: str
    bits: int = 0


# The first pattern that matches the whole name counts. `long` is missing, because it
# has 32 or 64 bits.
_TYPE_NAMES = [
    (r"(?:unsigned char|uchar|byte|octet)", "uint", 8),
    # The sign of a plain `char` is implementation-defined in C (C99 6.2.5); manuals
    # that mean bytes print `unsigned char` or `byte`.
    (r"(?:signed char|char)", "int", 8),
    (r"unsigned short(?: int)?", "uint", 16),
    (r"short(?: int)?", "int", 16),
    (r"unsigned long long(?: int)?", "uint", 64),
    (r"long long(?: int)?", "int", 64),
    (r"(?:unsigned|uint|u)[ _]?([0-9]+)?(?:_t)?", "uint", 0),
    (r"(?:signed|sint|int|s|i)[ _]?([0-9]+)?(?:_t)?", "int", 0),
    (r"(?:float|f)[ _]?(32|64)(?:_t)?", "float", 0),
    (r"float|real|single", "float", 32),
    (r"double", "float", 64),
    (r"bool(?:ean)?|flag", "bool", 1),
    (r"enum", "enum", 0),
    (r"string|text|ascii", "text", 0),
    (r"bytes|array|raw", "bytes", 0),
]


def type_of(name: str) -> TypeName | None:
    """Return the type of a commonly used name, or None if only a profile can explain
    it.
    """
    text = normalised(name).casefold()
    for pattern, kind, bits in _TYPE_NAMES:
        match = re.fullmatch(pattern, text)
        if match:
            return TypeName(
                kind, int(match[1]) if match.groups() and match[1] else bits
            )
    return None
