"""Near misses: the known names that somebody most likely meant who mistyped one."""

from __future__ import annotations

import re
from collections.abc import Iterable

_WORD = re.compile(r"[^\W_]+")
_LONGEST = 200  # characters of a name that can be a slip of the pen
_LEAST = 3  # characters: a shorter word is near to half of all others
_PER_SLIP = 4  # characters of the longer word for each further slip, so `yellow` is no slip for `below`


def close_words(wanted: str, known: Iterable[str], most: int = 3) -> list[str]:
    """Return the known words within a few slips of ``wanted``, in any case, the nearest first.

    A slip is a character too much, too few or wrong, or two neighbours exchanged. One is allowed in names of 3 to 7
    characters, two in those of 8 to 11, and so on. Names of several words are near as well if one has all words of the
    other, such as `Processed` and `Processed Flag`; they come last.
    """
    name = wanted.casefold()
    if not name or len(name) > _LONGEST:
        return []
    near = []
    for candidate in dict.fromkeys(known):
        folded = candidate.casefold()
        slips = _slips(name, folded)
        if slips is not None:
            near.append((slips, candidate))
        elif _has_words_of(name, folded) or _has_words_of(folded, name):
            near.append((_LONGEST, candidate))
    return [candidate for _, candidate in sorted(near, key=lambda pair: pair[0])[:most]]


def close_to(wanted: str, known: Iterable[str]) -> str:
    """Return the nearest of the known words; empty if none is a near miss."""
    return next(iter(close_words(wanted, known, 1)), "")


def _has_words_of(name: str, part: str) -> bool:
    """Whether all words of ``part`` are whole words of ``name``."""
    words = set(_WORD.findall(part))
    return words <= set(_WORD.findall(name)) and any(len(word) >= _LEAST for word in words)


def _slips(word: str, other: str) -> int | None:
    """Return the edit distance of two words with exchanges of neighbours; None if it is too large for a slip."""
    if word == other:
        return 0
    longest = max(len(word), len(other))
    allowed = max(1, longest // _PER_SLIP) if longest >= _LEAST else 0
    if abs(len(word) - len(other)) > allowed:
        return None
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, character in enumerate(word, 1):
        older, before, row = before, row, [i]
        for j, its in enumerate(other, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (character != its))
            if i > 1 and j > 1 and character == other[j - 2] and word[i - 2] == its:
                cost = min(cost, older[j - 2] + 1)
            row.append(cost)
        if min(row) > allowed:
            return None
    return row[-1] if row[-1] <= allowed else None
