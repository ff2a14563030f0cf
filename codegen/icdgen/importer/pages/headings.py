"""Recognition of heading rows and their columns with the vocabulary of the profile.

The texts of cells or words go in. A `HeadingRow` with the kind of the table and the
role of each column comes out if they are headings.
"""

from __future__ import annotations

from itertools import pairwise

from icdgen.frozen import NamedTuple
from icdgen.importer.pages.draft import HeadingRow
from icdgen.importer.profile import Profile
from icdgen.importer.words import folded, printed_integer


class HeadingSegment(NamedTuple):
    """Consecutive words of a line, and whether they are a known heading."""

    words: list[int]  # indices
    is_known: bool


def match_headings(
    cells: list[str], profile: Profile, loose: bool = False
) -> HeadingRow | None:
    """Return the heading row that these cells form, or None.

    ``loose``: fields may have no column of offsets.
    """
    texts = [folded(cell) for cell in cells]
    # A row with a number is a row of values.
    if sum(bool(text) for text in texts) < 2 or any(
        printed_integer(cell) is not None for cell in cells
    ):
        return None
    best, most = None, 0.0
    for kind, roles in profile.headings.items():
        given = _roles(texts, roles)
        # In `Byte | Meaning`, the meaning is the name.
        if kind == "fields" and "at_bytes" in given and "name" not in given:
            given = ["name" if role == "description" else role for role in given]
        given_roles = set(given)
        if not all(
            any(role in given_roles for role in group) for group in profile.needs[kind]
        ):
            continue
        unknown = sum(
            1 for text, role in zip(texts, given, strict=True)
            if text and not role and profile.labels.get(tuple(sorted(text))) != "fields"
        )  # fmt: skip
        header = HeadingRow(kind, given, cells)
        has_offsets = kind != "fields" or header.has_offsets
        if not has_offsets and not loose:
            continue
        score = header.known - 0.6 * unknown
        # Prefer another kind of table that matches as well.
        score -= 0 if has_offsets else 0.7
        if header.known > unknown and score > most:
            best, most = header, score
    return best


def _roles(
    texts: list[tuple[str, ...]], roles: dict[str, list[tuple[str, ...]]]
) -> list[str]:
    """Return the role of each cell.

    A role is assigned once, to the cell whose heading is first in the vocabulary.
    """
    given = [""] * len(texts)
    for role, headings in roles.items():
        matches = [
            index
            for index, text in enumerate(texts)
            if text and not given[index] and text in headings
        ]
        if matches:
            given[matches[0]] = role
    return given


def segmented(words: list[str], profile: Profile) -> list[HeadingSegment] | None:
    """Return the headings that the words form regardless of gaps, or None.

    A word that belongs to no known heading is a segment of its own.
    """
    best: tuple[int, list[HeadingSegment]] = (0, [])
    flat = [folded(word) for word in words]
    for kind, titles in profile.known_headings.items():
        segments: list[HeadingSegment] = []
        index, hits = 0, 0
        while index < len(words):
            # The longest heading first, as one heading can begin with another.
            for length in range(min(5, len(words) - index), 0, -1):
                chunk = tuple(
                    part for text in flat[index : index + length] for part in text
                )
                if chunk in titles:
                    segments.append(
                        HeadingSegment(list(range(index, index + length)), True)
                    )
                    index, hits = index + length, hits + 1
                    break
            else:
                segments.append(HeadingSegment([index], False))
                index += 1
        header = match_headings(
            [" ".join(words[i] for i in segment.words) for segment in segments],
            profile,
            loose=True,
        )
        if header is not None and header.kind == kind and hits > best[0]:
            best = (hits, segments)
    return best[1] or None


def repeats_headings(cells: list[str], header: HeadingRow, profile: Profile) -> bool:
    """Return whether the cells repeat the headings, or some of them, as on a new page."""
    given = [tuple(folded(cell)) for cell in cells if cell.strip()]
    titles = [folded(title) for title in header.titles if title.strip()]
    if not given or any(printed_integer(cell) is not None for cell in cells):
        return False
    if given == titles or (all(text in titles for text in given) and len(given) >= 2):
        return True
    if len(given) >= 2 and _is_lower_half(given, titles):
        return True
    repeated = match_headings(cells, profile, loose=True)
    return (
        repeated is not None
        and repeated.kind == header.kind
        and [r for r in repeated.roles if r] == [r for r in header.roles if r]
    )


def _is_lower_half(given: list[tuple[str, ...]], titles: list[tuple[str, ...]]) -> bool:
    """Return whether the cells are the second line of headings, such as ``(bits) (bits)
    Type``.
    """
    ends = [title[1:] for title in titles if len(title) > 1]
    places = []
    for text in given:
        matches = [i for i, end in enumerate(ends) if end == text and i not in places]
        if not matches:
            return False
        places.append(matches[0])
    return all(a < b for a, b in pairwise(places))
