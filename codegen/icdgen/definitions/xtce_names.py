"""Named elements of XTCE files: nested systems, and the resolution of references.

A reference is resolved from the system in which it stands outwards, as in a file
system; an absolute path begins with a slash.
"""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

from icdgen.definitions import safe_xml
from icdgen.definitions.model import Definitions, NotSupported, unreadable
from icdgen.definitions.wording import line

# Name space of aliases, and prefix of ancillary data, that `icdgen --lang xtce` writes.
ICD = "ICD"
TWICE = "IMP076"
_TOGETHER = "if it is in another file, import both together: icdgen import FILE FILE, or the folder of both"
_DEEPEST = 100  # nested systems
_SETS = {
    "ParameterTypeSet": "parameter type", "ArgumentTypeSet": "argument type", "ParameterSet": "parameter",
    "ContainerSet": "container", "CommandContainerSet": "container", "MetaCommandSet": "command",
}  # fmt: skip


class XtceNames:
    """Elements that references can name, by kind and path."""

    def __init__(self, roots: Mapping[str, Element], to: Definitions) -> None:
        """Collect the elements of ``roots``, the root systems by file, and remove XML
        namespaces from their tags.

        Raises `Findings` if systems are nested too deeply.
        """
        self._found: dict[tuple[str, str], Element] = {}
        self._systems: dict[int, str] = {}
        self._files: dict[int, str] = {}
        self._senders: dict[int, Element] = {}  # commands by their container
        self._to = to
        for file, root in roots.items():
            for element in root.iter():
                element.tag = safe_xml.local(element.tag)
            self._note_file(file, root)

    def _note_file(self, file: str, root: Element) -> None:
        """Register the named elements of all systems of a file."""
        left = [(root, "", 0)]
        while left:
            system, above, depth = left.pop()
            if depth > _DEEPEST:
                raise unreadable(
                    file, f"more than {_DEEPEST} systems are nested", "make them flat"
                )
            path = f"{above}/{system.get('name', '')}"
            # Both sections of a SpaceSystem share one name space: commands can refer to
            # types in TelemetryMetaData, and telemetry to types in CommandMetaData.
            for meta in (
                child
                for child in system
                if child.tag in ("TelemetryMetaData", "CommandMetaData")
            ):
                for group in meta:
                    for element in group if group.tag in _SETS else ():
                        self._note(_SETS[group.tag], element, path, file)
            left += [
                (element, path, depth + 1)
                for element in reversed(system.findall("SpaceSystem"))
            ]

    def _note(self, kind: str, element: Element, path: str, file: str) -> None:
        """Register an element of the system ``path``.

        Reports a name that two files define (IMP076); the first is used.
        """
        first = self._found.setdefault(
            (kind, f"{path}/{element.get('name', '')}"), element
        )
        self._systems[id(element)] = path
        self._files[id(element)] = file
        if first is not element and self._files[id(first)] != file:
            name = line(f"{path}/{element.get('name', '')}", 100)
            text = f"the {kind} `{name}` is in `{Path(self._files[id(first)]).name}` and in `{Path(file).name}`"
            is_lost = kind in ("command", "container")
            severity = "error" if is_lost else "warning"
            self._to.warn(
                TWICE, text, "the first one is taken", severity, line_of(element), file
            )
            return
        container = element.find("CommandContainer") if kind == "command" else None
        if container is not None:
            self._found.setdefault(
                ("command container", f"{path}/{container.get('name', '')}"), container
            )
            self._systems[id(container)] = path
            self._senders[id(container)] = element
        for argument in element.iterfind("ArgumentList/Argument"):
            self._systems[id(argument)] = path

    def place(self, element: Element) -> tuple[int | None, str]:
        """Return line and file of an element."""
        return line_of(element), self._files.get(id(element), "")

    def all(self, kind: str) -> list[Element]:
        """Return the elements of a kind in the order of the files."""
        return [
            element
            for (element_kind, _), element in self._found.items()
            if element_kind == kind
        ]

    def system(self, element: Element) -> str:
        """Return the path of the system that contains an element."""
        return self._systems[id(element)]

    def commands(self, element: Element) -> list[Element]:
        """Return a command and its base commands, the derived one first.

        Raises `NotSupported` for circular inheritance.
        """
        chain = [element]
        while (base := chain[-1].find("BaseMetaCommand")) is not None:
            parent = self.find_element(
                "command", base.get("metaCommandRef", ""), chain[-1]
            )
            if any(parent is command for command in chain):
                raise NotSupported("commands are based on each other in a circle")
            chain.append(parent)
        return chain

    def container_of(self, command: Element) -> Element | None:
        """Return the container of a command or of its nearest base command, None
        without a container.

        Raises `NotSupported`.
        """
        containers = (
            element.find("CommandContainer") for element in self.commands(command)
        )
        return next(
            (container for container in containers if container is not None), None
        )

    def base_of(self, container: Element) -> Element | None:
        """Return the base of a container, None if it inherits no container.

        Raises `NotSupported`.

        A command container without `BaseContainer` inherits the container of the base
        command. The standard leaves this open. Yamcs implements it, and its own
        databases rely on it.
        """
        if (base := container.find("BaseContainer")) is not None:
            return self.container(base.get("containerRef", ""), container)
        command = self._senders.get(id(container))
        base_command = None if command is None else command.find("BaseMetaCommand")
        if command is None or base_command is None:
            return None
        return self.container_of(
            self.find_element(
                "command", base_command.get("metaCommandRef", ""), command
            )
        )

    def container(self, reference: str, seen_from: Element) -> Element:
        """Return the container that a reference names.

        Raises `NotSupported` if it does not exist.

        References from command containers prefer command containers.
        """
        if seen_from.tag == "CommandContainer":
            try:
                return self.find_element("command container", reference, seen_from)
            except NotSupported:
                pass  # containers of telemetry may be parts of commands
        return self.find_element("container", reference, seen_from)

    def type_of(self, reference: str, seen_from: Element) -> Element:
        """Return the type that a parameter, an argument or another type refers to.

        Raises `NotSupported` if it does not exist.
        """
        return self.find_element(
            "argument type" if "Argument" in seen_from.tag else "parameter type",
            reference,
            seen_from,
        )

    def parameter(
        self, reference: str, seen_from: Element
    ) -> tuple[Element, tuple[str, ...]]:
        """Return the parameter that a reference names, and the path to a member of an
        aggregate.

        Raises `NotSupported`.
        """
        # A slash separates systems as well as members of aggregates, so only a search
        # shows where the name of the parameter ends.
        words = reference.split("/")
        for length in range(len(words), 0, -1):
            try:
                return self.find_element(
                    "parameter", "/".join(words[:length]), seen_from
                ), tuple(words[length:])
            except NotSupported:
                continue
        raise NotSupported(
            f"there is no parameter `{line(reference, 100)}`",
            _TOGETHER if "/" in reference else "",
        )

    def find_element(self, kind: str, reference: str, seen_from: Element) -> Element:
        """Return the element that a reference names.

        Raises `NotSupported` if no such element exists.
        """
        # XTCE schema, NameReferenceType: an unqualified name is searched in the current
        # SpaceSystem first, then in progressively higher SpaceSystems.
        path = self.system(seen_from)
        while True:
            target = self._found.get(
                (kind, posixpath.normpath(posixpath.join(path, reference)))
            )
            if target is not None:
                return target
            if not path or reference.startswith("/"):
                raise NotSupported(
                    f"there is no {kind} `{line(reference, 100)}`",
                    _TOGETHER if "/" in reference else "",
                )
            path = path.rpartition("/")[0]


def line_of(element: Element) -> int | None:
    """Return the line in which an element begins, None if it is unknown."""
    return getattr(element, "line", None)


def name_of(element: Element) -> str:
    """Return the name of an element: that in its ICD if icdgen wrote the file, else the
    XTCE name.
    """
    return alias(element) or element.get("name", "")


def alias(element: Element) -> str:
    """Return the name of an element in its ICD, from an alias that icdgen wrote.

    Empty without one.
    """
    aliases = (
        entry
        for entry in element.iterfind("AliasSet/Alias")
        if entry.get("nameSpace") == ICD
    )
    return next(
        (text for entry in aliases if (text := line(entry.get("alias"), 200))), ""
    )


def ancillary_data(element: Element) -> dict[str, str]:
    """Return the ancillary data that icdgen wrote for an element, by key: `group`,
    `reserved`, `special 255`.
    """
    pairs = (
        (data.get("name", ""), data.text or "")
        for data in element.iterfind("AncillaryDataSet/AncillaryData")
    )
    return {
        name.removeprefix(f"{ICD} "): line(text, 400)
        for name, text in pairs
        if name.startswith(f"{ICD} ")
    }
