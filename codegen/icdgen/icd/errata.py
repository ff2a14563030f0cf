"""Errata overlays: decisions about faults of the manual, which change the tree of an
ICD before the model is built.

`apply` changes the tree of an ICD and returns `AppliedErrata`: the errata for the
objects of the model, the findings that they accept, and findings about the overlay
itself (ICD080 to ICD083).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from icdgen.diagnostics import Finding, Fix, Place
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, Seq, unread, yaml_text
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings

_COMPARE_AGAIN = "compare with the manual: update the ICD if it does not have the printed value, or else update or remove the entry"
_MOST_LISTED = 6  # lines of places in a help
STALE, NOWHERE, DOUBLE_ID, OTHER_NODE = "ICD080", "ICD081", "ICD082", "ICD083"


class AppliedErrata:
    """Result of applying an overlay to the tree of an ICD."""

    def __init__(self) -> None:
        self.entries: list[Erratum] = []
        self.notes: list[Erratum] = []
        # id() of a mapping -> its entries and notes
        self.by_mapping: dict[int, list[Erratum]] = {}
        # Accepted code, its place in the overlay, and the mapping.
        self.accepts: list[tuple[str, Place, Map]] = []
        self.findings: list[Finding] = []

    def about(self, item: object) -> tuple[Erratum, ...]:
        """Return the entries, then the notes, about the object that was read from a
        mapping.
        """
        errata = self.by_mapping.get(id(item))
        return (
            tuple(sorted(errata, key=lambda erratum: erratum.is_note)) if errata else ()
        )


def apply(
    tree: Map, overlay: Map | None, broken: Set[int] = frozenset()
) -> AppliedErrata:
    """Apply an overlay to ``tree``, in place.

    Entries without a matching place are findings.

    Entries that violate the schema are ignored; ``broken`` has the id() of such
    mappings.
    """
    applied = AppliedErrata()
    if overlay is None:
        return applied
    name = (tree.get("node") or {}).get("name")
    if overlay.get("node") != name:
        message = f"this overlay is for node `{overlay.get('node')}`, but lies beside `{name}`"
        help = "rename the file after its node, or correct `node:`"
        applied.findings.append(Finding(OTHER_NODE, message, overlay.at("node"), help))
        return applied
    seen: dict[str, Place] = {}
    named = _NameIndex()
    # Notes come first, because they are about the values that the manual prints, before
    # entries change them.
    notes = mappings(overlay.get("notes"))
    for entry in (*notes, *mappings(overlay.get("entries"))):
        if broken and _is_broken(entry, broken):
            continue
        if entry["id"] in seen:
            message = f"the id `{entry['id']}` is used twice, first in line {seen[entry['id']].line}"
            applied.findings.append(
                Finding(
                    DOUBLE_ID,
                    message,
                    entry.at("id"),
                    "give this entry an id of its own",
                )
            )
        seen.setdefault(entry["id"], entry.at("id"))
        _apply_entry(tree, entry, applied, named)
    return applied


def _apply_entry(
    tree: Map, entry: Map, applied: AppliedErrata, named: _NameIndex
) -> None:
    """Apply an entry or a note to all places that its `where` names, and add findings
    about stale or unknown places.
    """
    printed: Map = entry.get("printed") or unread()
    changes: Map = entry.get("held") or unread()
    erratum = _erratum(entry)
    (applied.notes if erratum.is_note else applied.entries).append(erratum)
    where = entry.get("where")
    if isinstance(where, Seq):
        selectors = list(where)
    else:
        selectors = [where] if where else []
    matched: list[Map] = []
    wildcard = False
    for selector in selectors:
        targets = list(_targets(tree, selector, named))
        is_wildcard = "*" in (selector.get("message"), selector.get("field"))
        wildcard |= is_wildcard
        if is_wildcard:
            targets = [target for target in targets if _matches(target, printed)]
        if not targets and not is_wildcard:
            applied.findings.append(_nowhere(tree, selector, named))
        for target in targets:
            if not _matches(target, printed):
                applied.findings.append(_stale(entry, target, printed))
                continue
            matched.append(target)
            _change(target, changes)
            # The index has the old names and lists.
            if any(
                key == "name" or isinstance(value, Seq)
                for key, value in changes.items()
            ):
                named.forget()
            applied.by_mapping.setdefault(id(target), []).append(erratum)
            for code, place in entry["accept"].placed() if "accept" in entry else ():
                applied.accepts.append((code, place, target))
    # With a wildcard, the number of places must be stated: a new message could match
    # without being meant.
    expected = entry.get("places")
    if wildcard and len(matched) != expected:
        message = f"`printed` matches {len(matched)} places" + (
            f", not {expected}" if expected else ""
        )
        help = _COMPARE_AGAIN
        if matched:
            lines = ", ".join(
                str(place.line) for place in map(_place, matched[:_MOST_LISTED])
            )
            more = ", ..." if len(matched) > _MOST_LISTED else ""
            help = f"check lines {lines}{more} of {_place(matched[0]).file}, then write `places: {len(matched)}`"
        applied.findings.append(
            Finding(STALE, message, entry.at("places" if expected else "where"), help)
        )


def _place(target: Map) -> Place:
    """Return the place of the first value of a mapping."""
    return target.at(next(iter(target)))


def _is_broken(value: object, broken: Set[int]) -> bool:
    """Return whether a mapping at any depth of a value violates the schema."""
    if isinstance(value, Map):
        return id(value) in broken or any(
            _is_broken(item, broken) for item in value.values()
        )
    return isinstance(value, Seq) and any(_is_broken(item, broken) for item in value)


def _erratum(entry: Map) -> Erratum:
    """Return the object of the model for an entry (with `why`) or a note (with `what`)."""
    return Erratum(
        id=entry["id"],
        title=str(entry.get("title", "")),
        why=str(entry.get("what" if "what" in entry else "why", "")),
        evidence=str(entry.get("evidence", "")),
        confidence=str(entry.get("confidence", "")),
        tables=tuple(
            table for table in entry.get("tables") or () if isinstance(table, int)
        ),
        printed=tuple((entry.get("printed") or {}).items()),
        held=tuple((entry.get("held") or {}).items()),
        changes=bool(entry.get("held")),
        is_note="what" in entry,
        source=entry,
    )


def _targets(tree: Map, where: Map, named: _NameIndex) -> Iterator[Map]:
    """Yield the mappings of the tree that a `where` names."""
    if "section" in where:
        yield from section(tree, str(where["section"]))
    elif "enum" in where:
        for enum in named.mappings_named(tree, "enums", where["enum"]):
            if "member" not in where:
                yield enum
            else:
                members = mappings(enum.get("members"))
                yield from (
                    member
                    for member in members
                    if member.get("value") == where["member"]
                )
    elif "loggable" in where:
        yield from (
            row
            for row in mappings(tree.get("loggable"))
            if row.get("bit") == where["loggable"]
        )
    elif "message" in where or "struct" in where:
        names = where.get("fields") or ([where["field"]] if "field" in where else None)
        kind = "message" if "message" in where else "struct"
        for owner in named.mappings_named(tree, f"{kind}s", where[kind]):
            if names is None:
                yield owner
            else:
                yield from (
                    field
                    for name in names
                    for field in named.mappings_named(owner, "fields", name)
                )


class _NameIndex:
    """Index of lists in an ICD by name.

    Without it, each entry would search the complete list again.
    """

    def __init__(self) -> None:
        self._rows: dict[tuple[int, str], dict[str, list[Map]]] = {}

    def mappings_named(self, owner: Map, key: str, name: str) -> Iterable[Map]:
        """Return the mappings of a name in the list of a key; all mappings for the name
        ``*``.
        """
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
        """Discard the index, after a change of a name or of a list."""
        self._rows.clear()


def section(tree: Map, path: str) -> Iterator[Map]:
    """Yield the mapping at a path of keys and list indices, such as ``protocol.link``,
    if it exists.
    """
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
    """Return whether a mapping has the values that the manual prints."""
    return all(_same(target.get(key), value) for key, value in printed.items())


def _same(first: object, second: object) -> bool:
    """Return whether two values are equal and of the same kind: in Python, True == 1."""
    return first == second and isinstance(first, bool) == isinstance(second, bool)


def _change(target: Map, changes: Map) -> None:
    """Set the changed values of a mapping; a value of null removes the key."""
    for key, value in changes.items():
        if value is None:
            target.pop(key, None)
        else:
            target[key] = value
            # Findings about the value point to the overlay, findings about the key to
            # the ICD.
            key_spot = target.spots[key][0] if key in target.spots else target.spot
            target.spots[key] = key_spot, changes.spots[key][1]


def _stale(entry: Map, target: Map, printed: Map) -> Finding:
    """Return the finding for an entry whose `printed` differs from the ICD."""
    key, value = next(
        (key, value)
        for key, value in printed.items()
        if not _same(target.get(key), value)
    )
    stale = f"stale {_erratum(entry).label.lower()} {entry['id']}: it was written for `{key}: {yaml_text(value)}`"
    now = f"the ICD now has `{key}: {yaml_text(target.get(key))}` ({target.at(key)})"
    return Finding(STALE, f"{stale}, {now}", printed.at(key), _COMPARE_AGAIN)


def _nowhere(tree: Map, where: Map, named: _NameIndex) -> Finding:
    """Return the finding for a `where` that names no place of the ICD, with a similar
    name as fix.
    """
    target, names, key = "", [], ""
    if "section" in where:
        target = f"section `{where['section']}`"
    elif "enum" in where:
        target = f"enumeration `{where['enum']}`" + (
            f" with value {where['member']}" if "member" in where else ""
        )
        enum_names = [enum.get("name") for enum in mappings(tree.get("enums"))]
        names, key = [] if where["enum"] in enum_names else enum_names, "enum"
    elif "loggable" in where:
        target = f"loggable bit {where['loggable']}"
    elif "message" in where or "struct" in where:
        kind = key = "message" if "message" in where else "struct"
        target = f"{kind} `{where[kind]}`"
        names = [owner.get("name") for owner in mappings(tree.get(f"{kind}s"))]
        owners = list(named.mappings_named(tree, f"{kind}s", where[kind]))
        if owners:
            target = f"field `{where.get('field') or where.get('fields')}` in {target}"
            names, key = [], "field"
            for owner in owners:
                names += (field.get("name") for field in mappings(owner.get("fields")))
    candidates = (name for name in names if isinstance(name, str))
    help, fix = suggestion(
        str(where.get(key, "")), candidates, "names are the manual's, to the letter"
    )
    return Finding(
        NOWHERE,
        f"there is no {target}",
        where.place,
        help,
        fix=Fix(where.at(key), fix) if fix else None,
    )
