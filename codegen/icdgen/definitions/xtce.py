"""XTCE (CCSDS 660.0, OMG): containers of telemetry and commands, in space packets where they begin with their header."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from icdgen.definitions import safe_xml
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import Definitions, Item, Network, NotHeld
from icdgen.definitions.wording import line, node_name
from icdgen.definitions.xtce_layout import Layout, Part, Told
from icdgen.definitions.xtce_names import Names, beside, called
from icdgen.definitions.xtce_types import Types, described

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

UNTOLD = "IMP079"
_TELECOMMAND, _TELEMETRY = "telecommand", "telemetry"
_HEADER = (
    (0, 3),
    (3, 1),
    (4, 1),
    (5, 11),
    (16, 2),
    (18, 14),
    (32, 16),
)  # places of the primary header of a space packet
_VERSION, _TYPE, _SECONDARY, _APID, _SEQUENCE_FLAGS = range(5)
_HEADER_BITS = 48
_APID_BITS, _MOST_ID_BITS = 11, 32
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
        types = Types(names, to)
        found = list(_all(names, types, to))
        network = Network(
            node_name(file), line(called(root), 100) or node_name(file), {**ORDERS[BIG], **described(root)}
        )
        if any(one.is_packet for one in found):
            network.head["id_bits"] = _APID_BITS
            _packets(found, network, to)
        else:
            _counted(found, network, to)
        network.messages = _paired(network.messages)
        _apart(network.messages)
        declared = types.enums.declared()
        used = {one.get("enum") for message in network.messages for one in message.get("fields", ())}
        network.enums = [one for one in declared if one["name"] in used]
        to.networks.append(network)
        return to


class _Found:
    """A container or command with its layout."""

    def __init__(self, kind: str, element: Element, layout: Layout, more: Item) -> None:
        """``more`` are keys of the message."""
        self.kind, self.element, self.layout, self.more = kind, element, layout, more
        self.name = called(element)
        self.told = {id(one.of): layout.tell(one) for one in layout.told}

    @property
    def is_packet(self) -> bool:
        """Whether it begins with the primary header of a space packet."""
        first = [(one.at, one.piece.bits) for one in self.layout.parts[: len(_HEADER)]]
        return first == list(_HEADER) and all("count" not in one.item for one in self.layout.parts[: len(_HEADER)])

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """As it stands in an ICD. Raises `NotHeld`."""
        made = {"name": self.name, "id": id, "kind": self.kind, "length": 0, **self.more}
        return self.layout.laid_out(made, start, BIG, to)

    def header(self, part: int) -> int | None:
        """The only value of a field of the header."""
        value = self.layout.parts[part].item.get("const")
        return None if value is None else int(value)


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
    return [
        one
        for one in all_
        if one.get("abstract") != "true" and (one.find("BaseContainer") is not None or id(one) not in parts)
    ]


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


def _packets(found: list[_Found], network: Network, to: Definitions) -> None:
    """Messages of space packets: the header is the envelope, and the application process the id."""
    held: list[_Found] = []
    for one in found:
        try:
            if not one.is_packet:
                raise NotHeld("it does not begin with the header of a space packet, as others do")
            id, type_ = one.header(_APID), one.header(_TYPE)
            if id is None:
                raise NotHeld("nothing says of which application process it is")
            if one.header(_VERSION) or type_ not in (None, int(one.kind == _TELECOMMAND)):
                raise NotHeld(f"its header is not that of a space packet with {one.kind}")
            network.messages.append(one.message(id, _HEADER_BITS, to))
            held.append(one)
        except NotHeld as why:
            to.left_out(one.name, why)
    network.protocol = {
        "stream": {
            "delimited_by": "length",
            "header": [
                {"at": 0, "bits": 3, "role": "constant", "value": 0},
                {"at": 3, "bits": 1, "role": "constant", "value": {_TELECOMMAND: 1, _TELEMETRY: 0}},
                {"at": 4, "bits": 1, "role": "flags", **_usual(held, _SECONDARY)},
                {"at": 5, "bits": _APID_BITS, "role": "id"},
                {
                    "at": 16,
                    "bits": 2,
                    "role": "type",
                    "value": 3,
                },  # a packet of its own, unless the sender says otherwise
                {"at": 18, "bits": 14, "role": "sequence", "per": "id"},
                {"at": 32, "bits": 16, "role": "length", "plus": -1},
            ],
        }
    }


def _usual(held: list[_Found], part: int) -> Item:
    """The value of a part of the header that all messages of a direction have."""
    values = {kind: {one.header(part) for one in held if one.kind == kind} for kind in (_TELECOMMAND, _TELEMETRY)}
    said = {kind: of.copy().pop() if len(of) == 1 else None for kind, of in values.items()}
    if all(value is None for value in said.values()):
        return {}
    return {"value": {kind: value or 0 for kind, value in said.items()}}


def _counted(found: list[_Found], network: Network, to: Definitions) -> None:
    """Messages without a header: ids are what tells all of a direction, or counted."""
    widest, start = 8, _id_in_front(found)
    if start:
        network.protocol = {"stream": {"delimited_by": "none", "header": [{"at": 0, "bits": start, "role": "id"}]}}
    for kind in (_TELEMETRY, _TELECOMMAND):
        ours = [one for one in found if one.kind == kind]
        tells = _telling(ours)
        untold = []
        for number, one in enumerate(ours, 1):
            id = one.told[tells] if tells is not None else number
            widest = max(widest, id.bit_length())
            if tells is None:
                untold.append(one.name)
            try:
                network.messages.append(one.message(id, start, to))
            except NotHeld as why:
                to.left_out(one.name, why)
        if len(untold) > 1:
            shown = ", ".join(f"`{name}`" for name in untold[:3]) + (" ..." if len(untold) > 3 else "")
            to.warn(
                UNTOLD,
                f"no parameter tells all {len(untold)} messages of {kind}: {shown}",
                "their ids are counted from 1",
            )
    network.head["id_bits"] = widest


def _id_in_front(found: list[_Found]) -> int:
    """The bits of what tells all messages, where all of both directions begin with it and it is whole bytes; else 0."""
    sizes = set()
    for kind in (_TELEMETRY, _TELECOMMAND):
        ours = [one for one in found if one.kind == kind]
        tells = _telling(ours)
        for one in ours:
            first = next(iter(one.layout.parts), None)
            is_id = first is not None and tells is not None and id(first.of) == tells
            sizes.add(first.piece.bits if is_id and first is not None and _is_id(first) else 0)
    size, *others = sizes or {0}
    return 0 if others else size


def _is_id(part: Part) -> bool:
    """Whether a header can have it as an id."""
    is_whole = part.at == 0 and part.piece.bits in (8, 16, 24, 32) and part.piece.order == BIG
    return is_whole and part.item["type"] in ("uint", "enum") and "formula" not in part.item


def _telling(ours: list[_Found]) -> int | None:
    """What has one value in each message, of those the one with the most different ones."""
    common = [key for key in (ours[0].told if ours else ()) if all(key in one.told for one in ours)]
    fits = [key for key in common if all(0 <= one.told[key] < 1 << _MOST_ID_BITS for one in ours)]
    return max(fits, key=lambda key: len({one.told[key] for one in ours}), default=None)


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


def _apart(messages: list[Item]) -> None:
    """Messages of one name get their system in front, or what they are, or a number."""
    for said in (lambda one: one.get("group", ""), lambda one: one["kind"], lambda one: str(one["id"])):
        times = Counter(one["name"] for one in messages)
        for one in messages:
            if times[one["name"]] > 1 and (more := said(one)):
                one["name"] = f"{more} {one['name']}"


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
