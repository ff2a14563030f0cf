"""Similar names, to suggest a correction for a mistyped name.

`close_words` compares the name with all valid names and returns the similar ones, and
`question` makes the help of an error message of them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

_WORD = re.compile(r"[^\W_]+")
# Characters; longer names are not compared, because the time is quadratic.
_LONGEST = 200
_LEAST = 3  # characters; shorter words are similar to half of all words
# Characters of the longer word per allowed edit, so that `yellow` is not similar to
# `below`.
_PER_EDIT = 4


def close_words(wanted: str, names: Iterable[str], most: int = 3) -> list[str]:
    """Return the known words that are similar to ``wanted``, ignoring case, the most
    similar first.

    An edit inserts, removes or replaces a character, or exchanges two neighbours. Names
    of 3 to 7 characters can differ in one edit, names of 8 to 11 characters in two, and
    so on. Names are also similar if one has all words of the other, such as `Processed`
    and `Processed Flag`; these come last.
    """
    name = wanted.casefold()
    if not name or len(name) > _LONGEST:
        return []
    similar = []
    for candidate in dict.fromkeys(names):
        folded = candidate.casefold()
        edits = _edits(name, folded)
        if edits is not None:
            similar.append((edits, candidate))
        elif _has_words_of(name, folded) or _has_words_of(folded, name):
            similar.append((_LONGEST, candidate))
    return [
        candidate for _, candidate in sorted(similar, key=lambda pair: pair[0])[:most]
    ]


def close_to(wanted: str, names: Iterable[str]) -> str:
    """Return the most similar of the known words; empty if no word is similar."""
    return next(iter(close_words(wanted, names, 1)), "")


def question(names: Iterable[str]) -> str:
    """Return the help "did you mean `a` or `b`?" with similar names; empty without
    names.
    """
    quoted = [f"`{name}`" for name in names]
    return f"did you mean {' or '.join(quoted)}?" if quoted else ""


def _has_words_of(name: str, part: str) -> bool:
    """Return whether ``name`` has all words of ``part``."""
    words = set(_WORD.findall(part))
    return words <= set(_WORD.findall(name)) and any(
        len(word) >= _LEAST for word in words
    )


def _edits(word: str, other: str) -> int | None:
    """Return the edit distance of two words (optimal string alignment); None if they
    are not similar.
    """
    if word == other:
        return 0
    longest = max(len(word), len(other))
    allowed = max(1, longest // _PER_EDIT) if longest >= _LEAST else 0
    if abs(len(word) - len(other)) > allowed:
        return None
    # Dynamic programming over the prefixes of both words, with the last three rows of
    # the matrix.
    previous: list[int] = []
    row = list(range(len(other) + 1))
    for i, character in enumerate(word, 1):
        before_previous, previous, row = previous, row, [i]
        for j, other_character in enumerate(other, 1):
            cost = min(
                previous[j] + 1,
                row[j - 1] + 1,
                previous[j - 1] + (character != other_character),
            )
            if (
                i > 1
                and j > 1
                and character == other[j - 2]
                and word[i - 2] == other_character
            ):
                cost = min(cost, before_previous[j - 2] + 1)
            row.append(cost)
        # No later row can have a smaller minimum.
        if min(row) > allowed:
            return None
    return row[-1] if row[-1] <= allowed else None
