"""Conversion of names to identifiers.

All languages use the same rules, which ``docs/reference/icd-format.md`` describes under
"Identifiers". `words` splits a name into words in lower case; `snake`, `upper` and
`camel` join them. Words of the vocabulary of an ICD are never split. Reserved words and
clashes are not handled here, because they differ between languages.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from functools import lru_cache

# Reserved names of files and folders on Windows, with any suffix.
DEVICES = (
    "aux",
    "con",
    "nul",
    "prn",
    *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)),
)

_SEPARATORS = re.compile(r"[^A-Za-z0-9]+")
_DIGITS = re.compile(r"[0-9]*")
# Letters that Unicode does not decompose into an ASCII letter and a mark.
_LETTERS = {
    "ß": "ss",
    "æ": "ae",
    "œ": "oe",
    "ø": "o",
    "ł": "l",
    "đ": "d",
    "ð": "d",
    "þ": "th",
    "ı": "i",
}
_HUMPS = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")


@lru_cache(maxsize=1 << 18)
def words(name: str, vocabulary: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return the words of a name in lower case: ``TcErrorReason`` -> ``('tc', 'error',
    'reason')``.

    Words of the ``vocabulary`` are not split. Empty if the name has no ASCII letters
    and digits.
    """
    text = latin(name)
    unsplit = [word for word in _longest_first(vocabulary) if word in text]
    parts: list[str] = []
    for chunk in _SEPARATORS.split(text):
        parts += _split_by_vocabulary(chunk, unsplit) if unsplit else _humps(chunk)
    return tuple(parts)


@lru_cache(maxsize=1 << 8)
def _longest_first(vocabulary: tuple[str, ...]) -> list[str]:
    """Return the words of a vocabulary in ASCII, the longest first."""
    return sorted(map(latin, vocabulary), key=len, reverse=True)


def latin(text: str) -> str:
    """Return the text in ASCII letters: ``Größe`` -> ``Grosse``.

    Other characters are unchanged.
    """
    if text.isascii():
        return text
    letters = [
        character
        for character in unicodedata.normalize("NFKD", text)
        if not unicodedata.combining(character)
    ]
    return "".join(
        _letter(letter, after)
        for letter, after in zip(letters, [*letters[1:], ""], strict=True)
    )


def _letter(letter: str, after: str) -> str:
    """Return a letter in ASCII, in the case of the word: ``AE`` of ``ÆRA``, ``Ae`` of
    ``Æra``.
    """
    replacement = _LETTERS.get(letter.lower(), letter)
    if replacement == letter or letter.islower():
        return replacement
    return replacement.capitalize() if after.islower() else replacement.upper()


@lru_cache(maxsize=1 << 16)
def _humps(chunk: str) -> tuple[str, ...]:
    """Return the words of a text in camel case."""
    return tuple(part.lower() for part in _HUMPS.split(chunk) if part)


def _split_by_vocabulary(chunk: str, vocabulary: list[str]) -> Iterable[str]:
    """Yield the words of a text.

    Words of the vocabulary, with the digits after them, are not split.
    """
    # Parts of the text, the next one last, and whether a part is a word of the
    # vocabulary.
    stack = [(chunk, False)]
    while stack:
        text, is_word = stack.pop()
        word = (
            None
            if is_word
            else next((word for word in vocabulary if word in text), None)
        )
        if is_word:
            yield text.lower()
        elif word is None:
            yield from _humps(text)
        else:
            # Digits after a word belong to it: `GPS2` is one word, and not `gps` and
            # `2`.
            before, _, after = text.partition(word)
            match = _DIGITS.match(after)
            digits = match.group() if match else ""
            stack += [
                (after[len(digits) :], False),
                (word + digits, True),
                (before, False),
            ]


def snake(parts: Iterable[str]) -> str:
    """Return words in snake case: ``estimated_roll_angle``."""
    return "_".join(parts)


def upper(parts: Iterable[str]) -> str:
    """Return words in upper case: ``ESTIMATED_ROLL_ANGLE``."""
    return "_".join(parts).upper()


def camel(parts: Iterable[str]) -> str:
    """Return words in camel case: ``EstimatedRollAngle``.

    Two digits remain separated: ``Area1_2``.
    """
    text = ""
    for part in parts:
        if text and text[-1].isdigit() and part[0].isdigit():
            text += "_"
        text += part[0].upper() + part[1:]
    return text
