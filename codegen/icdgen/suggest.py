"""What somebody probably meant who wrote a name that there is not."""

from __future__ import annotations

from collections.abc import Iterable

_LONGEST = 200  # characters that are compared: who wrote more meant none of them


def close_words(wanted: str, known: Iterable[str], most: int = 3) -> list[str]:
    """The known words that come near, in any case, the nearest first."""
    from difflib import get_close_matches

    by_folded = {word.casefold(): word for word in known}
    return [by_folded[one] for one in get_close_matches(wanted.casefold()[:_LONGEST], list(by_folded), most)]


def close_to(wanted: str, known: Iterable[str]) -> str:
    """The known word that was probably meant; empty if none comes near."""
    return next(iter(close_words(wanted, known, 1)), "")
