"""Errata overlays: decisions about the manual's faults, laid over the vendor's data before the model is built, and notes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from icdgen.diagnostics import Finding, Place
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, Seq, unread
from icdgen.suggest import close_to

_AGAIN = "look at the manual again, then update or remove the entry"
STALE, NOWHERE, DOUBLE_ID, OTHER_NODE = "ICD080", "ICD081", "ICD082", "ICD083"


class Applied:
    """The outcome of laying an overlay over a node's tree."""

    def __init__(self) -> None:
        self.entries: list[Erratum] = []
        self.notes: list[Erratum] = []
        self.of: dict[int, list[Erratum]] = {}  # id(mapping) -> entries that concern it
        self.accepts: list[tuple[str, Place, Map, str, Place]] = []  # code, file's place, mapping, erratum id, place
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
        applied.findings.append(
            Finding(OTHER_NODE, f"this overlay is for node `{overlay.get('node')}`, but lies beside `{name}`",
                    overlay.at("node"), "rename the file after its node, or correct `node:`")
        )  # fmt: skip
        return applied
    seen: dict[str, Place] = {}
    named = _ByName()
    notes = list(_maps(overlay.get("notes")))  # first: what they speak of is what the vendor prints
    for entry in (*notes, *_maps(overlay.get("entries"))):
        if broken and _is_broken(entry, broken):
            continue
        if entry["id"] in seen:
            applied.findings.append(
                Finding(DOUBLE_ID, f"the id `{entry['id']}` is used twice, first in line {seen[entry['id']].line}",
                        entry.at("id"), "give this entry an id of its own")
            )  # fmt: skip
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
    matched = 0
    wildcard = False
    for one in wheres:
        targets = list(_targets(tree, one, named))
        wild = "*" in (one.get("message"), one.get("field"))
        wildcard |= wild
        if wild:
            targets = [t for t in targets if _matches(t, printed)]
        if not targets and not wild:
            applied.findings.append(_nowhere(tree, one))
        for target in targets:
            if not wild and not _matches(target, printed):
                applied.findings.append(_stale(entry, target, printed))
                continue
            matched += 1
            _change(target, held, entry)
            if any(key == "name" or isinstance(value, Seq) for key, value in held.items()):
                named.forget()
            applied.of.setdefault(id(target), []).append(erratum)
            for code, place in entry["accept"].placed() if "accept" in entry else ():
                applied.accepts.append((code, place, target, erratum.id, target.place))
    if wildcard and matched != entry.get("places"):
        expected = entry.get("places")
        message = f"`printed` matches {matched} places" + (f", not {expected}" if expected is not None else "")
        applied.findings.append(
            Finding(STALE, message, entry.at("places" if expected is not None else "where"),
                    f"check the places, then write `places: {matched}`" if matched else _AGAIN)
        )  # fmt: skip


def _maps(items: object) -> Iterator[Map]:
    return (item for item in items if isinstance(item, Map)) if isinstance(items, list) else iter(())


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
                yield from (m for m in _maps(enum.get("members")) if m.get("value") == where["member"])
    elif "loggable" in where:
        yield from (row for row in _maps(tree.get("loggable")) if row.get("bit") == where["loggable"])
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

    def of(self, owner: Map, key: str, name: object) -> Iterable[Map]:
        if not isinstance(name, str) or name == "*":
            return _named(owner, key, name)
        rows = self._rows.get((id(owner), key))
        if rows is None:
            rows = self._rows[id(owner), key] = {}
            for item in _maps(owner.get(key)):
                if isinstance(item.get("name"), str):
                    rows.setdefault(item["name"], []).append(item)
        return rows.get(name, ())

    def forget(self) -> None:
        """A name was changed, or a list."""
        self._rows.clear()


def _named(owner: Map, key: str, name: object) -> Iterator[Map]:
    for item in _maps(owner.get(key)):
        if name == "*" or item.get("name") == name:
            yield item


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
    for key, value in printed.items():
        if not _same(target.get(key), value):
            now = target.get(key)
            place = target.at(key)
            message = (
                f"stale {_erratum(entry).label.lower()} {entry['id']}: it was written for `{key}: {_show(value)}`, "
                f"the ICD now has `{key}: {_show(now)}` ({place})"
            )
            return Finding(STALE, message, printed.at(key), _AGAIN)
    raise AssertionError("the target matches")


def _nowhere(tree: Map, where: Map) -> Finding:
    wanted, known = "", []
    if "section" in where:
        wanted = f"section `{where['section']}`"
    elif "enum" in where:
        wanted = f"enumeration `{where['enum']}`" + (f" with value {where['member']}" if "member" in where else "")
        known = [e.get("name") for e in _maps(tree.get("enums"))]
    elif "loggable" in where:
        wanted = f"loggable bit {where['loggable']}"
    elif "message" in where or "struct" in where:
        what = "message" if "message" in where else "struct"
        wanted = f"{what} `{where[what]}`"
        known = [m.get("name") for m in _maps(tree.get(f"{what}s"))]
        messages = list(_named(tree, f"{what}s", where[what]))
        if messages:
            wanted = f"field `{where.get('field') or where.get('fields')}` in {wanted}"
            known = [f.get("name") for m in messages for f in _maps(m.get("fields"))]
    target = str(where.get("field") or where.get("message") or where.get("struct") or where.get("enum") or "")
    close = close_to(target, (k for k in known if isinstance(k, str)))
    help = f"did you mean `{close}`?" if close else "names are the manual's, to the letter"
    return Finding(NOWHERE, f"there is no {wanted}", where.place, help)


def _show(value: object) -> str:
    if value is None:
        return "(absent)"
    return str(value).lower() if isinstance(value, bool) else str(value)
