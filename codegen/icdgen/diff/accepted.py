"""``.icdgen-accepted.yaml``: changes that someone accepted, each with a reason, so that they do not fail again."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.diff.change import Change
from icdgen.diff.compare import RULES
from icdgen.diff.where import Where
from icdgen.icd import schema, source
from icdgen.icd.located import Map
from icdgen.icd.rules.wording import quote
from icdgen.suggest import close_to

NAME = ".icdgen-accepted.yaml"
STALE = "DIF901"
_VALUES = ("was", "now")


class Acceptance(NamedTuple):
    """One entry. ``where``, ``was`` and ``now`` hold only what the entry says."""

    code: str
    where: dict[str, str]
    values: dict[str, str]
    reason: str
    place: Place

    def covers(self, change: Change) -> bool:
        """Whether the entry is about this change."""
        return (
            self.code == change.code
            and all(getattr(change.where, key) == value for key, value in self.where.items())
            and all(getattr(change, key) == value for key, value in self.values.items())
        )


Accepted = tuple[Change, Acceptance]


def find(start: Path) -> Path | None:
    """The file in the nearest folder upwards that has one, within the repository."""
    for folder in (start, *start.parents):
        if os.path.isfile(folder / NAME):
            return folder / NAME
        if os.path.exists(folder / ".git"):
            break
    return None


def read(path: Path, name: str) -> tuple[list[Acceptance], str]:
    """The entries, and the text of the file for excerpts. Raises `Findings`."""
    data = source.contents(path, name)
    tree = source.parse(data, name)
    findings, _ = schema.check(tree, "accepted")
    entries = [_entry(item) for item in tree.get("changes") or () if isinstance(item, Map)] if not findings else []
    findings += [_unknown(entry) for entry in entries if entry.code not in RULES]
    if findings:
        raise Findings(findings)
    return entries, data.decode("utf-8", "replace")


def _entry(item: Map) -> Acceptance:
    where = {key: str(item[key]) for key in Where._fields if key in item}
    values = {key: str(item[key]) for key in _VALUES if key in item}
    return Acceptance(item["code"].upper(), where, values, item["reason"], item.at("code"))


def _unknown(entry: Acceptance) -> Finding:
    close = close_to(entry.code, RULES)
    help = f"did you mean {close}?" if close else "`icdgen rule` lists them all"
    return Finding("ICD010", f"there is no rule {quote(entry.code)}", entry.place, help)


def sort(
    changes: Iterable[Change], entries: Sequence[Acceptance]
) -> tuple[list[Change], list[Accepted], list[Acceptance]]:
    """The changes that nobody accepted, the others with the first entry that covers each, and the entries that cover nothing."""
    open_: list[Change] = []
    accepted: list[Accepted] = []
    used: set[int] = set()
    for change in changes:
        covering = [entry for entry in entries if entry.covers(change)]
        used.update(map(id, covering))
        if covering:
            accepted.append((change, covering[0]))
        else:
            open_.append(change)
    return open_, accepted, [entry for entry in entries if id(entry) not in used]


def about_stale(entry: Acceptance) -> Finding:
    """What is said of an entry that no longer applies."""
    where = ", ".join(f"{key} {quote(value)}" for key, value in (entry.where | entry.values).items())
    text = f"this accepted change does not happen: {entry.code} at {where}"
    return Finding(STALE, text, entry.place, "take the entry out, or correct it", "warning")
