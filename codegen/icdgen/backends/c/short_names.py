"""Shorter names for identifiers of C that compilers may confuse.

C99 guarantees that compilers distinguish the first 63 characters of a name (5.2.4.1).
Names with the same 63 characters are shortened and end with a digest of the long name.
Other names, and other languages, keep the long names.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from hashlib import sha256
from pathlib import PurePosixPath

from icdgen.backends import Identifier

SIGNIFICANT = 63
_DIGITS = 8
_LONG = re.compile(rf"\b[A-Za-z_]\w{{{SIGNIFICANT - 1},}}")
# File names are not identifiers.
_LONG_OR_INCLUDE = re.compile(rf"#include[^\n]*|{_LONG.pattern}")


def short_names(identifiers: Iterable[Identifier]) -> dict[str, str]:
    """Return shorter names for all identifiers that are not unique in their first 63
    characters.
    """
    alike: defaultdict[str, set[str]] = defaultdict(set)
    for identifier in identifiers:
        if len(identifier.text) >= SIGNIFICANT and _LONG.fullmatch(identifier.text):
            alike[identifier.text[:SIGNIFICANT]].add(identifier.text)
    ambiguous = (texts for texts in alike.values() if len(texts) > 1)
    return {text: _short_name(text) for texts in ambiguous for text in texts}


def _short_name(text: str) -> str:
    digest = sha256(text.encode()).hexdigest()[:_DIGITS]
    begin = text[: SIGNIFICANT - _DIGITS - 1].rstrip("_")
    return f"{begin}_{digest.upper() if text.isupper() else digest}"


def with_short_names(
    files: Iterable[tuple[PurePosixPath, str]], identifiers: Iterable[Identifier]
) -> Iterator[tuple[PurePosixPath, str]]:
    """List C files with shorter names.

    ``identifiers`` are all names that the headers declare.
    """
    short = short_names(identifiers)
    for path, text in files:
        # Few ICDs have such names, and the search takes longer than the text of a file.
        if short:
            text = _LONG_OR_INCLUDE.sub(
                lambda match: short.get(match[0], match[0]), text
            )
        yield path, text
