"""Reader of ``.icdgen-accepted.yaml``: changes that the user accepted, with reasons.

Accepted changes no longer make `icdgen diff` fail. `sort_changes` separates them from
the other changes and returns the entries that match no change any more.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.diff.change import Change
from icdgen.diff.compare import RULES
from icdgen.diff.where import Where
from icdgen.frozen import NamedTuple
from icdgen.icd import schema, source
from icdgen.icd.located import Map
from icdgen.suggest import close_to
from icdgen.wording import quote

NAME = ".icdgen-accepted.yaml"
STALE = "DIF901"


class Acceptance(NamedTuple):
    """Entry of the file.

    ``criteria`` are the attributes that a change must have in addition to the code:
    location, old value (``was``) and new value (``now``).
    """

    code: str
    criteria: dict[str, str]
    reason: str
    place: Place

    def covers(self, change: Change) -> bool:
        """Whether the entry accepts this change."""
        # An entry needs only the attributes that identify the change.
        attributes = {**change.where._asdict(), "was": change.was, "now": change.now}
        return self.code == change.code and all(
            attributes[key] == value for key, value in self.criteria.items()
        )


Accepted = tuple[Change, Acceptance]


def find_file(start: Path) -> Path | None:
    """Return the file in the nearest parent folder that contains one, within the
    repository; None without such a file.
    """
    # Like icdgen.toml, the file applies to the folders below it.
    for folder in (start, *start.parents):
        if os.path.isfile(folder / NAME):
            return folder / NAME
        if os.path.exists(folder / ".git"):
            break
    return None


def read_file(path: Path, name: str) -> tuple[list[Acceptance], str]:
    """Return the entries, and the text of the file for excerpts.

    Raises `Findings`.
    """
    data = source.contents(path, name)
    tree = source.parse(data, name)
    findings, _ = schema.check(tree, "accepted")
    entries = (
        [_entry(item) for item in tree.get("changes") or () if isinstance(item, Map)]
        if not findings
        else []
    )
    findings += [_unknown(entry) for entry in entries if entry.code not in RULES]
    if findings:
        raise Findings(findings)
    return entries, data.decode("utf-8", "replace")


def _entry(item: Map) -> Acceptance:
    criteria = {
        key: str(item[key]) for key in (*Where._fields, "was", "now") if key in item
    }
    return Acceptance(item["code"].upper(), criteria, item["reason"], item.at("code"))


def _unknown(entry: Acceptance) -> Finding:
    close = close_to(entry.code, RULES)
    help = f"did you mean {close}?" if close else "`icdgen rule` lists them all"
    return Finding("ICD010", f"there is no rule {quote(entry.code)}", entry.place, help)


def sort_changes(
    changes: Iterable[Change], entries: Sequence[Acceptance]
) -> tuple[list[Change], list[Accepted], list[Acceptance]]:
    """Return the changes that are not accepted, the accepted ones with the first
    matching entry, and unused entries.
    """
    remaining: list[Change] = []
    accepted: list[Accepted] = []
    used: set[int] = set()
    for change in changes:
        matches = [entry for entry in entries if entry.covers(change)]
        used.update(id(entry) for entry in matches)
        if matches:
            accepted.append((change, matches[0]))
        else:
            remaining.append(change)
    return remaining, accepted, [entry for entry in entries if id(entry) not in used]


def about_stale(entry: Acceptance) -> Finding:
    """Return the finding about an entry that no longer matches any change."""
    where = ", ".join(f"{key} {quote(value)}" for key, value in entry.criteria.items())
    text = f"this accepted change does not happen: {entry.code} at {where}"
    return Finding(
        STALE, text, entry.place, "take the entry out, or correct it", "warning"
    )
