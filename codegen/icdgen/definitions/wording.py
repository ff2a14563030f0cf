"""Words and numbers of definitions as an ICD writes them."""

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
    # What databases write where a signal has states or flags and no unit; SED and SES mean "state encoded".
    "sed", "ses", "state", "states", "enum", "discrete", "binary", "bool", "boolean", "flag", "yes/no", "on/off", "code",
}  # fmt: skip
_UNPRINTABLE = re.compile("[^ -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


def node_name(text: str) -> str:
    """The name of a node: of a file its stem."""
    plain = re.sub(r"[^a-z0-9]+", "_", latin(PurePath(text).stem).lower()).strip("_")
    plain = plain if plain[:1].isalpha() and plain not in DEVICES else f"node_{plain}".rstrip("_")
    return plain[:40].rstrip("_")


def line(text: str | None, longest: int = LONGEST) -> str:
    """A text in one line, without what cannot be printed."""
    plain = " ".join(_UNPRINTABLE.sub(" ", text or "").split())
    return plain if len(plain) <= longest else plain[: longest - 4].rstrip() + " ..."


def summary(text: str | None) -> dict[str, str]:
    """The key of a comment; none where there is nothing to say."""
    said = line(text)
    return {"summary": said} if said else {}


def unit(text: str | None) -> dict[str, str]:
    """The key of a unit: that of icdgen where it is another spelling of one, else as it is printed."""
    symbol = line(text, _LONGEST_UNIT)
    return {} if symbol.casefold() in _NO_UNIT else {"unit": SPELLINGS.get(symbol, symbol)}


def printed(number: float | Decimal) -> str:
    """A number as a formula has it: the shortest decimal that means it."""
    exact = Decimal(str(number))
    is_usual = not exact or Decimal("1e-6") <= abs(exact) < Decimal("1e24")
    text = format(exact, "f" if is_usual else "e").replace("E", "e")
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def formula(factor: str, offset: str = "0") -> dict[str, str]:
    """The key of the formula of a factor and an offset as they are printed; none where the raw value is meant."""
    slope, constant = Fraction(factor), Fraction(offset)
    if slope == 1 and constant == 0:
        return {}
    text = "raw" if slope == 1 else f"{'-' if slope < 0 else ''}raw*{factor.lstrip('-')}"
    if constant:
        text += f" {'-' if constant < 0 else '+'} {offset.lstrip('-')}"
    return {"formula": text}


def limits(low: Fraction | None, high: Fraction | None, first: Fraction, last: Fraction) -> dict[str, int | float]:
    """The keys of limits, where they say more than the width of the field: ``first`` to ``last`` are the values that it has."""
    lower, upper = low if low is not None else first, high if high is not None else last
    if lower > upper or upper < first or lower > last:
        return {}
    return {
        **(_number("min", lower) if lower > first else {}),
        **(_number("max", upper) if upper < last else {}),
    }


def _number(key: str, value: Fraction) -> dict[str, int | float]:
    if value.denominator == 1:
        return {key: value.numerator}
    number = float(value)
    return {key: number} if "e" not in str(number) else {}


def without_type(name: str) -> str:
    """The name of a type without the word for it."""
    return re.sub("[ _]?([Tt]ype|_t)$", "", name) or name


def shortest(paths: list[tuple[str, ...]]) -> list[str]:
    """Of each path the last words that no other ends with."""
    lengths = [1] * len(paths)
    while True:
        names = [" ".join(path[-length:]) for path, length in zip(paths, lengths, strict=True)]
        times = Counter(names)
        longer = [i for i, path in enumerate(paths) if times[names[i]] > 1 and lengths[i] < len(path)]
        if not longer:
            return names
        for number in longer:
            lengths[number] += 1
