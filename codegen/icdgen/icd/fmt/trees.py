"""Access to the trees of the formatter by key, for conversions.

Look-ups take a `Branch` of `commented` or any other value. Without the key, or for
another kind of value, they return None or an empty list, because files are not checked
against the schema before a conversion. `part_of` and `move` change the tree; comments
stay with the entries that they move.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText
from icdgen.icd.fmt.scalars import name


def word(text: str) -> ScalarText:
    """Return a text as a scalar."""
    return ScalarText(text, text)


def number(value: int) -> ScalarText:
    """Return a number as a scalar."""
    return ScalarText(value, str(value))


def sequence(*items: ScalarText | Branch) -> Branch:
    """Return a sequence in brackets."""
    return Branch(False, True, 0, [Child(NOTHING, item) for item in items])


def entries_of(value: object) -> list[Child]:
    """Return the entries of a mapping; none of anything else."""
    return value.children if isinstance(value, Branch) and value.mapping else []


def entry_of(value: object, key: str) -> Child | None:
    """Return the entry of a key; None without one."""
    return next((each for each in entries_of(value) if name(each.key) == key), None)


def items_of(value: object) -> list[Child]:
    """Return the items of a sequence; none of anything else."""
    return value.children if isinstance(value, Branch) and not value.mapping else []


def item_named(value: object, wanted: object) -> object:
    """Return the item of a sequence with this value of the key `name`; None without one."""
    if not isinstance(wanted, ScalarText):
        return None
    for item in items_of(value):
        given = value_of(item.value, "name")
        if isinstance(given, ScalarText) and given.value == wanted.value:
            return item.value
    return None


def value_of(value: object, key: str) -> object:
    """Return the value of a key; None without one."""
    entry = entry_of(value, key)
    return entry.value if entry else None


def branches(branch: Branch) -> Iterator[Branch]:
    """Yield a mapping or sequence and all that are in it."""
    yield branch
    for child in branch.children:
        if isinstance(child.value, Branch):
            yield from branches(child.value)


def mapping(entries: Mapping[str, ScalarText | Branch], flow: bool = True) -> Branch:
    """Return a mapping, in braces if ``flow``."""
    children = [Child(word(key), value) for key, value in entries.items()]
    return Branch(True, flow, 0, children)


def part_of(section: Branch, key: str) -> Branch | None:
    """Return the mapping of a key, which is added if it is missing; None if the key has
    another value.
    """
    entry = entry_of(section, key)
    if entry is None:
        entry = Child(word(key), Branch(True, False, 0))
        section.children.append(entry)
    is_mapping = isinstance(entry.value, Branch) and entry.value.mapping
    return entry.value if is_mapping else None  # type: ignore[return-value]


def move(section: Branch, keys: Mapping[str, str], target: Branch) -> None:
    """Move entries to another mapping, under their present keys."""
    for key, present_key in keys.items():
        if entry := entry_of(section, key):
            section.children.remove(entry)
            entry.key = word(present_key)
            target.children.append(entry)
