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


class Acceptance(NamedTuple):
    """One entry. ``said`` has what it says of the change but for its code: where it is, what was and what is now."""

    code: str
    said: dict[str, str]
    reason: str
    place: Place

    def covers(self, change: Change) -> bool:
        """Whether the entry is about this change."""
        known = {**change.where._asdict(), "was": change.was, "now": change.now}
        return self.code == change.code and all(known[key] == value for key, value in self.said.items())


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
    said = {key: str(item[key]) for key in (*Where._fields, "was", "now") if key in item}
    return Acceptance(item["code"].upper(), said, item["reason"], item.at("code"))


def _unknown(entry: Acceptance) -> Finding:
    close = close_to(entry.code, RULES)
    help = f"did you mean {close}?" if close else "`icdgen rule` lists them all"
    return Finding("ICD010", f"there is no rule {quote(entry.code)}", entry.place, help)


def sort(
    changes: Iterable[Change], entries: Sequence[Acceptance]
) -> tuple[list[Change], list[Accepted], list[Acceptance]]:
    """The changes that nobody accepted, the others with the first entry that covers each, and the entries that cover nothing."""
    covered = [(change, [entry for entry in entries if entry.covers(change)]) for change in changes]
    used = {id(entry) for _, covering in covered for entry in covering}
    accepted = [(change, covering[0]) for change, covering in covered if covering]
    stale = [entry for entry in entries if id(entry) not in used]
    return [change for change, covering in covered if not covering], accepted, stale


def about_stale(entry: Acceptance) -> Finding:
    """What is said of an entry that no longer applies."""
    where = ", ".join(f"{key} {quote(value)}" for key, value in entry.said.items())
    text = f"this accepted change does not happen: {entry.code} at {where}"
    return Finding(STALE, text, entry.place, "take the entry out, or correct it", "warning")
