"""XTCE (CCSDS 660.0, OMG): containers of telemetry and commands, in space packets where they begin with their header."""

from __future__ import annotations

import os
from collections.abc import Hashable, Iterator, Mapping, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from icdgen.definitions import packets, safe_xml, xtce_files
from icdgen.definitions.accounting import Account, settle
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import Definitions, Item, Network, NotHeld, Source
from icdgen.definitions.wording import line, node_name
from icdgen.definitions.xtce_layout import Layout, Part, Told
from icdgen.definitions.xtce_names import Names, beside, called
from icdgen.definitions.xtce_types import Types, described
from icdgen.diagnostics import Findings

_TELECOMMAND, _TELEMETRY = packets.TELECOMMAND, packets.TELEMETRY
_WITHOUT_EFFECT = frozenset(
    {
        "schemaLocation",
        "SpaceSystem.Header",  # who changed what when
        "ArrayParameterType.numberOfDimensions",  # the dimensions themselves are read
        "ArrayArgumentType.numberOfDimensions",
    }
    | {  # of the value after calibration; where there is no encoding they are read
        f"{kind}{of}Type.{key}"
        for kind in ("Integer", "Float")
        for of in ("Parameter", "Argument")
        for key in ("signed", "sizeInBits")
    }
)
IN_HEADER, BASE_ONLY = "IMP086", "IMP087"
_HAZARDOUS = frozenset({"vital", "critical", "severe"})


class Xtce:
    """Version 1.2, and that of 1.1."""

    name = "xtce"
    title = "telemetry and commands (XTCE)"
    needs: tuple[str, ...] = ("defusedxml",)

    def knows(self, start: str) -> bool:
        return safe_xml.root_of(start) == "SpaceSystem"

    def read(self, file: str, data: bytes) -> Definitions:
        """Raises `Findings` for an XML that cannot be read."""
        root = safe_xml.parse(file, data, account=Account())
        return _define({file: root}, Definitions(file), node_name(file))

    def read_set(self, sources: Sequence[Source]) -> list[Definitions]:
        """What each set of files defines in which one refers to another, called like their folder; and each other file."""
        roots: dict[str, Element] = {}
        result: list[Definitions] = []
        for source in sources:
            try:
                roots[source.file] = safe_xml.parse(source.file, source.data, account=Account())
            except Findings as error:
                result.append(Definitions(source.file))
                result[-1].refuse(error)
        for files in xtce_files.sets(roots):
            first = next(iter(files))
            folder = Path(os.path.commonpath([Path(file).absolute().parent for file in files]))
            name = node_name(first if len(files) == 1 else f"{folder.name}.xml")
            result.append(_define(files, Definitions(first, more=len(files) - 1), name))
        return result


def _define(roots: Mapping[str, Element], to: Definitions, name: str) -> Definitions:
    """Adds the ICD of the systems of files that are one database."""
    names = Names(roots, to)
    types = Types(to, names)
    found = _identified(list(_all(names, types, to)), to)
    types.report_raw_only()
    root = next(iter(roots.values()))
    title = line(called(root), 100) if len(roots) == 1 else ""
    network = Network(name, title or name, {**ORDERS[BIG], **(described(root) if title else {})})
    packets.fill(network, found, to)
    network.messages = _paired(network.messages)
    network.name_messages_apart(to)
    network.declare(types.enums.declared())
    to.networks.append(network)
    for file, one in roots.items():
        account, part = Account(_WITHOUT_EFFECT), Definitions(file)
        account.elements(one)
        account.report(part)
        to.take(part)
    return to


class _Found:
    """A container or command with its layout."""

    def __init__(self, kind: str, element: Element, layout: Layout, more: Item, is_base: bool = False) -> None:
        """``more`` are keys of the message, ``is_base`` of a container on which others are based."""
        self.is_base = is_base
        self.kind, self.element, self.layout, self.more = kind, element, layout, more
        self.name = called(element)
        self.told: dict[Hashable, int] = {one.reference: layout.tell(one) for one in layout.told}
        self.header = packets.header((part.at, part.bits, part.item.get("const")) for part in layout.parts)
        first = next(iter(layout.parts), None)
        is_id = first is not None and first.is_message_id
        self.front: tuple[Hashable, int] | None = (first.reference, first.bits) if first and is_id else None

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """As it stands in an ICD. Raises `NotHeld`."""
        made = {"name": self.name, "id": id, "kind": self.kind, "length": 0, **self.more}
        lost = [part for part in self.layout.parts if part.at < start and not self._is_ahead(part, start)]
        if lost:
            shown = ", ".join(f"`{one.path[-1]}`" for one in lost)
            text = f"message `{self.name}`: {shown} lies within the header"
            to.warn(IN_HEADER, text, "it is left out: the parts of a header have their own meaning", "error")
        message = self.layout.laid_out(made, start, BIG, to)
        if self.layout.lost is not None:
            self.layout.lost.report(self.name, to, *self.layout.names.place(self.element))
        return message

    def _is_ahead(self, part: Part, start: int) -> bool:
        """Whether a part is one of what stands in front of the data: of the primary header, or the id."""
        at, bits = part.at, part.bits
        return packets.is_of_header(at, bits) if self.header is not None else (at, bits) == (0, start)


def _all(names: Names, types: Types, to: Definitions) -> Iterator[_Found]:
    """Everything that is sent, in the order of the file; what is not imported is noted."""
    bases = _used(names, "BaseContainer")
    for element in _containers(names, bases):
        to.total += 1
        types.message = called(element)
        layout = Layout(names, types)
        try:
            layout.read(element)
            more = {**_group(names, element), **described(element)}
            yield _Found(_TELEMETRY, element, layout, more, id(element) in bases)
        except NotHeld as why:
            to.left_out(element.get("name", ""), why, *names.place(element))
            settle(element)
    for element in names.all("command"):
        if element.tag != "MetaCommand" or element.get("abstract") == "true":
            continue
        to.total += 1
        types.message = called(element)
        try:
            chain = names.commands(element)
            layout = Layout(names, types, _arguments(chain))
            container = names.container_of(element)
            if container is None:
                raise NotHeld("it has no container, which says how it is sent")
            layout.read(container)
            assigned: dict[str, str] = {}
            for base in chain:
                for one in base.iterfind("BaseMetaCommand/ArgumentAssignmentList/ArgumentAssignment"):
                    assigned.setdefault(one.get("argumentName", ""), one.get("argumentValue", ""))
            for name, value in assigned.items():
                layout.told.append(Told(layout.argument(name), value, is_raw=False))
            more = {**_group(names, element), **_hazard(chain), **described(element)}
            yield _Found(_TELECOMMAND, element, layout, more)
        except NotHeld as why:
            to.left_out(element.get("name", ""), why, *names.place(element))
            settle(element)


def _identified(found: list[_Found], to: Definitions) -> list[_Found]:
    """The messages without containers that only others are based on: nothing says of which application process they are."""
    is_packet = any(one.header is not None for one in found)
    bases = [one for one in found if is_packet and one.is_base and (one.header is None or one.header.apid is None)]
    if bases:
        shown = ", ".join(f"`{base.name}`" for base in bases[:3]) + (" ..." if len(bases) > 3 else "")
        what = "1 container is" if len(bases) == 1 else f"{len(bases)} containers are"
        text = f"{what} without an application process: {shown}"
        to.warn(BASE_ONLY, text, "others are based on them, which are messages", "note")
        to.total -= len(bases)
    return [one for one in found if one not in bases]


def _containers(names: Names, bases: set[int]) -> list[Element]:
    """Those that are sent by themselves: not abstract, and no mere part or base of others."""
    parts = bases | _used(names, "EntryList/ContainerRefEntry")
    concrete = (
        one for one in names.all("container") if one.tag == "SequenceContainer" and one.get("abstract") != "true"
    )
    return [one for one in concrete if one.find("BaseContainer") is not None or id(one) not in parts]


def _used(names: Names, path: str) -> set[int]:
    """The containers to which elements of others refer, by `id`."""
    used: set[int] = set()
    for one in (*names.all("container"), *names.all("command container")):
        for reference in one.iterfind(path):
            try:
                used.add(id(names.container(reference.get("containerRef", ""), one)))
            except NotHeld:
                continue  # reported where it is read
    return used


def _arguments(chain: list[Element]) -> dict[str, Element]:
    result: dict[str, Element] = {}
    for command in chain:
        for element in command.iterfind("ArgumentList/Argument"):
            result.setdefault(element.get("name", ""), element)
    return result


def _paired(messages: list[Item]) -> list[Item]:
    """A telecommand and a telemetry frame of one name that have the same fields are one configuration message, set and got."""
    sent = {(message["name"], message.get("group")): message for message in messages if message["kind"] == _TELECOMMAND}
    made: list[Item] = []
    gone: set[int] = set()
    for one in messages:
        other = sent.get((one["name"], one.get("group"))) if one["kind"] == _TELEMETRY else None
        if other is None or id(other) in gone or not _is_same(one, other):
            made.append(one)
            continue
        gone.add(id(other))
        head = {"name": one["name"], "kind": "configuration", "set_id": other["id"], "get_id": one["id"]}
        rest = {key: value for key, value in {**other, **one}.items() if key not in ("name", "kind", "id")}
        made.append({**head, **rest})
    return [one for one in made if id(one) not in gone]


def _is_same(one: Item, other: Item) -> bool:
    """Whether messages have the same fields, but for constants, whose type only telemetry has, and views."""

    def plain(message: Item) -> list[Item]:
        fields = (field for field in message.get("fields", ()) if not field.get("view"))
        return [{"at": f["at"], "bits": f["const"] & (1 << f["bits"]) - 1} if "const" in f else f for f in fields]

    return one["length"] == other["length"] and plain(one) == plain(other)


def _group(names: Names, element: Element) -> Item:
    """The system, but for the outermost; of what icdgen wrote the group of its ICD."""
    if group := beside(element).get("group"):
        return {"group": line(group, 200)}
    inner = names.system(element).split("/")[2:]
    return {"group": line(" ".join(inner), 200)} if inner else {}


def _hazard(chain: list[Element]) -> Item:
    said = next((element for command in chain for element in command.iterfind("DefaultSignificance")), None)
    if said is None or said.get("consequenceLevel", "none") not in _HAZARDOUS:
        return {}
    return {
        "hazard": line(said.get("reasonForWarning"), 400) or f"Its consequences are {said.get('consequenceLevel')}."
    }
