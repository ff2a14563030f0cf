"""Reader of XTCE databases (CCSDS 660.0, OMG): telemetry containers and commands as
messages.

Containers that begin with the primary header of a space packet become packets.
`xtce_files` groups files into databases, `xtce_names` resolves references,
`xtce_layout` reads the entries of a container and `xtce_types` the types of the
entries.
"""

from __future__ import annotations

import os
from collections.abc import Hashable, Iterator, Mapping, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from icdgen.definitions import packets, safe_xml, xtce_files
from icdgen.definitions.accounting import Account, settle
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import (
    Definitions,
    Item,
    Network,
    NotSupported,
    SourceFile,
)
from icdgen.definitions.wording import line, node_name
from icdgen.definitions.xtce_layout import RequiredValue, XtceLayout
from icdgen.definitions.xtce_names import XtceNames, ancillary_data, name_of
from icdgen.definitions.xtce_parts import XtcePart
from icdgen.definitions.xtce_types import XtceTypes, described
from icdgen.diagnostics import Findings

_TELECOMMAND, _TELEMETRY = packets.TELECOMMAND, packets.TELEMETRY
_WITHOUT_EFFECT = frozenset(
    {
        "schemaLocation",
        "SpaceSystem.Header",  # author and history
        "ArrayParameterType.numberOfDimensions",  # redundant: the dimensions are listed
        "ArrayArgumentType.numberOfDimensions",
    }
    # They describe the calibrated value; `xtce_types` reads them only if there is no
    # encoding.
    | {
        f"{kind}{of}Type.{key}"
        for kind in ("Integer", "Float")
        for of in ("Parameter", "Argument")
        for key in ("signed", "sizeInBits")
    }
)
IN_HEADER, BASE_ONLY = "IMP086", "IMP087"
_HAZARDOUS = frozenset({"vital", "critical", "severe"})


class Xtce:
    """Reader of XTCE 1.1 and 1.2."""

    name = "xtce"
    title = "telemetry and commands (XTCE)"
    needs: tuple[str, ...] = ("defusedxml",)

    def knows(self, start: str) -> bool:
        return safe_xml.root_of(start) == "SpaceSystem"

    def read(self, file: str, data: bytes) -> Definitions:
        """Return the messages of one file.

        Raises `Findings` if its XML cannot be read.
        """
        root = safe_xml.parse(file, data, account=Account())
        return _define({file: root}, Definitions(file), node_name(file))

    def read_set(self, sources: Sequence[SourceFile]) -> list[Definitions]:
        """Return the definitions of each database, a set of files with references
        between them.

        A database of several files has the name of their common folder. A file that
        cannot be read gets an error.
        """
        roots: dict[str, Element] = {}
        result: list[Definitions] = []
        for source in sources:
            try:
                roots[source.file] = safe_xml.parse(
                    source.file, source.data, account=Account()
                )
            except Findings as error:
                result.append(Definitions(source.file))
                result[-1].refuse(error)
        for files in xtce_files.sets(roots):
            first = next(iter(files))
            folder = Path(
                os.path.commonpath([Path(file).absolute().parent for file in files])
            )
            name = node_name(first if len(files) == 1 else f"{folder.name}.xml")
            result.append(_define(files, Definitions(first, more=len(files) - 1), name))
        return result


def _define(roots: Mapping[str, Element], to: Definitions, name: str) -> Definitions:
    """Add the network of one database, which may consist of several files, to its
    definitions and return them.
    """
    names = XtceNames(roots, to)
    types = XtceTypes(to, names)
    messages = _identified(list(_all(names, types, to)), to)
    types.report_raw_only()
    root = next(iter(roots.values()))
    title = line(name_of(root), 100) if len(roots) == 1 else ""
    network = Network(
        name, title or name, {**ORDERS[BIG], **(described(root) if title else {})}
    )
    packets.fill(network, messages, to)
    network.messages = _paired(network.messages)
    network.name_messages_apart(to)
    network.declare(types.enums.declared())
    to.networks.append(network)
    for file, tree in roots.items():
        account, part = Account(_WITHOUT_EFFECT), Definitions(file)
        account.elements(tree)
        account.report(part)
        to.take(part)
    return to


class _Candidate:
    """Container or command with its layout."""

    def __init__(
        self,
        kind: str,
        element: Element,
        layout: XtceLayout,
        more: Item,
        is_base: bool = False,
    ) -> None:
        """``more`` are further keys of the message.

        ``is_base`` is true for a container that others inherit.
        """
        self.is_base = is_base
        self.kind, self.element, self.layout, self.more = kind, element, layout, more
        self.name = name_of(element)
        self.constants: dict[Hashable, int] = {
            required.reference: layout.fix_value(required)
            for required in layout.required_values
        }
        self.header = packets.header(
            (part.at, part.bits, part.item.get("const")) for part in layout.parts
        )
        first = next(iter(layout.parts), None)
        is_id = first is not None and first.is_message_id
        self.front: tuple[Hashable, int] | None = (
            (first.reference, first.bits) if first and is_id else None
        )

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """Return the message of the ICD, with the fields from bit ``start`` on.

        Raises `NotSupported`.

        Reports parts between the primary header and ``start``, which have no place in
        an ICD.
        """
        head = {
            "name": self.name,
            "id": id,
            "kind": self.kind,
            "length": 0,
            **self.more,
        }
        lost = [
            part
            for part in self.layout.parts
            if part.at < start and not self._is_ahead(part, start)
        ]
        if lost:
            shown = ", ".join(f"`{part.path[-1]}`" for part in lost)
            text = f"message `{self.name}`: {shown} lies within the header"
            to.warn(
                IN_HEADER,
                text,
                "it is left out: the parts of a header have their own meaning",
                "error",
            )
        message = self.layout.laid_out(head, start, BIG, to)
        if self.layout.lost is not None:
            self.layout.lost.report(
                self.name, to, *self.layout.names.place(self.element)
            )
        return message

    def _is_ahead(self, part: XtcePart, start: int) -> bool:
        """Whether a part belongs to the primary header or, without one, is the message
        id.
        """
        at, bits = part.at, part.bits
        return (
            packets.is_of_header(at, bits)
            if self.header is not None
            else (at, bits) == (0, start)
        )


def _all(names: XtceNames, types: XtceTypes, to: Definitions) -> Iterator[_Candidate]:
    """Return the telemetry containers and commands in the order of the file.

    Reports unsupported ones.
    """
    bases = _used(names, "BaseContainer")
    for element in _containers(names, bases):
        to.total += 1
        types.message = name_of(element)
        layout = XtceLayout(names, types)
        try:
            layout.read(element)
            more = {**_group(names, element), **described(element)}
            yield _Candidate(_TELEMETRY, element, layout, more, id(element) in bases)
        except NotSupported as why:
            to.left_out(element.get("name", ""), why, *names.place(element))
            settle(element)
    for element in names.all("command"):
        if element.tag != "MetaCommand" or element.get("abstract") == "true":
            continue
        to.total += 1
        types.message = name_of(element)
        try:
            chain = names.commands(element)
            layout = XtceLayout(names, types, _arguments(chain))
            container = names.container_of(element)
            if container is None:
                raise NotSupported("it has no container, which says how it is sent")
            layout.read(container)
            assigned: dict[str, str] = {}
            for base in chain:
                for assignment in base.iterfind(
                    "BaseMetaCommand/ArgumentAssignmentList/ArgumentAssignment"
                ):
                    assigned.setdefault(
                        assignment.get("argumentName", ""),
                        assignment.get("argumentValue", ""),
                    )
            # The chain begins with the derived command, so its assignments take
            # precedence.
            for name, value in assigned.items():
                layout.required_values.append(
                    RequiredValue(layout.argument(name), value, is_raw=False)
                )
            more = {**_group(names, element), **_hazard(chain), **described(element)}
            yield _Candidate(_TELECOMMAND, element, layout, more)
        except NotSupported as why:
            to.left_out(element.get("name", ""), why, *names.place(element))
            settle(element)


def _identified(candidates: list[_Candidate], to: Definitions) -> list[_Candidate]:
    """Remove base containers without an application process identifier (APID), and
    report them (IMP087).

    Applies only to databases of space packets. The containers that inherit the base
    ones are the messages.
    """
    if all(candidate.header is None for candidate in candidates):
        return candidates
    bases = [
        candidate
        for candidate in candidates
        if candidate.is_base
        and (candidate.header is None or candidate.header.apid is None)
    ]
    if bases:
        shown = ", ".join(f"`{base.name}`" for base in bases[:3]) + (
            " ..." if len(bases) > 3 else ""
        )
        what = "1 container is" if len(bases) == 1 else f"{len(bases)} containers are"
        text = f"{what} without an application process: {shown}"
        to.warn(BASE_ONLY, text, "others are based on them, which are messages", "note")
        to.total -= len(bases)
    return [candidate for candidate in candidates if candidate not in bases]


def _containers(names: XtceNames, bases: set[int]) -> list[Element]:
    """Return the containers that are messages: not abstract, and not only a base or a
    part of others.
    """
    parts = bases | _used(names, "EntryList/ContainerRefEntry")
    concrete = (
        container
        for container in names.all("container")
        if container.tag == "SequenceContainer" and container.get("abstract") != "true"
    )
    return [
        container
        for container in concrete
        if container.find("BaseContainer") is not None or id(container) not in parts
    ]


def _used(names: XtceNames, path: str) -> set[int]:
    """Return `id` of each container that an element at ``path`` of another container
    refers to.
    """
    used: set[int] = set()
    for container in (*names.all("container"), *names.all("command container")):
        for reference in container.iterfind(path):
            try:
                used.add(
                    id(names.container(reference.get("containerRef", ""), container))
                )
            except NotSupported:
                continue  # reported where it is read
    return used


def _arguments(chain: list[Element]) -> dict[str, Element]:
    """Return the arguments of a command and of its base commands by name.

    The derived command takes precedence.
    """
    result: dict[str, Element] = {}
    for command in chain:
        for element in command.iterfind("ArgumentList/Argument"):
            result.setdefault(element.get("name", ""), element)
    return result


def _paired(messages: list[Item]) -> list[Item]:
    """Merge each telecommand and telemetry frame with equal name, group and fields into
    one configuration message.
    """
    sent = {
        (message["name"], message.get("group")): message
        for message in messages
        if message["kind"] == _TELECOMMAND
    }
    result: list[Item] = []
    merged: set[int] = set()
    for message in messages:
        command = (
            sent.get((message["name"], message.get("group")))
            if message["kind"] == _TELEMETRY
            else None
        )
        if command is None or id(command) in merged or not _is_same(message, command):
            result.append(message)
            continue
        merged.add(id(command))
        head = {
            "name": message["name"],
            "kind": "configuration",
            "set_id": command["id"],
            "get_id": message["id"],
        }
        body = {
            key: value
            for key, value in {**command, **message}.items()
            if key not in ("name", "kind", "id")
        }
        result.append({**head, **body})
    return [message for message in result if id(message) not in merged]


def _is_same(first: Item, second: Item) -> bool:
    """Whether the fields of two messages are equal.

    Ignores overlay fields. Compares constants by position and raw value, as only
    telemetry has their type.
    """

    def plain(field: Item) -> Item:
        if "const" not in field:
            return field
        return {"at": field["at"], "bits": field["const"] & (1 << field["bits"]) - 1}

    def plain_fields(message: Item) -> list[Item]:
        return [plain(f) for f in message.get("fields", ()) if not f.get("view")]

    return first["length"] == second["length"] and (
        plain_fields(first) == plain_fields(second)
    )


def _group(names: XtceNames, element: Element) -> Item:
    """Return the group of a message: that of its ICD if icdgen wrote the file, else the
    path below the root system.
    """
    if group := ancillary_data(element).get("group"):
        return {"group": line(group, 200)}
    inner = names.system(element).split("/")[2:]
    return {"group": line(" ".join(inner), 200)} if inner else {}


def _hazard(chain: list[Element]) -> Item:
    """Return the hazard of a command with a `DefaultSignificance` of vital, critical or
    severe consequences.
    """
    significance = next(
        (
            element
            for command in chain
            for element in command.iterfind("DefaultSignificance")
        ),
        None,
    )
    if (
        significance is None
        or significance.get("consequenceLevel", "none") not in _HAZARDOUS
    ):
        return {}
    return {
        "hazard": line(significance.get("reasonForWarning"), 400)
        or f"Its consequences are {significance.get('consequenceLevel')}."
    }
