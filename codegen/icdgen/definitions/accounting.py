"""Record which parts of a source a reader uses, so that no part of a definition is
dropped without a finding.

`safe_xml.parse` with an `Account` creates XML elements of the class `AccountedElement`.
`accounted` creates mappings of JSON and YAML of the class `AccountedMap`. Both behave
like the types that they extend, and record each read access. After reading,
`Account.elements` and `Account.mappings` walk through the source. `Account.report` then
adds a finding (IMP085) for each kind of attribute, element or key that was never read.

An element counts as used if a reader found it by name (`find`, `iterfind`, `iter`). It
also counts as used if an attribute or text of the element, or of a descendant, was
read. Iterating over all children marks no child as used, and reading a tag does not
count. A key counts as used if it was looked up, or if all items or values were
iterated. Only the outermost unused part is reported.
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
# Descriptor of the C class, which `AccountedElement` overrides.
_TEXT: Any = Element.__dict__["text"]


@dataclass
class _Entry:
    """Number of occurrences of one kind of key, with the first place."""

    times: int
    line: int | None
    place: str


@dataclass
class Account:
    """Tally of unused parts by owner and key.

    ``ignored`` lists keys without content for an ICD, such as history or editor layout.
    An item is `key` for any owner, or `owner.key`. Attributes and elements of XML are
    keys, spelled as in the file.
    """

    ignored: frozenset[str] = frozenset()
    entries: dict[tuple[str, str], _Entry] = field(default_factory=dict)

    def add(
        self, owner: str, key: str, place: str = "", line: int | None = None
    ) -> None:
        """Count an unused key of an owner.

        ``place`` names the first occurrence in reports (`group.points[3]`).
        """
        if key in self.ignored or f"{owner}.{key}" in self.ignored:
            return
        entry = self.entries.setdefault((owner, key), _Entry(0, line, place))
        entry.times += 1

    def elements(self, root: Element) -> None:
        """Count unread parts below an element that `safe_xml.parse` created with an
        account.
        """
        used = _used(cast(AccountedElement, root))
        # Through `Element` itself, because the overridden methods would record the
        # access.
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
                    self.add(
                        owner, _local(child.tag), _named(child) or place, child.line
                    )
            stack += reversed(inner)

    def mappings(self, root: object) -> None:
        """Count unread keys in a tree that `accounted` created."""
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
        """Count the public attributes of an object of a library that have a value and
        were not read.
        """
        for key in () if of.is_settled else dir(of.object):
            if key.startswith("_") or key in of.read_keys:
                continue
            # Attributes with an empty value carry no information that could get lost.
            value = getattr(of.object, key)
            if (
                not callable(value)
                and value is not None
                and value is not False
                and value not in ("", [], {}, ())
            ):
                self.add(owner, key, place)

    def report(self, to: Definitions) -> None:
        """Add a finding for each kind of unused key, in the order of the source."""
        listed = sorted(
            self.entries.items(), key=lambda item: (item[1].line or 0, item[0])
        )
        for (owner, key), entry in listed:
            part = f"`{one_line(key, _LONGEST_NAME)}`" + (
                f" of `{owner}`" if owner else ""
            )
            times = [f"{entry.times} times"] if entry.times > 1 else []
            first = (
                [f"first: {entry.place}" if times else entry.place]
                if entry.place
                else []
            )
            where = f" ({', '.join((*times, *first))})" if times or first else ""
            what = f"{part} is not used{where}"
            to.warn(
                UNUSED,
                what,
                "the ICD does not contain it: add it by hand if you need it",
                "note",
                entry.line,
            )


def settle(part: object) -> None:
    """Mark an element or mapping, including its contents, as read, because another
    finding already names it.

    Other objects are ignored.
    """
    if isinstance(part, (AccountedElement, AccountedMap)):
        part.settle()


class AccountedElement(Element):
    """XML element that records access to its attributes, its text and itself."""

    __slots__ = ("is_found", "is_text_read", "line", "read_keys")

    def __init__(
        self, tag: str, attrib: dict[str, str], line: int | None = None
    ) -> None:
        super().__init__(tag, attrib)
        self.line = line
        self.read_keys: set[str] = set()
        self.is_found = self.is_text_read = False

    def settle(self) -> None:
        """Mark the element and its descendants as read, because another finding already
        names it.
        """
        for element in cast(Iterator[AccountedElement], Element.iter(self)):
            element.is_found = element.is_text_read = True
            element.read_keys.update(Element.keys(element))

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

    def findtext(
        self, path: str, default: Any = None, namespaces: dict[str, str] | None = None
    ) -> Any:
        element = self.find(path, namespaces)
        return default if element is None else element.text or ""

    def iter(self, tag: str | None = None) -> Any:
        return (
            super().iter(tag) if tag in (None, "*") else map(_found, super().iter(tag))
        )

    def itertext(self) -> Any:
        for element in Element.iter(self):
            if isinstance(element, AccountedElement):
                element.is_found = element.is_text_read = True
        return super().itertext()


class _Attributes(Mapping[str, str]):
    """Attributes of an element as a mapping.

    A look-up counts as reading the attribute.
    """

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
    """Wrapper of a library object that records which attributes are read."""

    def __init__(self, object: Any) -> None:
        self.object = object
        self.read_keys: set[str] = set()
        self.is_settled = False

    def settle(self) -> None:
        """Mark the object as read, because another finding already names it."""
        self.is_settled = True

    def __getattr__(self, name: str) -> Any:
        self.read_keys.add(name)
        return getattr(self.object, name)


class AccountedMap(Map):
    """Mapping that records which keys are read.

    ``owner`` is its name in reports, and ``path`` its place.
    """

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

    def __iter__(
        self,
    ) -> Iterator[str]:  # otherwise, `{**mapping}` copies without `__getitem__`
        return super().__iter__()

    def items(self) -> ItemsView[str, Any]:  # type: ignore[override]
        self.read_keys.update(super().keys())
        return super().items()

    def values(self) -> ValuesView[Any]:  # type: ignore[override]
        self.read_keys.update(super().keys())
        return super().values()

    def settle(self) -> None:
        """Mark the mapping and its contents as read, because another finding already
        names it.
        """
        stack: list[object] = [self]
        while stack:
            value = stack.pop()
            if isinstance(value, list):
                stack += value
            elif isinstance(value, AccountedMap):
                stack += value.values()


def accounted(
    tree: Any, named: frozenset[str] = frozenset(), owner: str = "", path: str = ""
) -> Any:
    """Return a copy of a tree of JSON or YAML whose mappings are `AccountedMap`.

    Keys below the keys in ``named`` are user-defined names (`types`, `enums`). A
    mapping below such a key is reported under the key in ``named``. Any other mapping
    is reported under its own key.
    """
    if isinstance(tree, dict):
        mapping = AccountedMap(owner, path, tree)
        for key, value in tree.items():
            inner = (
                owner
                if owner in named and path.rsplit(".", 1)[-1] == owner
                else str(key)
            )
            dict.__setitem__(
                mapping,
                key,
                accounted(value, named, inner, f"{path}.{key}" if path else str(key)),
            )
        return mapping
    if isinstance(tree, list):
        items = [
            accounted(item, named, owner, f"{path}[{number}]")
            for number, item in enumerate(tree)
        ]
        if not isinstance(tree, Seq):
            return items
        sequence = Seq(tree.spot)
        sequence.spots = tree.spots
        sequence += items
        return sequence
    return tree


def _used(root: AccountedElement) -> set[AccountedElement]:
    """Return the elements that were read and their ancestors.

    The search is iterative, because files may nest arbitrarily deep.
    """
    listed = cast("list[AccountedElement]", list(Element.iter(root)))
    used: set[AccountedElement] = set()
    # In reverse document order, children come before their parents.
    for element in reversed(listed):
        if isinstance(element, AccountedElement):
            is_read = (
                element.is_found or element.is_text_read or bool(element.read_keys)
            )
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
    name = next(
        (value for key in ("name", "id") if (value := Element.get(element, key))), ""
    )
    return f"`{one_line(name, _LONGEST_NAME)}`" if name else ""
