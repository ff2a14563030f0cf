"""Names, texts and numbers of definitions in the spelling of an ICD.

All readers use these functions, so that names and summaries have the same form whatever
the kind of the definition.
"""

from __future__ import annotations

import re
from collections import Counter
from decimal import Decimal
from fractions import Fraction
from pathlib import PurePath

from icdgen.icd.units import SPELLINGS
from icdgen.naming import DEVICES, latin

LONGEST = 4000  # characters of a summary
_LONGEST_UNIT = 60
_NO_UNIT = frozenset({"", "-", "--", "none", "n/a", "na", "unitless", "no unit", "no_unit", "unit_none", "[]", "[-]"}) | {
    # Placeholders of databases for states and flags without a unit; SED and SES mean
    # "state encoded".
    "sed", "ses", "state", "states", "enum", "discrete", "binary", "bool", "boolean", "flag", "yes/no", "on/off", "code",
}  # fmt: skip
_UNPRINTABLE = re.compile("[^ -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


def node_name(text: str) -> str:
    """Return the node name for a text or file name: lower-case words with underscores,
    at most 40 characters.
    """
    plain = re.sub(r"[^a-z0-9]+", "_", latin(PurePath(text).stem).lower()).strip("_")
    plain = (
        plain
        if plain[:1].isalpha() and plain not in DEVICES
        else f"node_{plain}".rstrip("_")
    )
    return plain[:40].rstrip("_")


def line(text: str | None, longest: int = LONGEST) -> str:
    """Return a text as a single line without unprintable characters, shortened to
    ``longest``.
    """
    plain = " ".join(_UNPRINTABLE.sub(" ", text or "").split())
    return plain if len(plain) <= longest else plain[: longest - 4].rstrip() + " ..."


def summary(text: str | None) -> dict[str, str]:
    """Return the key `summary` of a comment, or no key for an empty comment."""
    plain = line(text)
    return {"summary": plain} if plain else {}


def unit(text: str | None) -> dict[str, str]:
    """Return the key `unit`, with the spelling of icdgen for known units.

    Placeholders such as `none` give no key.
    """
    symbol = line(text, _LONGEST_UNIT)
    return (
        {} if symbol.casefold() in _NO_UNIT else {"unit": SPELLINGS.get(symbol, symbol)}
    )


def printed(number: float | Decimal) -> str:
    """Return a number as in a formula: the shortest decimal of equal value."""
    exact = Decimal(str(number))
    # Plain notation for common magnitudes, an exponent otherwise.
    is_usual = not exact or Decimal("1e-6") <= abs(exact) < Decimal("1e24")
    text = format(exact, "f" if is_usual else "e").replace("E", "e")
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def formula(factor: str, offset: str = "0") -> dict[str, str]:
    """Return the key `formula` for decimal factor and offset, or no key for the raw
    value.
    """
    slope, constant = Fraction(factor), Fraction(offset)
    if slope == 1 and constant == 0:
        return {}
    text = (
        "raw" if slope == 1 else f"{'-' if slope < 0 else ''}raw*{factor.lstrip('-')}"
    )
    if constant:
        text += f" {'-' if constant < 0 else '+'} {offset.lstrip('-')}"
    return {"formula": text}


# An ICD takes longer integers for text (`icd.source`).
MOST_LIMIT = 10**38


def limits(
    low: Fraction | None, high: Fraction | None, first: Fraction, last: Fraction
) -> dict[str, int | float]:
    """Return the keys `min` and `max`.

    Limits outside ``first`` to ``last``, the range of the field, are left out, as are
    limits from `MOST_LIMIT` on and those that only an exponent can state.

    An empty intersection gives no keys.
    """
    lower, upper = low if low is not None else first, high if high is not None else last
    if lower > upper or upper < first or lower > last:
        return {}
    return {
        **(_number("min", lower) if lower > first else {}),
        **(_number("max", upper) if upper < last else {}),
    }


def _number(key: str, value: Fraction) -> dict[str, int | float]:
    if abs(value) >= MOST_LIMIT:
        return {}
    if value.denominator == 1:
        return {key: value.numerator}
    number = float(value)
    return {key: number} if "e" not in str(number) else {}


def without_type(name: str) -> str:
    """Return the name of a type without a suffix `type` or `_t`."""
    return re.sub("[ _]?([Tt]ype|_t)$", "", name) or name


def shortest(paths: list[tuple[str, ...]]) -> list[str]:
    """Return the shortest unique suffix of each path, in words."""
    lengths = [1] * len(paths)
    while True:
        names = [
            " ".join(path[-length:])
            for path, length in zip(paths, lengths, strict=True)
        ]
        times = Counter(names)
        longer = [
            i
            for i, path in enumerate(paths)
            if times[names[i]] > 1 and lengths[i] < len(path)
        ]
        if not longer:
            return names
        for number in longer:
            lengths[number] += 1
