"""Files of XTCE that belong together, because one refers to what only another defines."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element

from icdgen.definitions import safe_xml

_REFERENCES = (
    "parameterTypeRef", "argumentTypeRef", "typeRef", "arrayTypeRef", "baseType", "parameterRef", "containerRef",
    "metaCommandRef",
)  # fmt: skip


def sets(roots: Mapping[str, Element]) -> list[dict[str, Element]]:
    """The files in sets, each in the order of the files."""
    named = {file: _names(root) for file, root in roots.items()}
    owner = {file: file for file in roots}  # the first file of the set

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
                    ends = sorted((first_of(file), first_of(other)), key=list(roots).index)
                    owner[ends[1]] = ends[0]
    made: dict[str, dict[str, Element]] = {}
    for file, root in roots.items():
        made.setdefault(first_of(file), {})[file] = root
    return list(made.values())


def _systems(root: Element) -> Iterator[tuple[str, Element]]:
    """Systems with their paths."""
    left = [("", root)]
    while left:
        above, system = left.pop()
        path = f"{above}/{Element.get(system, 'name', '')}"
        yield path, system
        left += [(path, one) for one in system if safe_xml.local(one.tag) == "SpaceSystem"]


def _names(root: Element) -> set[str]:
    """Paths of everything that has a name in the systems of a file."""
    return {f"{path}/{Element.get(one, 'name', '')}" for path, system in _systems(root) for one in _within(system)}


def _within(system: Element) -> Iterator[Element]:
    """The elements of a system but for those of systems within."""
    left = [one for one in system if safe_xml.local(one.tag) != "SpaceSystem"]
    while left:
        element = left.pop()
        yield element
        left += list(element)


def _references(root: Element) -> Iterator[frozenset[str]]:
    """Of each different reference the paths that it may mean: seen from its system and those around, members of it too."""
    seen: set[tuple[str, str]] = set()
    for path, system in _systems(root):
        for element in _within(system):
            for key in _REFERENCES:
                reference = Element.get(element, key)
                if reference and (path, reference) not in seen:
                    seen.add((path, reference))
                    yield frozenset(_meant(path, reference))


def _meant(path: str, reference: str) -> Iterator[str]:
    words = reference.split("/")
    for length in range(len(words), 0, -1):
        start, some = path, "/".join(words[:length])
        while some:
            yield posixpath.normpath(posixpath.join(start, some))
            if not start or some.startswith("/"):
                break
            start = start.rpartition("/")[0]
