"""XTCE (CCSDS 660.0, OMG): containers of telemetry and commands, in space packets where they begin with their header."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from xml.etree.ElementTree import Element

from icdgen.definitions import packets, safe_xml
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import Definitions, Item, Network, NotHeld
from icdgen.definitions.wording import line, node_name
from icdgen.definitions.xtce_layout import Layout, Part, Told
from icdgen.definitions.xtce_names import Names, beside, called
from icdgen.definitions.xtce_types import Types, described

_TELECOMMAND, _TELEMETRY = packets.TELECOMMAND, packets.TELEMETRY
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
        to = Definitions(file)
        root = safe_xml.parse(file, data)
        names = Names(file, root)
        types = Types(to, names)
        found = list(_all(names, types, to))
        title = line(called(root), 100) or node_name(file)
        network = Network(node_name(file), title, {**ORDERS[BIG], **described(root)})
        packets.fill(network, found, to)
        network.messages = _paired(network.messages)
        packets.apart(network.messages)
        network.declare(types.enums.declared())
        to.networks.append(network)
        return to


class _Found:
    """A container or command with its layout."""

    def __init__(self, kind: str, element: Element, layout: Layout, more: Item) -> None:
        """``more`` are keys of the message."""
        self.kind, self.element, self.layout, self.more = kind, element, layout, more
        self.name = called(element)
        self.told: dict[Hashable, int] = {id(one.of): layout.tell(one) for one in layout.told}
        ahead = [one for one in layout.parts[: packets.MOST_PARTS] if "count" not in one.item]
        self.header = packets.header((one.at, one.piece.bits, one.item.get("const")) for one in ahead)
        first = next(iter(layout.parts), None)
        is_id = first is not None and _is_id(first)
        self.front: tuple[Hashable, int] | None = (id(first.of), first.piece.bits) if first and is_id else None

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """As it stands in an ICD. Raises `NotHeld`."""
        made = {"name": self.name, "id": id, "kind": self.kind, "length": 0, **self.more}
        return self.layout.laid_out(made, start, BIG, to)


def _all(names: Names, types: Types, to: Definitions) -> Iterator[_Found]:
    """Everything that is sent, in the order of the file; what is not held is noted."""
    for element in _containers(names):
        to.total += 1
        layout = Layout(names, types)
        try:
            layout.add(element)
            yield _Found(_TELEMETRY, element, layout, {**_group(names, element), **described(element)})
        except NotHeld as why:
            to.left_out(element.get("name", ""), why)
    for element in names.all("command"):
        if element.tag != "MetaCommand" or element.get("abstract") == "true":
            continue
        to.total += 1
        try:
            chain = _commands(names, element)
            layout = Layout(names, types, _arguments(chain))
            container = next((one for of in chain if (one := of.find("CommandContainer")) is not None), None)
            if container is None:
                raise NotHeld("it has no container, which says how it is sent")
            layout.add(container)
            assigned: dict[str, str] = {}
            for base in chain:
                for one in base.iterfind("BaseMetaCommand/ArgumentAssignmentList/ArgumentAssignment"):
                    assigned.setdefault(one.get("argumentName", ""), one.get("argumentValue", ""))
            for name, value in assigned.items():
                if name not in layout.arguments:
                    raise NotHeld(f"there is no argument `{line(name, 60)}` to be given a value")
                layout.told.append(Told(layout.arguments[name], value, is_raw=False))
            more = {**_group(names, element), **_hazard(chain), **described(element)}
            yield _Found(_TELECOMMAND, element, layout, more)
        except NotHeld as why:
            to.left_out(element.get("name", ""), why)


def _containers(names: Names) -> list[Element]:
    """Those that are sent by themselves: not abstract, and no mere part or base of others."""
    all_ = [one for one in names.all("container") if one.tag == "SequenceContainer"]
    parts: set[int] = set()
    for one in (*all_, *(inner for command in names.all("command") for inner in command.iterfind("CommandContainer"))):
        references = [
            *(entry.get("containerRef", "") for entry in one.iterfind("EntryList/ContainerRefEntry")),
            *(base.get("containerRef", "") for base in one.iterfind("BaseContainer")),
        ]
        for reference in references:
            try:
                parts.add(id(names.find("container", reference, one)))
            except NotHeld:
                continue  # said where it is read
    concrete = (one for one in all_ if one.get("abstract") != "true")
    return [one for one in concrete if one.find("BaseContainer") is not None or id(one) not in parts]


def _commands(names: Names, element: Element) -> list[Element]:
    """A command, and those on which it is based. Raises `NotHeld` for a circle."""
    chain = [element]
    while (base := chain[-1].find("BaseMetaCommand")) is not None:
        found = names.find("command", base.get("metaCommandRef", ""), chain[-1])
        if any(found is one for one in chain):
            raise NotHeld("commands are based on each other in a circle")
        chain.append(found)
    return chain


def _arguments(chain: list[Element]) -> dict[str, Element]:
    found: dict[str, Element] = {}
    for command in chain:
        for one in command.iterfind("ArgumentList/Argument"):
            found.setdefault(one.get("name", ""), one)
    return found


def _is_id(part: Part) -> bool:
    """Whether a header can have it as an id."""
    is_whole = part.at == 0 and part.piece.bits in (8, 16, 24, 32) and part.piece.order == BIG
    return is_whole and part.item["type"] in ("uint", "enum") and "formula" not in part.item


def _paired(messages: list[Item]) -> list[Item]:
    """A telecommand and a telemetry frame of one name that have the same fields are one configuration message, set and got."""
    sent = {(one["name"], one.get("group")): one for one in messages if one["kind"] == _TELECOMMAND}
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
    said = next((one for command in chain for one in command.iterfind("DefaultSignificance")), None)
    if said is None or said.get("consequenceLevel", "none") not in _HAZARDOUS:
        return {}
    return {
        "hazard": line(said.get("reasonForWarning"), 400) or f"Its consequences are {said.get('consequenceLevel')}."
    }
