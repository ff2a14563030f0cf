"""Account of what a reader used of its source, so that nothing of a definition is dropped without a finding.

A reader reads its source through the wrappers of this module: `safe_xml.parse` with an `Account` makes XML elements of the
class `AccountedElement`, `accounted` makes mappings of JSON and YAML `AccountedMap`. They behave like what they wrap and
record what is read. At the end, `Account.elements` and `Account.mappings` walk through the source once more,
and `Account.report` adds a finding (IMP085) for each kind of attribute, element or key that was never read.

An element counts as used if it was found by name (`find`, `iterfind`, `iter`), or if an attribute or the text of it,
or of an element within, was read. Iterating over all children uses none of them, nor does reading a tag. A key
counts as used if it was looked up, or if all items or values were iterated. Of what is unused the outermost part
is reported.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterable, Iterator, Mapping, ValuesView
from dataclasses import dataclass, field
from typing import Any, cast
from xml.etree.ElementTree import Element

from icdgen.definitions.model import Definitions
from icdgen.definitions.wording import line as one_line
from icdgen.diagnostics import Place
from icdgen.icd.located import Map, Seq

UNUSED = "IMP085"
_LONGEST_NAME = 60
_TEXT: Any = Element.__dict__["text"]  # what `AccountedElement` overrides


@dataclass
class _Entry:
    """Occurrences of one kind of key."""

    times: int
    line: int | None
    place: str


@dataclass
class Account:
    """Tally of unused parts by owner and key.

    ``ignored`` names what carries nothing that an ICD could contain (history, layout of an editor): `key` of any owner, or
    `owner.key`. Attributes of XML are keys as they stand in the file, and so are the names of elements.
    """

    ignored: frozenset[str] = frozenset()
    entries: dict[tuple[str, str], _Entry] = field(default_factory=dict)

    def add(self, owner: str, key: str, place: str = "", line: int | None = None) -> None:
        """Count an unused key of an owner. ``place`` names the first for people (`group.points[3]`)."""
        if key in self.ignored or f"{owner}.{key}" in self.ignored:
            return
        entry = self.entries.setdefault((owner, key), _Entry(0, line, place))
        entry.times += 1

    def elements(self, root: Element) -> None:
        """Count what was not read below an element that `safe_xml.parse` made with an account."""
        used = _used(cast(AccountedElement, root))
        stack = [cast(AccountedElement, root)]
        while stack:
            element = stack.pop()
            owner, place = _local(element.tag), _named(element)
            for key in Element.keys(element):
                if key not in element.read_keys:
                    self.add(owner, _local(key), place, element.line)
            text = _TEXT.__get__(element)
            if text and text.strip() and not element.is_text_read:
                self.add(owner, "text", place, element.line)
            inner = []
            for child in cast(Iterable[AccountedElement], element):
                if not isinstance(child.tag, str):
                    continue  # comments and processing instructions
                if child in used:
                    inner.append(child)
                else:
                    self.add(owner, _local(child.tag), _named(child) or place, child.line)
            stack += reversed(inner)

    def mappings(self, root: object) -> None:
        """Count the keys that were not read in a tree that `accounted` made."""
        stack = [root]
        while stack:
            value = stack.pop()
            if isinstance(value, list):
                stack += reversed(value)
            elif isinstance(value, AccountedMap):
                for key, inner in reversed(dict.items(value)):
                    if key in value.read_keys:
                        stack.append(inner)
                    else:
                        line = value.key_at(key).line if key in value.spots else None
                        self.add(value.owner, str(key), value.path, line)

    def attributes(self, of: AccountedObject, owner: str, place: str) -> None:
        """Count the public attributes of an object of a library that have a value and were not read."""
        for key in () if of.is_settled else dir(of.object):
            if key.startswith("_") or key in of.read_keys:
                continue
            value = getattr(of.object, key)
            if not callable(value) and value is not None and value is not False and value not in ("", [], {}, ()):
                self.add(owner, key, place)

    def report(self, to: Definitions) -> None:
        """Add a finding for each kind of unused key, in the order of the source."""
        listed = sorted(self.entries.items(), key=lambda item: (item[1].line or 0, item[0]))
        for (owner, key), entry in listed:
            whole = f"`{one_line(key, _LONGEST_NAME)}`" + (f" of `{owner}`" if owner else "")
            times = [f"{entry.times} times"] if entry.times > 1 else []
            first = [f"first: {entry.place}" if times else entry.place] if entry.place else []
            where = f" ({', '.join((*times, *first))})" if times or first else ""
            what = f"{whole} is not used{where}"
            to.warn(UNUSED, what, "the ICD does not contain it: add it by hand if you need it", "note", entry.line)


def settle(part: object) -> None:
    """Mark an element or mapping with all within as read, if reads are recorded, because a finding names it already."""
    if isinstance(part, (AccountedElement, AccountedMap)):
        part.settle()


class AccountedElement(Element):
    """XML element that records which of its attributes were read, and whether its text and itself were."""

    __slots__ = ("is_found", "is_text_read", "line", "read_keys")

    def __init__(self, tag: str, attrib: dict[str, str], line: int | None = None) -> None:
        super().__init__(tag, attrib)
        self.line = line
        self.read_keys: set[str] = set()
        self.is_found = self.is_text_read = False

    def settle(self) -> None:
        """Mark the element with all within as read, because a finding names it already."""
        for one in cast(Iterator[AccountedElement], Element.iter(self)):
            one.is_found = one.is_text_read = True
            one.read_keys.update(Element.keys(one))

    @property
    def text(self) -> str | None:
        self.is_text_read = True
        return cast("str | None", _TEXT.__get__(self))

    @text.setter
    def text(self, value: str | None) -> None:
        _TEXT.__set__(self, value)

    @property
    def attrib(self) -> Mapping[str, str]:  # type: ignore[override]
        return _Attributes(self)

    def get(self, key: str, default: Any = None) -> Any:
        self.read_keys.add(key)
        return super().get(key, default)

    def items(self) -> Any:
        self.read_keys.update(super().keys())
        return super().items()

    def find(self, path: str, namespaces: dict[str, str] | None = None) -> Any:
        return _found(super().find(path, namespaces))

    def findall(self, path: str, namespaces: dict[str, str] | None = None) -> Any:
        return [_found(element) for element in super().findall(path, namespaces)]

    def iterfind(self, path: str, namespaces: dict[str, str] | None = None) -> Any:
        return map(_found, super().iterfind(path, namespaces))

    def findtext(self, path: str, default: Any = None, namespaces: dict[str, str] | None = None) -> Any:
        found = self.find(path, namespaces)
        return default if found is None else found.text or ""

    def iter(self, tag: str | None = None) -> Any:
        return super().iter(tag) if tag in (None, "*") else map(_found, super().iter(tag))

    def itertext(self) -> Any:
        for one in Element.iter(self):
            if isinstance(one, AccountedElement):
                one.is_found = one.is_text_read = True
        return super().itertext()


class _Attributes(Mapping[str, str]):
    """The attributes of an element; looking one up counts as reading it."""

    def __init__(self, element: AccountedElement) -> None:
        self.element = element

    def __getitem__(self, key: str) -> str:
        value = self.element.get(key)
        if value is None:
            raise KeyError(key)
        return cast(str, value)

    def __iter__(self) -> Iterator[str]:
        return iter(Element.keys(self.element))

    def __len__(self) -> int:
        return len(Element.keys(self.element))


class AccountedObject:
    """Object of a library that records which of its attributes were read."""

    def __init__(self, object: Any) -> None:
        self.object = object
        self.read_keys: set[str] = set()
        self.is_settled = False

    def settle(self) -> None:
        """Mark the object as read, because a finding names it already."""
        self.is_settled = True

    def __getattr__(self, name: str) -> Any:
        self.read_keys.add(name)
        return getattr(self.object, name)


class AccountedMap(Map):
    """Mapping that records which of its keys were read. ``owner`` is what it is called in a report, ``path`` its place."""

    __slots__ = ("owner", "path", "read_keys")

    def __init__(self, owner: str, path: str, source: dict[str, Any]) -> None:
        super().__init__(source.spot if isinstance(source, Map) else Place(""))
        self.spots = source.spots if isinstance(source, Map) else {}
        self.owner, self.path = owner, path
        self.read_keys: set[object] = set()

    def __getitem__(self, key: str) -> Any:
        self.read_keys.add(key)
        return super().__getitem__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self.read_keys.add(key)
        return super().get(key, default)

    def __contains__(self, key: object) -> bool:
        self.read_keys.add(key)
        return super().__contains__(key)

    def __iter__(self) -> Iterator[str]:  # without it, `{**mapping}` would not call `__getitem__`
        return super().__iter__()

    def items(self) -> ItemsView[str, Any]:  # type: ignore[override]
        self.read_keys.update(super().keys())
        return super().items()

    def values(self) -> ValuesView[Any]:  # type: ignore[override]
        self.read_keys.update(super().keys())
        return super().values()

    def settle(self) -> None:
        """Mark the mapping with all within as read, because a finding names it already."""
        stack: list[object] = [self]
        while stack:
            value = stack.pop()
            if isinstance(value, list):
                stack += value
            elif isinstance(value, AccountedMap):
                stack += value.values()


def accounted(tree: Any, named: frozenset[str] = frozenset(), owner: str = "", path: str = "") -> Any:
    """Return a copy of a tree of JSON or YAML whose mappings are `AccountedMap`.

    Below the keys ``named`` the keys are names of the author (`types`, `enums`): a mapping there is reported as one of
    that key, any other under the key that it stands at.
    """
    if isinstance(tree, dict):
        made = AccountedMap(owner, path, tree)
        for key, value in tree.items():
            inner = owner if owner in named and path.rsplit(".", 1)[-1] == owner else str(key)
            dict.__setitem__(made, key, accounted(value, named, inner, f"{path}.{key}" if path else str(key)))
        return made
    if isinstance(tree, list):
        items = [accounted(one, named, owner, f"{path}[{number}]") for number, one in enumerate(tree)]
        if not isinstance(tree, Seq):
            return items
        sequence = Seq(tree.spot)
        sequence.spots = tree.spots
        sequence += items
        return sequence
    return tree


def _used(root: AccountedElement) -> set[AccountedElement]:
    """Return the elements that were read or that contain one that was read. Iterative,
    because files may nest arbitrarily deep.
    """
    listed = cast("list[AccountedElement]", list(Element.iter(root)))
    used: set[AccountedElement] = set()
    for element in reversed(listed):  # those within come behind
        if isinstance(element, AccountedElement):
            is_read = element.is_found or element.is_text_read or bool(element.read_keys)
            if is_read or any(child in used for child in element):
                used.add(element)
    return used


def _found(element: Any) -> Any:
    if element is not None:
        element.is_found = True
    return element


def _local(name: object) -> str:
    return str(name).rsplit("}", 1)[-1]


def _named(element: Element) -> str:
    name = next((value for key in ("name", "id") if (value := Element.get(element, key))), "")
    return f"`{one_line(name, _LONGEST_NAME)}`" if name else ""
