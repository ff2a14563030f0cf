"""Conversion of ICDs that were written before `protocol.link` took the place of
`stream`, `checksums` and `client` in the protocol section.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator

from icdgen.icd.fmt.commented import Branch, Child, Text
from icdgen.icd.fmt.scalars import name


def convert(root: Branch) -> bool:
    """Change the tree of an ICD to the present keys. Return whether there was something
    to change.
    """
    protocol = _entry(root, "protocol")
    if protocol is None or not isinstance(protocol.value, Branch):
        return False
    moved = {"client": "client"}
    if link := _entry(protocol.value, "stream"):
        link.key = _text("link")
        moved |= {"checksums": "checksums", "uart": "line"}
    elif not _entry(protocol.value, "client"):
        return False
    elif not (link := _entry(protocol.value, "link")):
        link = Child(_text("link"), Branch(True, False, 0))
        protocol.value.children.append(link)
    if not isinstance(link.value, Branch):
        return False
    for key, present_key in moved.items():
        entry = _entry(protocol.value, key)
        if entry:
            protocol.value.children.remove(entry)
            entry.key = _text(present_key)
            link.value.children.append(entry)
    framing = _entry(link.value, "delimited_by")
    if framing and isinstance(framing.value, Text):
        by = _text("datagram") if framing.value.value == "none" else framing.value
        framing.key = _text("framing")
        framing.value = Branch(True, True, 0, [Child(_text("by"), by)])
    _move_covers(link.value)
    return True


def _move_covers(link: Branch) -> None:
    """Move what each checksum covers to the fields that have none of their own."""
    checksums = _entry(link, "checksums")
    declared = {}
    for checksum in _entries(checksums.value) if checksums else ():
        covers = _entry(checksum.value, "covers")
        if covers:
            _entries(checksum.value).remove(covers)
            declared[name(checksum.key)] = covers
    for field in _branches(link):
        named = _entry(field, "checksum")
        if not named or not isinstance(named.value, Text) or _entry(field, "covers"):
            continue
        if covers := declared.get(named.value.spelling):
            field.children.append(copy.deepcopy(covers))
            covers.before, covers.trailing = [], []  # only the first gets the comments


def _text(word: str) -> Text:
    return Text(word, word)


def _entries(value: object) -> list[Child]:
    """Return the entries of a mapping; none of anything else."""
    return value.children if isinstance(value, Branch) and value.mapping else []


def _entry(value: object, key: str) -> Child | None:
    """Return the entry of a key; None without one."""
    return next((each for each in _entries(value) if name(each.key) == key), None)


def _branches(branch: Branch) -> Iterator[Branch]:
    """Yield a mapping or sequence and all that are in it."""
    yield branch
    for child in branch.children:
        if isinstance(child.value, Branch):
            yield from _branches(child.value)
