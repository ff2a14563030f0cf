"""How alike two names are, and whether the second still says what the first said."""

from __future__ import annotations

from functools import lru_cache

from icdgen.icd.model import Enum
from icdgen.naming import words

_SHORTEST = 5  # letters of a word in which a slip of the pen is told from another word


def likeness(one: str, other: str) -> float:
    """0: nothing in common, 1: the same words. Symmetric: the share of pairs of letters that both have."""
    first, second = letters(one), letters(other)
    return 2 * len(first & second) / (len(first) + len(second)) if first or second else 1.0


@lru_cache(maxsize=1 << 18)
def letters(name: str) -> frozenset[str]:
    """The pairs of letters of a name's words, by which `likeness` goes."""
    text = f" {' '.join(words(name))} "
    return frozenset(text[i : i + 2] for i in range(len(text) - 1)) if text.strip() else frozenset()


def overlap(one: frozenset[object], other: frozenset[object]) -> float:
    """Share of what both have in what either has; a half where there is nothing to compare."""
    return len(one & other) / len(one | other) if one or other else 0.5


def other_senses(old: Enum, new: Enum) -> list[int]:
    """Values to which both give names of another sense; of what is so for a range, where it begins or ends."""
    ends = sorted({value for enum in (old, new) for one in enum.members for value in (one.value, one.last)})
    named = ((value, old.member_of(value), new.member_of(value)) for value in ends)
    return [value for value, was, now in named if was and now and not same_sense(was.name, now.name)]


@lru_cache(maxsize=1 << 18)
def same_sense(one: str, other: str) -> bool:
    """Whether the names differ only in spelling: case, punctuation, spaces, or one slip of the pen in a long word.

    Cautious: what could be another word is another sense.
    """
    first, second = words(one), words(other)
    if "".join(first) == "".join(second) or sorted(first) == sorted(second):
        return True
    if len(first) != len(second):
        return False
    return all(a == b or _is_slip(a, b) for a, b in zip(first, second, strict=True))


def extends(one: str, other: str) -> bool:
    """Whether one name only says more than the other: ``Mode`` and ``Control Mode``."""
    first, second = sorted((words(one), words(other)), key=len)
    rest = iter(second)
    return bool(first) and not _NEGATIONS.intersection(second) and all(word in rest for word in first)


_NEGATIONS = frozenset("no not non un in dis de off without anti negative inverse inverted".split())


def _is_slip(one: str, other: str) -> bool:
    """One letter more, less, or two in the wrong order, within a word; s for z. Never in a number or at the beginning."""
    if min(len(one), len(other)) < _SHORTEST or one[0] != other[0] or any(c.isdigit() for c in one + other):
        return False
    if len(one) == len(other):
        apart = [i for i, (a, b) in enumerate(zip(one, other, strict=True)) if a != b]
        if len(apart) == 1:
            return {one[apart[0]], other[apart[0]]} == {"s", "z"}
        return len(apart) == 2 and one[apart[0]] == other[apart[1]] and one[apart[1]] == other[apart[0]]
    short, long = sorted((one, other), key=len)
    return len(long) - len(short) == 1 and any(long[:i] + long[i + 1 :] == short for i in range(len(long)))
