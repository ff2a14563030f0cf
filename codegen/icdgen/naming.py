"""The manual's names -> identifiers. One rule for all languages, documented in ``docs/reference/icd-format.md``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from functools import lru_cache

DEVICES = ("aux", "con", "nul", "prn", *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)))
"""Reserved names of files and folders on Windows, with any suffix."""

_SEPARATORS = re.compile(r"[^A-Za-z0-9]+")
_DIGITS = re.compile(r"[0-9]*")
# Letters that are no letter of ASCII with a mark.
_LETTERS = {"ß": "ss", "æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d", "ð": "d", "þ": "th", "ı": "i"}
_HUMPS = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")


@lru_cache(maxsize=1 << 18)
def words(name: str, vocabulary: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Lower-case words of a name: ``TcErrorReason`` -> ``('tc', 'error', 'reason')``. Empty if nothing is left."""
    text = latin(name)
    longest_first = sorted([word for word in map(latin, vocabulary) if word in text], key=len, reverse=True)
    found: list[str] = []
    for chunk in _SEPARATORS.split(text):
        found += _split(chunk, longest_first) if longest_first else _humps(chunk)
    return tuple(found)


def latin(text: str) -> str:
    """The text without the marks of its letters: ``Größe`` -> ``Grosse``. What ASCII has no letter for stays as it is."""
    if text.isascii():
        return text
    letters = [one for one in unicodedata.normalize("NFKD", text) if not unicodedata.combining(one)]
    return "".join(_letter(one, after) for one, after in zip(letters, [*letters[1:], ""], strict=True))


def _letter(one: str, after: str) -> str:
    """A letter before another one, in its case: ``AE`` of ``ÆRA``, ``Ae`` of ``Æra``."""
    found = _LETTERS.get(one.lower(), one)
    if found == one or one.islower():
        return found
    return found.capitalize() if after.islower() else found.upper()


@lru_cache(maxsize=1 << 16)
def _humps(chunk: str) -> tuple[str, ...]:
    return tuple(part.lower() for part in _HUMPS.split(chunk) if part)


def _split(chunk: str, vocabulary: list[str]) -> Iterable[str]:
    rest = [(chunk, False)]  # what is still to be split, the next last; a whole word is not split further
    while rest:
        text, is_word = rest.pop()
        word = None if is_word else next((w for w in vocabulary if w in text), None)
        if is_word:
            yield text.lower()
        elif word is None:
            yield from _humps(text)
        else:
            before, _, after = text.partition(word)
            found = _DIGITS.match(after)
            digits = found.group() if found else ""
            rest += [(after[len(digits) :], False), (word + digits, True), (before, False)]


def snake(parts: Iterable[str]) -> str:
    """``estimated_roll_angle``"""
    return "_".join(parts)


def upper(parts: Iterable[str]) -> str:
    """``ESTIMATED_ROLL_ANGLE``"""
    return "_".join(parts).upper()


def camel(parts: Iterable[str]) -> str:
    """``EstimatedRollAngle``; a digit after a digit keeps its separator: ``Area1_2``."""
    text = ""
    for part in parts:
        if text and text[-1].isdigit() and part[0].isdigit():
            text += "_"
        text += part[0].upper() + part[1:]
    return text
