"""Similarity of names in spelling and in meaning.

The matching uses `likeness` and `overlap` as scores; the rules use `same_sense` and
`extends` to separate a corrected spelling from another meaning.
"""

from __future__ import annotations

from functools import lru_cache

from icdgen.icd.model import Enum
from icdgen.naming import words

_SHORTEST = 5  # minimum letters of a word for the recognition of typing errors


def likeness(first_name: str, second_name: str) -> float:
    """Return the similarity of two names from 0 (nothing in common) to 1 (same words).

    The measure is symmetric: the Dice coefficient of their pairs of letters.
    """
    first, second = letters(first_name), letters(second_name)
    # Sørensen–Dice coefficient of bigrams: tolerant of inserted words and plural forms.
    return (
        2 * len(first & second) / (len(first) + len(second)) if first or second else 1.0
    )


@lru_cache(maxsize=1 << 18)
def letters(name: str) -> frozenset[str]:
    """Return the pairs of letters of the words of a name, as compared by `likeness`."""
    text = f" {' '.join(words(name))} "
    return (
        frozenset(text[i : i + 2] for i in range(len(text) - 1))
        if text.strip()
        else frozenset()
    )


def overlap(first: frozenset[object], second: frozenset[object]) -> float:
    """Return the Jaccard index of two sets (common elements by all elements); 0.5 for
    two empty sets.
    """
    return len(first & second) / len(first | second) if first or second else 0.5


def other_senses(old: Enum, new: Enum) -> list[int]:
    """Return the values whose names have different meanings; for ranges, their first
    and last value.
    """
    ends: set[int] = set()
    for member in (*old.members, *new.members):
        ends |= {member.value, member.last}
    values = []
    for value in sorted(ends):
        was, now = old.member_of(value), new.member_of(value)
        if was and now and not same_sense(was.name, now.name):
            values.append(value)
    return values


@lru_cache(maxsize=1 << 18)
def same_sense(first_name: str, second_name: str) -> bool:
    """Return whether two names differ only in spelling: case, punctuation, order of
    words, or one typing error in a long word.

    Cautious: a possible other word counts as another meaning.
    """
    first, second = words(first_name), words(second_name)
    # "BatteryVoltage", "Battery voltage" and "Voltage Battery" are the same words.
    if "".join(first) == "".join(second) or sorted(first) == sorted(second):
        return True
    if len(first) != len(second):
        return False
    return all(a == b or _is_slip(a, b) for a, b in zip(first, second, strict=True))


def extends(first_name: str, second_name: str) -> bool:
    """Return whether one name is the other with additional words: ``Mode`` and
    ``Control Mode``.
    """
    first, second = sorted((words(first_name), words(second_name)), key=len)
    remaining_words = iter(second)
    return (
        bool(first)
        and not _NEGATIONS.intersection(second)
        and all(word in remaining_words for word in first)
    )


# Additional words that reverse the meaning.
_NEGATIONS = frozenset(
    "no not non un in dis de off without anti negative inverse inverted".split()
)


def _is_slip(first: str, second: str) -> bool:
    """Return whether two words differ by one typing error: an additional, missing or
    swapped letter, or s for z.

    Numbers and first letters must be equal.
    """
    # "roll" and "poll" differ by a letter but are different words.
    if (
        min(len(first), len(second)) < _SHORTEST
        or first[0] != second[0]
        or any(c.isdigit() for c in first + second)
    ):
        return False
    if len(first) == len(second):
        differences = [
            i for i, (a, b) in enumerate(zip(first, second, strict=True)) if a != b
        ]
        if len(differences) == 1:
            return {first[differences[0]], second[differences[0]]} == {"s", "z"}
        return (
            len(differences) == 2
            and first[differences[0]] == second[differences[1]]
            and first[differences[1]] == second[differences[0]]
        )
    short, long = sorted((first, second), key=len)
    return len(long) - len(short) == 1 and any(
        long[:i] + long[i + 1 :] == short for i in range(len(long))
    )
