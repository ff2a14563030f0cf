"""What has a name in a file of XTCE: systems within systems, and references between them."""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

from icdgen.definitions import safe_xml
from icdgen.definitions.model import Definitions, NotHeld, unreadable
from icdgen.definitions.wording import line

ICD = (
    "ICD"  # the name space of names, and the beginning of what is said beside XTCE, as `icdgen --lang xtce` writes them
)
TWICE = "IMP076"
_TOGETHER = "if it is in another file, import both together: icdgen import FILE FILE, or the folder of both"
_DEEPEST = 100  # systems within each other
_SETS = {
    "ParameterTypeSet": "parameter type", "ArgumentTypeSet": "argument type", "ParameterSet": "parameter",
    "ContainerSet": "container", "CommandContainerSet": "container", "MetaCommandSet": "command",
}  # fmt: skip


class Names:
    """Everything that references reach, by its kind and path."""

    def __init__(self, roots: Mapping[str, Element], to: Definitions) -> None:
        """``roots`` are the outermost systems by their file.

        Elements lose their namespaces. Raises `Findings` for systems too deep within each other.
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
        left = [(root, "", 0)]
        while left:
            system, above, depth = left.pop()
            if depth > _DEEPEST:
                raise unreadable(file, f"more than {_DEEPEST} systems are nested", "make them flat")
            path = f"{above}/{system.get('name', '')}"
            for meta in (one for one in system if one.tag in ("TelemetryMetaData", "CommandMetaData")):
                for group in meta:
                    for one in group if group.tag in _SETS else ():
                        self._note(_SETS[group.tag], one, path, file)
            left += [(element, path, depth + 1) for element in reversed(system.findall("SpaceSystem"))]

    def _note(self, kind: str, element: Element, path: str, file: str) -> None:
        first = self._found.setdefault((kind, f"{path}/{element.get('name', '')}"), element)
        self._systems[id(element)] = path
        self._files[id(element)] = file
        if first is not element and self._files[id(first)] != file:
            name = line(f"{path}/{element.get('name', '')}", 100)
            text = f"the {kind} `{name}` is in `{Path(self._files[id(first)]).name}` and in `{Path(file).name}`"
            is_lost = kind in ("command", "container")
            severity = "error" if is_lost else "warning"
            self._to.warn(TWICE, text, "the first one is taken", severity, line_of(element), file)
            return
        container = element.find("CommandContainer") if kind == "command" else None
        if container is not None:
            self._found.setdefault(("command container", f"{path}/{container.get('name', '')}"), container)
            self._systems[id(container)] = path
            self._senders[id(container)] = element
        for argument in element.iterfind("ArgumentList/Argument"):
            self._systems[id(argument)] = path

    def place(self, element: Element) -> tuple[int | None, str]:
        """Line and file in which something stands."""
        return line_of(element), self._files.get(id(element), "")

    def all(self, kind: str) -> list[Element]:
        """Those of a kind, as they stand in the file."""
        return [one for (of, _), one in self._found.items() if of == kind]

    def system(self, element: Element) -> str:
        """The path of the system in which something stands."""
        return self._systems[id(element)]

    def commands(self, element: Element) -> list[Element]:
        """A command, and those on which it is based. Raises `NotHeld` for a circle."""
        chain = [element]
        while (base := chain[-1].find("BaseMetaCommand")) is not None:
            found = self.find("command", base.get("metaCommandRef", ""), chain[-1])
            if any(found is one for one in chain):
                raise NotHeld("commands are based on each other in a circle")
            chain.append(found)
        return chain

    def container_of(self, command: Element) -> Element | None:
        """The container of a command, or of the nearest on which it is based. Raises `NotHeld`."""
        containers = (one.find("CommandContainer") for one in self.commands(command))
        return next((container for container in containers if container is not None), None)

    def base_of(self, container: Element) -> Element | None:
        """The container that one extends. Raises `NotHeld`.

        That of a command which names no base extends that of the base command: the standard leaves it open, Yamcs sends
        it so, and its own databases rely on that.
        """
        if (base := container.find("BaseContainer")) is not None:
            return self.container(base.get("containerRef", ""), container)
        command = self._senders.get(id(container))
        base_command = None if command is None else command.find("BaseMetaCommand")
        if command is None or base_command is None:
            return None
        return self.container_of(self.find("command", base_command.get("metaCommandRef", ""), command))

    def container(self, reference: str, seen_from: Element) -> Element:
        """The container that a reference names: seen from a command one of commands, if there is one. Raises `NotHeld`."""
        if seen_from.tag == "CommandContainer":
            try:
                return self.find("command container", reference, seen_from)
            except NotHeld:
                pass  # containers of telemetry may be parts of commands
        return self.find("container", reference, seen_from)

    def type_of(self, reference: str, seen_from: Element) -> Element:
        """The type that a parameter, an argument or another type names. Raises `NotHeld`."""
        return self.find("argument type" if "Argument" in seen_from.tag else "parameter type", reference, seen_from)

    def parameter(self, reference: str, seen_from: Element) -> tuple[Element, tuple[str, ...]]:
        """The parameter that a reference names, and the names that lead to a member of it. Raises `NotHeld`."""
        words = reference.split("/")
        for length in range(len(words), 0, -1):
            try:
                return self.find("parameter", "/".join(words[:length]), seen_from), tuple(words[length:])
            except NotHeld:
                continue
        raise NotHeld(f"there is no parameter `{line(reference, 100)}`", _TOGETHER if "/" in reference else "")

    def find(self, kind: str, reference: str, seen_from: Element) -> Element:
        """What a reference names: in the system, or one around it. Raises `NotHeld` if there is nothing."""
        path = self.system(seen_from)
        while True:
            found = self._found.get((kind, posixpath.normpath(posixpath.join(path, reference))))
            if found is not None:
                return found
            if not path or reference.startswith("/"):
                raise NotHeld(f"there is no {kind} `{line(reference, 100)}`", _TOGETHER if "/" in reference else "")
            path = path.rpartition("/")[0]


def line_of(element: Element) -> int | None:
    """The line in which an element begins."""
    return getattr(element, "line", None)


def called(element: Element) -> str:
    """The name of something; of what icdgen wrote that of its ICD."""
    return alias(element) or element.get("name", "")


def alias(element: Element) -> str:
    """The name that something has in an ICD, if icdgen wrote it."""
    aliases = (one for one in element.iterfind("AliasSet/Alias") if one.get("nameSpace") == ICD)
    return next((said for one in aliases if (said := line(one.get("alias"), 200))), "")


def beside(element: Element) -> dict[str, str]:
    """What is said beside XTCE, by what it is: `group`, `reserved`, `special 255`."""
    found = ((one.get("name", ""), one.text or "") for one in element.iterfind("AncillaryDataSet/AncillaryData"))
    return {name.removeprefix(f"{ICD} "): line(text, 400) for name, text in found if name.startswith(f"{ICD} ")}
