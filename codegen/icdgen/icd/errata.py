"""Errata overlays: decisions about the manual's faults, laid over the vendor's data before the model is built, and notes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from icdgen.diagnostics import Finding, Fix, Place
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings

_AGAIN = "look at the manual again, then update or remove the entry"
_MOST_LISTED = 6  # lines of places in a help
STALE, NOWHERE, DOUBLE_ID, OTHER_NODE = "ICD080", "ICD081", "ICD082", "ICD083"


class Applied:
    """The outcome of laying an overlay over a node's tree."""

    def __init__(self) -> None:
        self.entries: list[Erratum] = []
        self.notes: list[Erratum] = []
        self.of: dict[int, list[Erratum]] = {}  # id(mapping) -> entries that concern it
        self.accepts: list[tuple[str, Place, Map]] = []  # code, where it says so, and the mapping that it concerns
        self.findings: list[Finding] = []

    def about(self, item: object) -> tuple[Erratum, ...]:
        """The entries, then the notes, that concern the object read from this mapping."""
        found = self.of.get(id(item))
        return tuple(sorted(found, key=lambda erratum: erratum.is_note)) if found else ()


def apply(tree: Map, overlay: Map | None, broken: Set[int] = frozenset()) -> Applied:
    """Changes ``tree`` in place. Every entry that fits nowhere or no longer matches is a finding.

    Entries that violate the schema (``broken`` holds the ids of such mappings) are passed over.
    """
    applied = Applied()
    if overlay is None:
        return applied
    name = (tree.get("node") or {}).get("name")
    if overlay.get("node") != name:
        message = f"this overlay is for node `{overlay.get('node')}`, but lies beside `{name}`"
        help = "rename the file after its node, or correct `node:`"
        applied.findings.append(Finding(OTHER_NODE, message, overlay.at("node"), help))
        return applied
    seen: dict[str, Place] = {}
    named = _ByName()
    notes = mappings(overlay.get("notes"))  # first: what they speak of is what the vendor prints
    for entry in (*notes, *mappings(overlay.get("entries"))):
        if broken and _is_broken(entry, broken):
            continue
        if entry["id"] in seen:
            message = f"the id `{entry['id']}` is used twice, first in line {seen[entry['id']].line}"
            applied.findings.append(Finding(DOUBLE_ID, message, entry.at("id"), "give this entry an id of its own"))
        seen[entry["id"]] = entry.at("id")
        _apply_entry(tree, entry, applied, named)
    return applied


def _apply_entry(tree: Map, entry: Map, applied: Applied, named: _ByName) -> None:
    printed: Map = entry.get("printed") or unread()
    held: Map = entry.get("held") or unread()
    erratum = _erratum(entry)
    (applied.notes if erratum.is_note else applied.entries).append(erratum)
    where = entry.get("where")
    wheres = where if isinstance(where, Seq) else [where] if where else []
    matched: list[Map] = []
    wildcard = False
    for one in wheres:
        targets = list(_targets(tree, one, named))
        wild = "*" in (one.get("message"), one.get("field"))
        wildcard |= wild
        if wild:
            targets = [t for t in targets if _matches(t, printed)]
        if not targets and not wild:
            applied.findings.append(_nowhere(tree, one, named))
        for target in targets:
            if not _matches(target, printed):
                applied.findings.append(_stale(entry, target, printed))
                continue
            matched.append(target)
            _change(target, held, entry)
            if any(key == "name" or isinstance(value, Seq) for key, value in held.items()):
                named.forget()
            applied.of.setdefault(id(target), []).append(erratum)
            for code, place in entry["accept"].placed() if "accept" in entry else ():
                applied.accepts.append((code, place, target))
    expected = entry.get("places")
    if wildcard and len(matched) != expected:
        message = f"`printed` matches {len(matched)} places" + (f", not {expected}" if expected else "")
        help = _AGAIN
        if matched:
            lines = ", ".join(str(place.line) for place in map(_place, matched[:_MOST_LISTED]))
            more = ", ..." if len(matched) > _MOST_LISTED else ""
            help = f"check lines {lines}{more} of {_place(matched[0]).file}, then write `places: {len(matched)}`"
        applied.findings.append(Finding(STALE, message, entry.at("places" if expected else "where"), help))


def _place(target: Map) -> Place:
    """Where something of an ICD begins."""
    return target.at(next(iter(target)))


def _is_broken(value: object, broken: Set[int]) -> bool:
    if isinstance(value, Map):
        return id(value) in broken or any(_is_broken(item, broken) for item in value.values())
    return isinstance(value, Seq) and any(_is_broken(item, broken) for item in value)


def _erratum(entry: Map) -> Erratum:
    return Erratum(
        id=entry["id"],
        title=str(entry.get("title", "")),
        why=str(entry.get("what" if "what" in entry else "why", "")),
        evidence=str(entry.get("evidence", "")),
        confidence=str(entry.get("confidence", "")),
        tables=tuple(t for t in entry.get("tables") or () if isinstance(t, int)),
        printed=tuple((entry.get("printed") or {}).items()),
        held=tuple((entry.get("held") or {}).items()),
        changes=bool(entry.get("held")),
        is_note="what" in entry,
        source=entry,
    )


def _targets(tree: Map, where: Map, named: _ByName) -> Iterator[Map]:
    if "section" in where:
        yield from section(tree, str(where["section"]))
    elif "enum" in where:
        for enum in named.of(tree, "enums", where["enum"]):
            if "member" not in where:
                yield enum
            else:
                yield from (m for m in mappings(enum.get("members")) if m.get("value") == where["member"])
    elif "loggable" in where:
        yield from (row for row in mappings(tree.get("loggable")) if row.get("bit") == where["loggable"])
    elif "message" in where or "struct" in where:
        names = where.get("fields") or ([where["field"]] if "field" in where else None)
        what = "message" if "message" in where else "struct"
        for message in named.of(tree, f"{what}s", where[what]):
            if names is None:
                yield message
            else:
                yield from (f for name in names for f in named.of(message, "fields", name))


class _ByName:
    """Finds what an ICD lists by its name, without looking through the whole list again for each entry."""

    def __init__(self) -> None:
        self._rows: dict[tuple[int, str], dict[str, list[Map]]] = {}

    def of(self, owner: Map, key: str, name: str) -> Iterable[Map]:
        """What a key lists under the name; all of it under ``*``."""
        if name == "*":
            return mappings(owner.get(key))
        rows = self._rows.get((id(owner), key))
        if rows is None:
            rows = self._rows[id(owner), key] = {}
            for item in mappings(owner.get(key)):
                if isinstance(item.get("name"), str):
                    rows.setdefault(item["name"], []).append(item)
        return rows.get(name, ())

    def forget(self) -> None:
        """A name was changed, or a list."""
        self._rows.clear()


def section(tree: Map, path: str) -> Iterator[Map]:
    """The mapping at a path of keys, ``protocol.uart``, if there is one."""
    node: object = tree
    for step in path.split("."):
        if isinstance(node, Map) and step in node:
            node = node[step]
        elif isinstance(node, Seq) and step.isdecimal() and int(step) < len(node):
            node = node[int(step)]
        else:
            return
    if isinstance(node, Map):
        yield node


def _matches(target: Map, printed: Map) -> bool:
    return all(_same(target.get(key), value) for key, value in printed.items())


def _same(one: object, other: object) -> bool:
    """Whether both are equal, and neither or both a truth value: to Python, True is 1."""
    return one == other and isinstance(one, bool) == isinstance(other, bool)


def _change(target: Map, held: Map, entry: Map) -> None:
    for key, value in held.items():
        if value is None:
            target.pop(key, None)
        else:
            target[key] = value
            key_spot = target.spots[key][0] if key in target.spots else target.spot
            target.spots[key] = key_spot, held.spots[key][1]


def _stale(entry: Map, target: Map, printed: Map) -> Finding:
    key, value = next((key, value) for key, value in printed.items() if not _same(target.get(key), value))
    stale = f"stale {_erratum(entry).label.lower()} {entry['id']}: it was written for `{key}: {_show(value)}`"
    now = f"the ICD now has `{key}: {_show(target.get(key))}` ({target.at(key)})"
    return Finding(STALE, f"{stale}, {now}", printed.at(key), _AGAIN)


def _nowhere(tree: Map, where: Map, named: _ByName) -> Finding:
    wanted, known, key = "", [], ""
    if "section" in where:
        wanted = f"section `{where['section']}`"
    elif "enum" in where:
        wanted = f"enumeration `{where['enum']}`" + (f" with value {where['member']}" if "member" in where else "")
        names = [e.get("name") for e in mappings(tree.get("enums"))]
        known, key = [] if where["enum"] in names else names, "enum"
    elif "loggable" in where:
        wanted = f"loggable bit {where['loggable']}"
    elif "message" in where or "struct" in where:
        what = key = "message" if "message" in where else "struct"
        wanted = f"{what} `{where[what]}`"
        known = [m.get("name") for m in mappings(tree.get(f"{what}s"))]
        messages = list(named.of(tree, f"{what}s", where[what]))
        if messages:
            wanted = f"field `{where.get('field') or where.get('fields')}` in {wanted}"
            known, key = [f.get("name") for m in messages for f in mappings(m.get("fields"))], "field"
    candidates = (name for name in known if isinstance(name, str))
    help, fix = suggestion(str(where.get(key, "")), candidates, "names are the manual's, to the letter")
    return Finding(NOWHERE, f"there is no {wanted}", where.place, help, fix=Fix(where.at(key), fix) if fix else None)


def _show(value: object) -> str:
    if value is None:
        return "(absent)"
    return str(value).lower() if isinstance(value, bool) else str(value)
