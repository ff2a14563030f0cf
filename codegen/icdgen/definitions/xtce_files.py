"""Grouping of XTCE files into databases: a file belongs to another if it refers to a
name that only that one defines.
"""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element

from icdgen.definitions import safe_xml

_REFERENCES = (
    "parameterTypeRef", "argumentTypeRef", "typeRef", "arrayTypeRef", "baseType", "parameterRef", "containerRef",
    "metaCommandRef",
)  # fmt: skip


# `Element.get(element, ...)` bypasses `AccountedElement.get`: grouping files does not
# import their attributes.


def sets(roots: Mapping[str, Element]) -> list[dict[str, Element]]:
    """Return the databases, each with its files in the order of ``roots``."""
    named = {file: _names(root) for file, root in roots.items()}
    # Union-find: a file leads to the first file of its set.
    owner = {file: file for file in roots}

    def first_of(file: str) -> str:
        while owner[file] != file:
            file = owner[file]
        return file

    for file, root in roots.items():
        for candidates in _references(root):
            if not candidates or candidates & named[file]:
                continue
            for other in roots:
                if other != file and candidates & named[other]:
                    ends = sorted(
                        (first_of(file), first_of(other)), key=list(roots).index
                    )
                    owner[ends[1]] = ends[0]
    result: dict[str, dict[str, Element]] = {}
    for file, root in roots.items():
        result.setdefault(first_of(file), {})[file] = root
    return list(result.values())


def _systems(root: Element) -> Iterator[tuple[str, Element]]:
    """Yield the path of each system, and the system."""
    left = [("", root)]
    while left:
        above, system = left.pop()
        path = f"{above}/{Element.get(system, 'name', '')}"
        yield path, system
        left += [
            (path, child)
            for child in system
            if safe_xml.local(child.tag) == "SpaceSystem"
        ]


def _names(root: Element) -> set[str]:
    """Return the paths of all named elements of a file."""
    return {
        f"{path}/{Element.get(element, 'name', '')}"
        for path, system in _systems(root)
        for element in _within(system)
    }


def _within(system: Element) -> Iterator[Element]:
    """Yield the elements of a system without nested systems."""
    left = [child for child in system if safe_xml.local(child.tag) != "SpaceSystem"]
    while left:
        element = left.pop()
        yield element
        left += list(element)


def _references(root: Element) -> Iterator[frozenset[str]]:
    """Yield the possible target paths of each distinct reference of a file."""
    seen: set[tuple[str, str]] = set()
    for path, system in _systems(root):
        for element in _within(system):
            for key in _REFERENCES:
                reference = Element.get(element, key)
                if reference and (path, reference) not in seen:
                    seen.add((path, reference))
                    yield frozenset(_targets(path, reference))


def _targets(path: str, reference: str) -> Iterator[str]:
    """Yield the paths that a reference within the system ``path`` can mean.

    The target can be in the system or in an enclosing one. The last names may be
    members of an aggregate.
    """
    words = reference.split("/")
    for length in range(len(words), 0, -1):
        start, some = path, "/".join(words[:length])
        while some:
            yield posixpath.normpath(posixpath.join(start, some))
            if not start or some.startswith("/"):
                break
            start = start.rpartition("/")[0]
