"""What stands around a table: its caption, the prose above it and the headings over that name and number the message."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from icdgen.importer.profile import Profile
from icdgen.importer.words import folded, growing_length, plain

LONGEST = 110  # of a line that is taken for a name: longer ones are sentences
_NUMBER = re.compile(r"0[xX][0-9A-Fa-f]+|[0-9A-Fa-f]+[hH]\b|[0-9]+")


@dataclass(slots=True)
class Around:
    """Texts around a table, the nearest first. ``headings`` are those of the sections, the innermost first."""

    caption: str = ""
    prose: list[str] = field(default_factory=list)  # between the last table or heading and this one
    headings: list[str] = field(default_factory=list)

    @property
    def texts(self) -> list[str]:
        return [text for text in (self.caption, *self.prose, *self.headings[:1]) if text]


@dataclass(slots=True)
class Said:
    """What the patterns of a profile find around a table; ``ids`` are the numbers of an id as printed."""

    name: str = ""
    ids: tuple[str, ...] = ()
    kind: str = ""
    length: str = ""

    @property
    def id(self) -> int | None:
        """The id as one number: the parts in the order in which they are sent, a byte each."""
        numbers = [value(text) for text in self.ids]
        if len(numbers) == 1:
            return numbers[0]
        return int.from_bytes(numbers, "big") if numbers and max(numbers) < 256 else None


def value(text: str) -> int:
    """The number that ``21h``, ``0x21`` or ``33`` is."""
    if text[-1] in "hH":
        return int(text[:-1], 16)
    return int(text, 16) if text[:2].casefold() == "0x" else int(text)


def read(around: Around, profile: Profile) -> Said:
    """Name, id, kind and length; for each the first pattern that finds it in the nearest text."""
    made = Said()
    for text in around.texts:
        for pattern in profile.patterns:
            named = "name" in pattern.groupindex
            if named and len(text) > LONGEST:
                continue
            match = pattern.fullmatch(plain(text)) if named else pattern.search(plain(text))
            if match is None:
                continue
            groups = match.groupdict()
            takes = not made.ids and bool(groups.get("id"))
            if takes:
                made.ids = tuple(_NUMBER.findall(groups["id"]))
            if takes or "id" not in groups:
                made.name = made.name or (groups.get("name") or "").strip(" -–—:,.")
            made.kind = made.kind or kind_of(groups.get("kind") or "", profile)
            made.length = made.length or (groups.get("length") or "")
        if made.ids and made.length and made.kind:
            break
    made.length = made.length or next((figure for text in around.texts if (figure := growing_length(text))), "")
    if not made.name:
        made.name = next((text for text in (*around.prose, *around.headings[:1]) if _is_title(text)), "")
    made.kind = made.kind or next(
        (kind for text in around.texts if len(text) < LONGEST and (kind := kind_of(text, profile))), ""
    )
    return made


def _is_title(text: str) -> bool:
    return bool(text) and len(text) < 60 and not any(c.isdigit() for c in text) and text.rstrip()[-1] not in ".:;,"


def kind_of(text: str, profile: Profile) -> str:
    """The kind of message for which the text has a word of the profile's; "" if it has none."""
    words = folded(text)
    for kind, phrases in profile.data["kinds"].items():
        for phrase in phrases:
            parts = folded(phrase)
            if any(words[i : i + len(parts)] == parts for i in range(len(words))):
                return str(kind)
    return ""
