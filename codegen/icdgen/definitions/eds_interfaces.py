"""Interfaces of data sheets: containers that components send, with direction and
identifying number.

The packages of a data sheet go in. Containers that no interface sends are returned as
well, so that `eds` can report them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from icdgen.definitions import packets
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import CONTAINER
from icdgen.definitions.eds_values import integer_value
from icdgen.definitions.model import NotSupported, unreadable

_SETS = {"RequiredInterfaceSet": True, "ProvidedInterfaceSet": False}
MOST_STEPS = 200_000  # containers that interfaces carry, with their base containers
_DEEPEST = 20  # interfaces that are based on each other
_APID_MASK = (1 << packets.APID_BITS) - 1
# Topic ids as application process ids in the EDS library of cFS, for the first
# processor.
_TOPIC_BITS, _GLOBAL = 8, 0x60
_TOPICS = {
    packets.TELECOMMAND: ("TELECOMMAND", "GLOBAL_CMD"),
    packets.TELEMETRY: ("TELEMETRY", "GLOBAL_TLM"),
}


@dataclass
class Sending:
    """Container that an interface carries.

    ``kind`` is ``telecommand`` or ``telemetry``, or None if the data sheet does not
    define a single direction. ``number`` is None without a constant parameter.
    """

    container: Element
    kind: str | None = None
    number: int | None = None  # the value of a parameter of the interface
    parameter: str = ""
    interface: str = ""  # only for a container with several interfaces and numbers

    def apid(self, sheets: Sheets) -> int | None:
        """Return the application process id that the number stands for, or None if it
        is unknown.

        Topic ids are converted like in the EDS library of cFS, for the first processor.
        """
        if self.number is None or self.kind is None:
            return None
        if self.parameter.lower() != "topicid":
            return self.number & _APID_MASK
        local_base, global_base = (
            sheets.defined(f"CFE_MISSION/{name}_BASE_TOPICID")
            for name in _TOPICS[self.kind]
        )
        if local_base is not None and local_base <= self.number < local_base + (
            1 << _TOPIC_BITS
        ):
            return self.number - local_base
        if (
            global_base is not None
            and local_base is not None
            and global_base <= self.number
        ):
            return (self.number - global_base) ^ _GLOBAL
        return self.number if self.number <= _APID_MASK else None


class Interfaces:
    """Containers that the interfaces of a file carry."""

    def __init__(self, sheets: Sheets) -> None:
        self.sheets = sheets
        self.own = [
            container
            for package in sheets.own
            for container in sheets.types(package)
            if container.tag == CONTAINER
        ]
        self._is_own = set(self.own)
        self._steps = 0
        self._derived: dict[Element, list[Element]] = {}
        self._uses: dict[
            Element, set[Element]
        ] = {}  # types of the entries, elements and base of a type
        for package in sheets.all:
            for type_ in sheets.types(package):
                base = self._type(type_, "baseType")
                if base is not None:
                    self._derived.setdefault(base, []).append(type_)
                entries = (
                    entry
                    for tag in ("EntryList", "TrailerEntryList")
                    for entry in type_.iterfind(f"{tag}/*")
                )
                inner = [self._type(entry, "type") for entry in entries]
                used = {
                    used_type
                    for used_type in (base, self._type(type_, "dataTypeRef"), *inner)
                    if used_type is not None
                }
                self._uses[type_] = used

    def _type(self, of: Element, key: str) -> Element | None:
        """Return the type that an attribute names, or None if it is not defined."""
        try:
            reference = self.sheets.attribute(of, key)
            return (
                self.sheets.find_element("type", reference, of) if reference else None
            )
        except NotSupported:
            return None  # reported when the container is read

    def sent(self) -> tuple[list[Sending], list[Element]]:
        """Return carried containers in file order, and independent containers that no
        interface carries.

        If no interface carries a container, all independent containers are returned as
        sent. Raises `Findings` above `MOST_STEPS` containers.
        """
        by_container: dict[Element, dict[int | None, Sending]] = {}
        # A generic type mapping is specific to an interface, so it takes precedence
        # over the argument type.
        for is_mapped in (True, False):
            for sending in self._carried_containers(is_mapped):
                for container in self._leaves(sending.container):
                    sendings = by_container.setdefault(container, {})
                    if is_mapped or not sendings:
                        sendings.setdefault(
                            sending.number, replace(sending, container=container)
                        )
        nested = {
            type_ for used in self._uses.values() for type_ in used
        } - self._cyclic_types()
        independent = [
            container
            for container in self.own
            if container not in nested
            and not self._is_abstract(container)
            and container not in by_container
        ]
        if not by_container:
            return [Sending(container) for container in independent], []
        sent = [
            sending
            for container in self.own
            for sending in by_container.get(container, {}).values()
        ]
        for sending in sent:
            sending.interface = (
                sending.interface if len(by_container[sending.container]) > 1 else ""
            )
        return sent, independent

    def _leaves(self, container: Element) -> list[Element]:
        """Return the most derived containers of the file that are based on a container,
        or the container itself.

        Raises `Findings` above `MOST_STEPS` containers in total.
        """
        waiting, seen = [container], {container}
        leaves: list[Element] = []
        while waiting:
            current = waiting.pop()
            self._steps += 1
            if self._steps > MOST_STEPS:
                text = f"its interfaces carry more than {MOST_STEPS:,} containers"
                raise unreadable(self.sheets.to.file, text, "import it in parts")
            derived = [
                candidate
                for candidate in self._derived.get(current, ())
                if candidate not in seen
            ]
            seen.update(derived)
            waiting += reversed(derived)
            if (
                not derived
                and current in self._is_own
                and not self._is_abstract(current)
            ):
                leaves.append(current)
        return leaves

    def _cyclic_types(self) -> set[Element]:
        """Return the types in reference cycles, and the types that use these directly
        or indirectly.
        """
        users: dict[Element, list[Element]] = {}
        for type_, used in self._uses.items():
            for used_type in used:
                users.setdefault(used_type, []).append(type_)
        # Topological sort. Types that remain depend on a cycle.
        waiting = {type_: len(used) for type_, used in self._uses.items()}
        ready = [type_ for type_, count in waiting.items() if not count]
        while ready:
            type_ = ready.pop()
            del waiting[type_]
            for user in users.get(type_, ()):
                waiting[user] -= 1
                if not waiting[user]:
                    ready.append(user)
        return set(waiting)

    def _is_abstract(self, container: Element) -> bool:
        try:
            return self.sheets.is_true(container, "abstract")
        except NotSupported:
            return False

    def _carried_containers(self, is_mapped: bool) -> Iterator[Sending]:
        """Yield the containers of command arguments: mapped to a generic type if
        ``is_mapped``, else named directly.
        """
        for package in self.sheets.own:
            for component in package.iterfind("ComponentSet/Component"):
                numbers = self._constant_parameters(component)
                for tag, is_required in _SETS.items():
                    for interface in component.iterfind(f"{tag}/Interface"):
                        yield from self._containers_of(
                            interface, is_required, is_mapped, numbers
                        )

    def _containers_of(
        self,
        interface: Element,
        is_required: bool,
        is_mapped: bool,
        numbers: dict[str, tuple[str, int]],
    ) -> Iterator[Sending]:
        maps = self._type_mappings(interface)
        parameter, number = numbers.get(interface.get("name", ""), ("", None))
        ways: dict[Element, set[str]] = {}
        for declared in self._declarations(interface):
            maps = {**self._type_mappings(declared), **maps}
            for argument in declared.iterfind("CommandSet/Command/Argument"):
                type_ = argument.get("type", "")
                container = (
                    maps.get(type_) if is_mapped else self._type(argument, "type")
                )
                if (
                    container is None
                    or container.tag != CONTAINER
                    or (not is_mapped and type_ in maps)
                ):
                    continue
                mode = argument.get("mode", "in").lower()
                # A required interface sends its `in` arguments, a provided interface
                # receives them.
                goes_out = (mode == "in") == is_required
                kind = packets.TELEMETRY if goes_out else packets.TELECOMMAND
                ways.setdefault(container, set()).update(
                    [kind] if mode in ("in", "out") else _TOPICS
                )
        if is_mapped:
            for container in maps.values():
                if container.tag == CONTAINER:
                    ways.setdefault(container, set())
        for container, kinds in ways.items():
            way = next(iter(kinds)) if len(kinds) == 1 else None
            yield Sending(container, way, number, parameter, interface.get("name", ""))

    def _declarations(self, interface: Element) -> list[Element]:
        """Return the declarations of an interface and of its base interfaces."""
        waiting = [interface]
        result: list[Element] = []
        while waiting and len(result) < _DEEPEST:
            current = waiting.pop()
            bases = (
                [current]
                if current is interface
                else current.findall("BaseInterfaceSet/Interface")
            )
            for base in bases:
                try:
                    declared = self.sheets.find_element(
                        "interface", self.sheets.attribute(base, "type"), base
                    )
                except NotSupported:
                    continue
                if declared not in result:
                    result.append(declared)
                    waiting.append(declared)
        return result

    def _type_mappings(self, interface: Element) -> dict[str, Element]:
        """Return the concrete types of an interface by the generic type that they
        replace.
        """
        result: dict[str, Element] = {}
        for element in interface.iterfind("GenericTypeMapSet/GenericTypeMap"):
            if (type_ := self._type(element, "type")) is not None:
                result.setdefault(element.get("name", ""), type_)
        return result

    def _constant_parameters(self, component: Element) -> dict[str, tuple[str, int]]:
        """Return the constant parameter of each interface, with name and value.

        Names that end with `id` take precedence.
        """
        values: dict[str, int] = {}
        for variable in component.iterfind("Implementation/VariableSet/Variable"):
            try:
                text = self.sheets.attribute(variable, "initialValue")
                values[variable.get("name", "")] = integer_value(text, "a value", 0)
            except NotSupported:
                continue
        result: dict[str, tuple[str, int]] = {}
        for element in component.iterfind(
            "Implementation/ParameterMapSet/ParameterMap"
        ):
            name, parameter = element.get("interface", ""), element.get("parameter", "")
            value = values.get(element.get("variableRef", ""))
            if value is not None and (
                name not in result or parameter.lower().endswith("id")
            ):
                result[name] = (parameter, value)
        return result
