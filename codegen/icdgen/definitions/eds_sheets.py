"""Packages of a data sheet and neighbouring files, with type references and values of
design parameters.

A data sheet refers to types of other files without naming the files, so all data sheets
in its folder are indexed (`beside`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

from icdgen.definitions import kinds, safe_xml
from icdgen.definitions.eds_values import evaluate, integer_value
from icdgen.definitions.model import Definitions, NotSupported, unreadable
from icdgen.definitions.wording import line

ROOTS = ("PackageFile", "DataSheet")
PARAMETERS, _ALIAS = "DesignParameters", "AliasDataType"
TWICE = "IMP076"
MOST_FILES = 200
MOST_BYTES = 32_000_000  # of all files
_TOGETHER = "import it together with the file that has it: icdgen import FILE FILE, or the folder of both"
_START = 65_536  # bytes that identify the kind of a file
_DEEPEST = 20  # levels of parameters that refer to each other
_LONGEST = 2000  # characters of a value
_REFERENCE = re.compile(r"\$\{([^${}]{1,200})\}")


class Sheets:
    """Index of types, interfaces and design parameters.

    ``own`` lists the packages of the file itself.
    """

    def __init__(
        self, root: Element, neighbours: Iterable[tuple[str, Element]], to: Definitions
    ) -> None:
        """Index a file and the files to which it may refer.

        ``neighbours`` contains their paths and root elements.
        """
        self.to = to
        self.root = root
        self.own: list[Element] = []
        self._within = set(root.iter())
        self.all: list[Element] = []  # packages
        self._found: dict[tuple[str, str], Element] = {}
        # Package and component of an element.
        self._scopes: dict[Element, tuple[str, str]] = {}
        self._files: dict[str, str] = {}  # by package
        self._defines: dict[str, tuple[str, str, str]] = {}  # value, package and file
        # Second file of duplicate packages and parameters.
        self._duplicates: dict[str, str] = {}
        self._values: dict[tuple[str, str], str] = {}
        self._index(to.file, root)
        self.own = list(self.all)
        for path, neighbour in neighbours:
            self._index(path, neighbour)

    def _index(self, file: str, root: Element) -> None:
        for element in root.iter():
            element.tag = safe_xml.local(element.tag)
        for package in root.iterfind("Package"):
            name = package.get("name", "")
            for define in package.iterfind("Define"):
                self._index_parameter(name, define, file)
            if root.tag == PARAMETERS:
                continue
            if name in self._files:
                self._duplicates.setdefault(name, file)
                continue
            self._files[name] = file
            self.all.append(package)
            for descendant in package.iter():
                self._scopes[descendant] = (name, "")
            for component in package.iterfind("ComponentSet/Component"):
                for descendant in component.iter():
                    self._scopes[descendant] = (name, component.get("name", ""))
                self._index_types(component, f"{name}/{component.get('name', '')}//")
            self._index_types(package, f"{name}/")
            for interface in package.iterfind("DeclaredInterfaceSet/Interface"):
                self._found.setdefault(
                    ("interface", f"{name}/{interface.get('name', '')}"), interface
                )

    def _index_types(self, owner: Element, before: str) -> None:
        for element in owner.iterfind("DataTypeSet/*"):
            self._found.setdefault(
                ("type", f"{before}{element.get('name', '')}"), element
            )

    def _index_parameter(self, package: str, define: Element, file: str) -> None:
        name, value = f"{package}/{define.get('name', '')}", define.get("value", "")
        first = self._defines.setdefault(name, (value, package, file))
        if first[0] != value:
            self._duplicates.setdefault(f"${{{name}}}", file)

    def types(self, package: Element) -> Iterator[Element]:
        """Yield the types of a package and its components."""
        yield from package.iterfind("DataTypeSet/*")
        yield from package.iterfind("ComponentSet/Component/DataTypeSet/*")

    def line(self, element: Element) -> int | None:
        """Return the line of an element, or None if it belongs to another file."""
        return getattr(element, "line", None) if element in self._within else None

    def package(self, element: Element) -> str:
        """Return the name of the package that contains an element."""
        return self._scopes[element][0]

    def attribute(self, element: Element, key: str, default: str = "") -> str:
        """Return an attribute with its design parameters resolved.

        Raises `NotSupported` if a parameter is undefined.
        """
        text = element.get(key)
        if text is None:
            return default
        return (
            self._resolved(text, self._scopes.get(element, ("", ""))[0], 0).strip()
            if "${" in text
            else text.strip()
        )

    def labels(self, type_: Element) -> Iterator[tuple[str, int]]:
        """Yield the labels of an enumeration with their values.

        A label without a value follows the previous one. Raises `NotSupported` if a
        value is undefined or not an integer.
        """
        value = -1
        for element in type_.iterfind("EnumerationList/Enumeration"):
            text = self.attribute(element, "value")
            value = (
                integer_value(text, "the value of a label")
                if text or "value" in element.attrib
                else value + 1
            )
            yield self.attribute(element, "label"), value

    def is_true(self, element: Element, key: str) -> bool:
        """Return whether an attribute is `true` or `1`."""
        return self.attribute(element, key).lower() in ("true", "1")

    def _resolved(self, text: str, package: str, depth: int) -> str:
        if depth > _DEEPEST:
            raise NotSupported(
                f"`{line(text, 60)}` is defined by itself, or by more than {_DEEPEST} others"
            )
        result, at = "", 0
        for reference in _REFERENCE.finditer(text):
            result += text[at : reference.start()] + self._value(
                reference[1].strip(), package, depth
            )
            at = reference.end()
            if len(result) > _LONGEST:
                raise NotSupported(
                    f"`{line(text, 60)}` becomes longer than {_LONGEST} characters"
                )
        return result + text[at:]

    def _value(self, name: str, package: str, depth: int) -> str:
        """Return the text that replaces a reference to a design parameter.

        Arithmetic expressions are evaluated.

        Raises `NotSupported` if the parameter is undefined, circular or too long.
        """
        if (resolved := self._values.get((name, package))) is not None:
            return resolved
        qualified_name = next(
            (
                candidate
                for candidate in (name, f"{package}/{name}")
                if candidate in self._defines
            ),
            None,
        )
        if qualified_name is None:
            raise NotSupported(
                f"no file in the folder defines `${{{line(name, 100)}}}`", _TOGETHER
            )
        text, defining_package, _ = self._defines[qualified_name]
        self._report_duplicate(
            f"${{{qualified_name}}}", self._defines[qualified_name][2]
        )
        text = self._resolved(text, defining_package, depth + 1)
        try:
            # Parentheses keep a fraction intact in the expression that contains it.
            value = evaluate(text)
            text = str(value) if value.denominator == 1 else f"({value})"
        except ValueError:
            pass  # a name, not an expression
        self._values[name, package] = text
        return text

    def defined(self, name: str) -> int | None:
        """Return a design parameter as an integer, or None if it is undefined or not an
        integer.
        """
        try:
            value = evaluate(self._value(name, "", 0))
        except (NotSupported, ValueError):
            return None
        return int(value) if value.denominator == 1 else None

    def _report_duplicate(self, what: str, first: str) -> None:
        """Report a duplicate package or design parameter on first use (IMP076)."""
        if (other := self._duplicates.pop(what, None)) is not None:
            of = "package " if not what.startswith("$") else ""
            text = f"{of}`{line(what, 100)}` is in `{Path(first).name}` and otherwise in `{Path(other).name}`"
            self.to.warn(TWICE, text, "the first one is taken")

    def find_element(self, kind: str, reference: str, seen_from: Element) -> Element:
        """Return the type or interface that a reference names, with aliases resolved.

        Raises `NotSupported` if it is undefined, or if an alias refers to itself.
        """
        element = self._find(kind, reference, seen_from)
        aliases = {element}
        while element.tag == _ALIAS:
            element = self._find(kind, self.attribute(element, "type"), element)
            if element in aliases:
                raise NotSupported(
                    f"the type `{line(reference, 100)}` is an alias of itself"
                )
            aliases.add(element)
        return element

    def _find(self, kind: str, reference: str, seen_from: Element) -> Element:
        """Return the element that a reference names, without resolving aliases.

        Raises `NotSupported` if it is undefined.
        """
        package, component = self._scopes[seen_from]
        # Scopes from inside to outside: component, package, qualified name.
        inner = f"{package}/{component}//{reference}" if component else ""
        for path in (inner, f"{package}/{reference}", reference):
            element = self._found.get((kind, path)) if path else None
            if element is not None:
                self._report_duplicate(
                    self.package(element), self._files[self.package(element)]
                )
                return element
        prefix = reference.rpartition("/")[0]
        if prefix and prefix not in self._files:
            raise NotSupported(
                f"`{line(reference, 100)}` is of the package `{line(prefix, 60)}`, which is neither in the file nor in its folder",
                _TOGETHER,
            )
        raise NotSupported(f"there is no {kind} `{line(reference, 100)}`")


def beside(file: str, size: int) -> Iterator[tuple[str, Element]]:
    """Yield path and root of other data sheets and design parameter files in the folder
    of a file, by name.

    ``size`` is the number of bytes already read. Raises `Findings` if a file cannot be
    read, or above `MOST_FILES` or `MOST_BYTES`.
    """
    own = Path(file)
    count = 0
    for path in sorted(own.parent.glob("*.xml")):
        if path.name == own.name or not path.is_file():
            continue
        try:
            with open(path, "rb") as opened:
                start = opened.read(_START).decode("utf-8-sig", "replace")
        except OSError:
            continue  # unreadable, possibly not a data sheet
        if safe_xml.root_of(start) not in (*ROOTS, PARAMETERS):
            continue
        data = kinds.contents(path)
        count, size = count + 1, size + len(data)
        if count > MOST_FILES or size > MOST_BYTES:
            text = f"its folder has more than {MOST_FILES} data sheets, or {MOST_BYTES:,} bytes of them"
            raise unreadable(file, text, "move those away that it does not need")
        yield str(path), safe_xml.parse(str(path), data)
