"""Long names of C that compilers may confuse, and shorter ones in their place.

C99 guarantees that compilers tell names apart by their first 63 characters and no more (5.2.4.1). Of names that are the same
there each becomes its beginning with a digest of the whole, in C alone: other languages keep the long ones. A name that no
other one begins like stays as it is.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from hashlib import sha256
from pathlib import PurePosixPath

from icdgen.backends import Identifier

SIGNIFICANT = 63
_DIGITS = 8
_LONG = re.compile(rf"\b[A-Za-z_]\w{{{SIGNIFICANT - 1},}}")
_LONG_OR_INCLUDE = re.compile(rf"#include[^\n]*|{_LONG.pattern}")  # names of files stay as they are


def short_names(identifiers: Iterable[Identifier]) -> dict[str, str]:
    """The shorter name of each that is not unique in its first 63 characters."""
    alike: defaultdict[str, set[str]] = defaultdict(set)
    for one in identifiers:
        if len(one.text) >= SIGNIFICANT and _LONG.fullmatch(one.text):
            alike[one.text[:SIGNIFICANT]].add(one.text)
    return {text: _short(text) for texts in alike.values() if len(texts) > 1 for text in texts}


def _short(text: str) -> str:
    digest = sha256(text.encode()).hexdigest()[:_DIGITS]
    begin = text[: SIGNIFICANT - _DIGITS - 1].rstrip("_")
    return f"{begin}_{digest.upper() if text.isupper() else digest}"


def with_short_names(
    files: Iterable[tuple[PurePosixPath, str]], identifiers: Callable[[], Iterable[Identifier]]
) -> Iterator[tuple[PurePosixPath, str]]:
    """C files with the shorter names. ``identifiers`` is asked once, and only if a file has long names."""
    short: dict[str, str] | None = None
    for path, text in files:
        if _LONG.search(text):
            short = short_names(identifiers()) if short is None else short
            text = _replaced(text, short)
        yield path, text


def _replaced(text: str, short: dict[str, str]) -> str:
    return _LONG_OR_INCLUDE.sub(lambda found: short.get(found[0], found[0]), text)
