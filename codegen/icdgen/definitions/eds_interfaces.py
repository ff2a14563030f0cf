"""Interfaces of data sheets: containers that components send, with direction and identifying number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from icdgen.definitions import packets
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import CONTAINER
from icdgen.definitions.eds_values import whole
from icdgen.definitions.model import NotHeld, unreadable

_SETS = {"RequiredInterfaceSet": True, "ProvidedInterfaceSet": False}
MOST_STEPS = 200_000  # containers that interfaces carry, with their base containers
_DEEPEST = 20  # interfaces that are based on each other
_APID_MASK = (1 << packets.APID_BITS) - 1
_TOPIC_BITS, _GLOBAL = (
    8,
    0x60,
)  # topic ids as application process ids in the EDS library of cFS, for the first processor
_TOPICS = {packets.TELECOMMAND: ("TELECOMMAND", "GLOBAL_CMD"), packets.TELEMETRY: ("TELEMETRY", "GLOBAL_TLM")}


@dataclass
class Sending:
    """Container that an interface carries. ``kind`` and ``number`` are None if no interface states them."""

    container: Element
    kind: str | None = None
    number: int | None = None  # the value of a parameter of the interface
    parameter: str = ""
    interface: str = ""  # only for a container with several interfaces and numbers

    def apid(self, sheets: Sheets) -> int | None:
        """Return the application process id that the number stands for, or None if it is unknown.

        Topic ids are converted like in the EDS library of cFS, for the first processor.
        """
        if self.number is None or self.kind is None:
            return None
        if self.parameter.lower() != "topicid":
            return self.number & _APID_MASK
        local, everywhere = (sheets.defined(f"CFE_MISSION/{one}_BASE_TOPICID") for one in _TOPICS[self.kind])
        if local is not None and local <= self.number < local + (1 << _TOPIC_BITS):
            return self.number - local
        if everywhere is not None and local is not None and everywhere <= self.number:
            return (self.number - everywhere) ^ _GLOBAL
        return self.number if self.number <= _APID_MASK else None


class Interfaces:
    """Containers that the interfaces of a file carry."""

    def __init__(self, sheets: Sheets) -> None:
        self.sheets = sheets
        self.own = [one for package in sheets.own for one in sheets.types(package) if one.tag == CONTAINER]
        self._is_own = set(self.own)
        self._steps = 0
        self._derived: dict[Element, list[Element]] = {}
        self._uses: dict[Element, set[Element]] = {}  # types of the entries, elements and base of a type
        for package in sheets.all:
            for one in sheets.types(package):
                base = self._type(one, "baseType")
                if base is not None:
                    self._derived.setdefault(base, []).append(one)
                entries = (entry for tag in ("EntryList", "TrailerEntryList") for entry in one.iterfind(f"{tag}/*"))
                inner = [self._type(entry, "type") for entry in entries]
                used = {found for found in (base, self._type(one, "dataTypeRef"), *inner) if found is not None}
                self._uses[one] = used

    def _type(self, of: Element, key: str) -> Element | None:
        """Return the type that an attribute names, or None if it is not defined."""
        try:
            reference = self.sheets.attribute(of, key)
            return self.sheets.find("type", reference, of) if reference else None
        except NotHeld:
            return None  # reported when the container is read

    def sent(self) -> tuple[list[Sending], list[Element]]:
        """Return carried containers in file order, and independent containers that no interface carries.

        If no interface carries a container, all independent containers are returned as sent. Raises `Findings` above
        `MOST_STEPS` containers.
        """
        found: dict[Element, dict[int | None, Sending]] = {}
        # A generic type mapping is specific to an interface, so it takes precedence over the argument type.
        for is_mapped in (True, False):
            for one in self._carried(is_mapped):
                for container in self._leaves(one.container):
                    ways = found.setdefault(container, {})
                    if is_mapped or not ways:
                        ways.setdefault(one.number, replace(one, container=container))
        part = {one for used in self._uses.values() for one in used} - self._circles()
        alone = [one for one in self.own if one not in part and not self._is_abstract(one) and one not in found]
        if not found:
            return [Sending(one) for one in alone], []
        sent = [one for container in self.own for one in found.get(container, {}).values()]
        for one in sent:
            one.interface = one.interface if len(found[one.container]) > 1 else ""
        return sent, alone

    def _leaves(self, container: Element) -> list[Element]:
        """Return the most derived containers of the file that are based on a container, or the container itself.

        Raises `Findings` above `MOST_STEPS` containers in total.
        """
        left, seen = [container], {container}
        leaves: list[Element] = []
        while left:
            one = left.pop()
            self._steps += 1
            if self._steps > MOST_STEPS:
                text = f"its interfaces carry more than {MOST_STEPS:,} containers"
                raise unreadable(self.sheets.to.file, text, "import it in parts")
            more = [inner for inner in self._derived.get(one, ()) if inner not in seen]
            seen.update(more)
            left += reversed(more)
            if not more and one in self._is_own and not self._is_abstract(one):
                leaves.append(one)
        return leaves

    def _circles(self) -> set[Element]:
        """Return the types in reference cycles, and the types that use these directly or indirectly."""
        users: dict[Element, list[Element]] = {}
        for one, used in self._uses.items():
            for other in used:
                users.setdefault(other, []).append(one)
        # Topological sort. Types that remain depend on a cycle.
        waiting = {one: len(used) for one, used in self._uses.items()}
        left = [one for one, count in waiting.items() if not count]
        while left:
            one = left.pop()
            del waiting[one]
            for user in users.get(one, ()):
                waiting[user] -= 1
                if not waiting[user]:
                    left.append(user)
        return set(waiting)

    def _is_abstract(self, container: Element) -> bool:
        try:
            return self.sheets.says(container, "abstract")
        except NotHeld:
            return False

    def _carried(self, is_mapped: bool) -> Iterator[Sending]:
        """Yield the containers of command arguments: mapped to a generic type if ``is_mapped``, else named directly."""
        for package in self.sheets.own:
            for component in package.iterfind("ComponentSet/Component"):
                numbers = self._numbers(component)
                for tag, is_required in _SETS.items():
                    for interface in component.iterfind(f"{tag}/Interface"):
                        yield from self._of(interface, is_required, is_mapped, numbers)

    def _of(
        self, interface: Element, is_required: bool, is_mapped: bool, numbers: dict[str, tuple[str, int]]
    ) -> Iterator[Sending]:
        maps = self._maps(interface)
        parameter, number = numbers.get(interface.get("name", ""), ("", None))
        ways: dict[Element, set[str]] = {}
        for declared in self._declared(interface):
            maps = {**self._maps(declared), **maps}
            for argument in declared.iterfind("CommandSet/Command/Argument"):
                type_ = argument.get("type", "")
                container = maps.get(type_) if is_mapped else self._type(argument, "type")
                if container is None or container.tag != CONTAINER or (not is_mapped and type_ in maps):
                    continue
                mode = argument.get("mode", "in").lower()
                # A required interface sends its `in` arguments, a provided interface receives them.
                goes_out = (mode == "in") == is_required
                kind = packets.TELEMETRY if goes_out else packets.TELECOMMAND
                ways.setdefault(container, set()).update([kind] if mode in ("in", "out") else _TOPICS)
        if is_mapped:
            for container in maps.values():
                if container.tag == CONTAINER:
                    ways.setdefault(container, set())
        for container, kinds in ways.items():
            way = next(iter(kinds)) if len(kinds) == 1 else None
            yield Sending(container, way, number, parameter, interface.get("name", ""))

    def _declared(self, interface: Element) -> list[Element]:
        """Return the declarations of an interface and of its base interfaces."""
        left = [interface]
        result: list[Element] = []
        while left and len(result) < _DEEPEST:
            one = left.pop()
            bases = [one] if one is interface else one.findall("BaseInterfaceSet/Interface")
            for base in bases:
                try:
                    declared = self.sheets.find("interface", self.sheets.attribute(base, "type"), base)
                except NotHeld:
                    continue
                if declared not in result:
                    result.append(declared)
                    left.append(declared)
        return result

    def _maps(self, interface: Element) -> dict[str, Element]:
        """Return the concrete types of an interface by the generic type that they replace."""
        result: dict[str, Element] = {}
        for element in interface.iterfind("GenericTypeMapSet/GenericTypeMap"):
            if (type_ := self._type(element, "type")) is not None:
                result.setdefault(element.get("name", ""), type_)
        return result

    def _numbers(self, component: Element) -> dict[str, tuple[str, int]]:
        """Return the constant parameter of each interface, with name and value.

        Names that end with `id` take precedence.
        """
        values: dict[str, int] = {}
        for variable in component.iterfind("Implementation/VariableSet/Variable"):
            try:
                text = self.sheets.attribute(variable, "initialValue")
                values[variable.get("name", "")] = whole(text, "a value", 0)
            except NotHeld:
                continue
        result: dict[str, tuple[str, int]] = {}
        for element in component.iterfind("Implementation/ParameterMapSet/ParameterMap"):
            name, parameter = element.get("interface", ""), element.get("parameter", "")
            value = values.get(element.get("variableRef", ""))
            if value is not None and (name not in result or parameter.lower().endswith("id")):
                result[name] = (parameter, value)
        return result
