"""The manual's names -> identifiers. One rule for all languages, documented in ``docs/icd-format.md``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from functools import lru_cache

_SEPARATORS = re.compile(r"[^A-Za-z0-9]+")
_HUMPS = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")


@lru_cache(maxsize=8192)
def words(name: str, vocabulary: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Lower-case words of a name: ``TcErrorReason`` -> ``('tc', 'error', 'reason')``. Empty if nothing is left."""
    text = unicodedata.normalize("NFKD", name)
    whole = {word.lower() for word in vocabulary}
    found: list[str] = []
    for chunk in _SEPARATORS.split(text):
        if chunk:
            found += _split(chunk, vocabulary, whole)
    return tuple(found)


def _split(chunk: str, vocabulary: tuple[str, ...], whole: set[str]) -> Iterable[str]:
    for word in sorted(vocabulary, key=len, reverse=True):
        at = chunk.find(word)
        if at >= 0:
            before, after = chunk[:at], chunk[at + len(word) :]
            digits = re.match(r"[0-9]*", after).group()
            yield from _split(before, vocabulary, whole) if before else ()
            yield (word + digits).lower()
            rest = after[len(digits) :]
            yield from _split(rest, vocabulary, whole) if rest else ()
            return
    yield from (part.lower() for part in _HUMPS.split(chunk) if part)


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
