"""Update of an existing ICD with a new import.

Facts of the vendor are replaced. Additions of users and comments are preserved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from icdgen.icd import source
from icdgen.icd.fmt import emit, read, scalars
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText

# Keys that users add to the facts of a manual.
_USER_KEYS = {
    "message": (
        "identifier",
        "summary",
        "acknowledge",
        "hazard",
        "contains",
        "assumptions",
        "shares_id",
    ),
    "field": (
        "identifier",
        "summary",
        "special",
        "min",
        "max",
        "above",
        "below",
        "bitfields",
    ),
    "struct": ("identifier", "summary"),
    "enumeration": ("identifier", "summary"),
    "member": ("identifier", "summary"),
    "loggable": (),
}
_SECTIONS = (
    ("enums", "enumeration"),
    ("structs", "struct"),
    ("messages", "message"),
    ("loggable", "loggable"),
)
_INNER = {
    "message": ("fields", "field"),
    "struct": ("fields", "field"),
    "enumeration": ("members", "member"),
}


@dataclass
class Updated:
    """The new text of a file, and its changes, one per line."""

    text: str
    changes: list[str] = field(default_factory=list)


def update(
    text: str, name: str, tree: dict[str, Any], given_keys: frozenset[str] = frozenset()
) -> Updated:
    """Update a text.

    ``given_keys`` are keys of users that the source gives and therefore replaces.

    Raise `Findings` if the old text is not valid YAML.
    """
    root = read.read_commented(
        text, source.parse(text.encode("utf-8", "surrogatepass"), name)
    )
    updated = Updated("")
    for key, kind in _SECTIONS:
        _update_section(root, key, kind, tree.get(key, []), updated.changes, given_keys)
    if "protocol" in tree:
        _replace_section(root, "protocol", tree["protocol"], updated.changes)
    _update_formula_for(root, tree.get("formula_for"), updated.changes)
    _add_missing(root, "units", "symbol", tree.get("units", []), updated.changes)
    _add_missing(root, "missing", "name", tree.get("missing", []), updated.changes)
    updated.text = emit.canonical_yaml_of_branch(root)
    return updated


def _update_formula_for(
    root: Branch, words: dict[str, Any] | None, changes: list[str]
) -> None:
    """Update ``formula_for``, the formulas that the manual states for a kind of
    messages.
    """
    old = _child(root, "formula_for")
    before = _plain(old.value) if old is not None else None
    if before == words:
        return
    changes.append(
        f"~ formula_for {_value_text(before) if before else '(absent)'} -> {_value_text(words) if words else '(absent)'}"
    )
    if old is not None:
        root.children.remove(old)
    if words:
        root.children.append(
            Child(ScalarText("formula_for", "formula_for"), emit.branch(words))
        )


def _replace_section(
    root: Branch, key: str, value: dict[str, Any], changes: list[str]
) -> None:
    """Replace a section that the source gives completely."""
    old = _child(root, key)
    if old is not None and _plain(old.value) == value:
        return
    changes.append(f"~ {key} is another" if old is not None else f"+ {key}")
    if old is None:
        root.children.append(Child(ScalarText(key, key), emit.branch(value)))
    else:
        old.value = emit.branch(value)


def _update_section(
    root: Branch,
    key: str,
    kind: str,
    items: list[dict[str, Any]],
    changes: list[str],
    given_keys: frozenset[str],
) -> None:
    """Update the items of a section."""
    old = _child(root, key)
    if not items and old is None:
        return
    if old is None:
        root.children.append(Child(ScalarText(key, key), emit.branch(items)))
        changes += [f"+ {kind} {_title(kind, item)}" for item in items]
        return
    if not isinstance(old.value, Branch):
        # An empty section, `messages:` without items.
        old.value = Branch(False, False, 0)
    old.value.children = _merge_items(
        old.value.children, items, kind, "", changes, given_keys
    )
    if not old.value.children:
        root.children.remove(old)


def _merge_items(
    old: list[Child],
    items: list[dict[str, Any]],
    kind: str,
    where: str,
    changes: list[str],
    given_keys: frozenset[str],
) -> list[Child]:
    """Return the items with the users' additions to the old ones.

    Old items keep their order. New items follow their predecessor.
    """
    pairs = _matches(old, items, kind)
    placed_items: list[tuple[int, Child]] = []
    # New items at the beginning have no predecessor.
    place = -1
    placed: dict[int, int] = {}
    for index, item in enumerate(items):
        before = pairs.get(index)
        if before is None:
            changes.append(f"+ {where}{kind} {_title(kind, item)}")
            placed_items.append((place, Child(NOTHING, emit.branch(item))))
            continue
        place = old.index(before)
        placed[index] = place
        placed_items.append(
            (place, _merge(before, item, kind, where, changes, given_keys))
        )
    matched_ids = {id(child) for child in pairs.values()}
    for child in old:
        if id(child) not in matched_ids:
            changes.append(f"- {where}{kind} {_title(kind, _plain(child.value))}")
    # The order of the new items is used if it does not contradict the order of the old
    # ones.
    is_ascending = all(a < b for a, b in pairwise(placed.values()))
    if not is_ascending:
        placed_items.sort(key=lambda placed_item: placed_item[0])
    return [child for _, child in placed_items]


def _merge(
    old: Child,
    item: dict[str, Any],
    kind: str,
    where: str,
    changes: list[str],
    given_keys: frozenset[str],
) -> Child:
    """Return an item with the vendor's keys from ``item``, and users' keys and comments
    of ``old``.
    """
    assert isinstance(old.value, Branch)
    title = _title(kind, item)
    inner = _INNER.get(kind)
    result = Branch(True, old.value.flow, old.value.column, tail=old.value.tail)
    before = {_name(child): child for child in old.value.children}
    for key, child in before.items():
        if key in _USER_KEYS[kind] or key in item:
            result.children.append(child)
        else:
            changes.append(
                f"~ {where}{kind} {title}: {key} {_value_text(_plain(child.value))} -> (absent)"
            )
    for key, value in item.items():
        child: Child | None = before.get(key)  # type: ignore[no-redef]
        if inner and key == inner[0]:
            before_lines = (
                child.value
                if child is not None and isinstance(child.value, Branch)
                else Branch(False, False, 0)
            )
            lines = _merge_items(
                before_lines.children,
                value,
                inner[1],
                f"{where}{kind} {title}: ",
                changes,
                given_keys,
            )
            if child is None:
                child = Child(ScalarText(key, key))
                result.children.append(child)
            child.value = Branch(False, False, 0, lines, tail=before_lines.tail)
        elif child is None:
            result.children.append(Child(ScalarText(key, key), emit.node(value)))
            # Neither is a fact of the device, so the list of changes omits them.
            if key not in ("source", "summary"):
                changes.append(
                    f"~ {where}{kind} {title}: {key} (absent) -> {_value_text(value)}"
                )
        elif key in _USER_KEYS[kind] and key not in given_keys:
            continue  # the user's value has precedence
        # The user can have added a page or a table to the place in the manual.
        elif key == "source":
            child.value = emit.branch({**_plain(child.value), **value})
        elif key == "also" and [s.get("table") for s in _plain(child.value)] == [
            s.get("table") for s in value
        ]:
            child.value = emit.branch(
                [{**a, **b} for a, b in zip(_plain(child.value), value, strict=True)]
            )
        elif _plain(child.value) != value:
            changes.append(
                f"~ {where}{kind} {title}: {key} {_value_text(_plain(child.value))} -> {_value_text(value)}"
            )
            child.value = emit.node(value)
    return Child(old.key, result, old.before, old.trailing)


def _matches(
    old: list[Child], items: list[dict[str, Any]], kind: str
) -> dict[int, Child]:
    """Return the old entry for the index of each new item that has one.

    Each old entry is used once, with the most certain match.
    """
    plain = [_plain(child.value) for child in old]
    free = {index for index, value in enumerate(plain) if isinstance(value, dict)}
    result: dict[int, Child] = {}
    for key_of in _MATCHES[kind]:
        unmatched: dict[object, list[int]] = {}
        for index in sorted(free):
            if (key := key_of(plain[index])) is not None:
                unmatched.setdefault(key, []).append(index)
        for index, item in enumerate(items):
            key = key_of(item)
            if index not in result and key is not None and unmatched.get(key):
                position = unmatched[key].pop(0)
                result[index] = old[position]
                free.discard(position)
    return result


def _ids(item: dict[str, Any]) -> object:
    # The kind is part of it: a telecommand and telemetry can share an id.
    ids = (item.get("kind"), item.get("id"), item.get("set_id"), item.get("get_id"))
    return ids if any(i is not None for i in ids[1:]) else None


# Keys by which an old item is found again, the most certain first: a message that was
# renamed keeps its id, a field that moved keeps its name.
_MATCHES: dict[str, list[Callable[[dict[str, Any]], object]]] = {
    "message": [lambda i: (i.get("name"), _ids(i)), lambda i: i.get("name"), _ids],
    "field": [
        lambda i: (i.get("name"), i.get("at")),
        lambda i: i.get("name"),
        lambda i: i.get("at"),
    ],
    "struct": [lambda i: i.get("name")],
    "enumeration": [
        lambda i: i.get("name"),
        lambda i: (i.get("source") or {}).get("table"),
    ],
    "member": [lambda i: (i.get("value"), i.get("name")), lambda i: i.get("value")],
    "loggable": [lambda i: i.get("bit")],
}


def _add_missing(
    root: Branch, key: str, by: str, items: list[dict[str, Any]], changes: list[str]
) -> None:
    """Add entries that are missing."""
    child = _child(root, key)
    children = child.value.children if child and isinstance(child.value, Branch) else []
    existing = {_plain(entry.value).get(by) for entry in children}
    new = [item for item in items if item[by] not in existing]
    if not new:
        return
    changes += [f"+ {key} {item[by]}" for item in new]
    if child is None:
        root.children.append(Child(ScalarText(key, key), emit.branch(new)))
    else:
        assert isinstance(child.value, Branch)
        child.value.children += emit.branch(new).children


def _child(branch: Branch, key: str) -> Child | None:
    return next((child for child in branch.children if _name(child) == key), None)


def _name(child: Child) -> str:
    return scalars.name(child.key) if child.key is not None else ""


def _plain(value: object) -> Any:
    if isinstance(value, Branch):
        if value.mapping:
            return {_name(child): _plain(child.value) for child in value.children}
        return [_plain(child.value) for child in value.children]
    return value.value if isinstance(value, ScalarText) else value


def _title(kind: str, item: dict[str, Any]) -> str:
    if kind == "loggable":
        return f"bit {item.get('bit')}"
    if kind == "member":
        return f"{item.get('value')} `{item.get('name')}`"
    ids = [str(item[key]) for key in ("id", "set_id", "get_id") if key in item]
    return f"`{item.get('name')}`" + (f" ({'/'.join(ids)})" if ids else "")


def _value_text(value: object) -> str:
    """Return a value for the list of changes."""
    if isinstance(value, (dict, list)):
        return "..." if len(str(value)) > 60 else str(value)
    return f"`{value}`"
