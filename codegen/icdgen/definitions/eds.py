"""Reader of electronic data sheets (SEDS, CCSDS 876.0-B-1).

Containers become messages, as space packets if they begin with a primary header.
`eds_sheets` resolves the names of a file, `eds_interfaces` chooses the containers,
`eds_layout` reads their entries and `eds_types` the types of the entries.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree.ElementTree import Element

from icdgen.definitions import eds_sheets, packets, safe_xml
from icdgen.definitions.accounting import Account, settle
from icdgen.definitions.eds_interfaces import Interfaces, Sending
from icdgen.definitions.eds_layout import EdsLayout, Structs
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import EdsTypes, described
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import (
    Definitions,
    Item,
    Network,
    NotSupported,
    SourceFile,
)
from icdgen.definitions.wording import line, node_name
from icdgen.diagnostics import Findings
from icdgen.wording import count

PROCESS, UNSENT = "IMP083", "IMP084"
_SPACE = "ccsds.org/schema/sois/seds"
_WITHOUT_EFFECT = frozenset({
    "schemaLocation", "Device.name", "ContainerDataType.abstract",
    # The initial values of variables give the topic ids of interfaces.
    "Variable.type", "Variable.readOnly",
})  # fmt: skip


class Eds:
    """Reader of package files and device data sheets.

    References may lead to other files in the folder.
    """

    name = "eds"
    title = "an electronic data sheet (CCSDS SOIS)"
    needs: tuple[str, ...] = ("defusedxml",)

    def knows(self, start: str) -> bool:
        root = safe_xml.root_of(start)
        return root == eds_sheets.PARAMETERS or (
            root in eds_sheets.ROOTS and _SPACE in start
        )

    def read(self, file: str, data: bytes) -> Definitions:
        """Read a data sheet.

        Raises `Findings` if the file, or an XML file in its folder, cannot be read.
        """
        account = Account(_WITHOUT_EFFECT)
        to = Definitions(file)
        sheets = Sheets(
            safe_xml.parse(file, data, account=account),
            eds_sheets.beside(file, len(data)),
            to,
        )
        _define(sheets, to)
        account.elements(sheets.root)
        account.report(to)
        return to

    def read_set(self, sources: Sequence[SourceFile]) -> list[Definitions]:
        """Return the definitions of each file.

        All files and their folders share types and design parameters.
        """
        results = [Definitions(source.file) for source in sources]
        roots: dict[str, Element] = {}
        for source, to in zip(sources, results, strict=True):
            try:
                roots[source.file] = safe_xml.parse(
                    source.file, source.data, account=Account()
                )
            except Findings as error:
                to.refuse(error)
        for to in results:
            if (root := roots.get(to.file)) is None:
                continue
            # Files of the import take precedence over other files of the folder.
            neighbours = [
                (path, neighbour)
                for path, neighbour in roots.items()
                if path != to.file
            ]
            neighbours += [
                (path, neighbour)
                for path, neighbour in eds_sheets.beside(to.file, 0)
                if path not in roots
            ]
            sheets = Sheets(root, neighbours, to)
            if sheets.own:
                _define(sheets, to)
        for to in results:
            if to.file in roots:
                account = Account(_WITHOUT_EFFECT)
                account.elements(roots[to.file])
                account.report(to)
        return results


def _define(sheets: Sheets, to: Definitions) -> None:
    """Add the ICD with the messages of all packages of a file."""
    types, structs = EdsTypes(to, sheets), Structs()
    sent, independent = Interfaces(sheets).sent()
    messages = (_read_message(sending, sheets, types, structs, to) for sending in sent)
    containers = [message for message in messages if message is not None]
    types.report_raw_only()
    network = Network(
        node_name(to.file), _title(sheets) or node_name(to.file), {**ORDERS[BIG]}
    )
    packets.fill(network, containers, to)
    network.name_messages_apart(to)
    _report_process(
        [container for container in containers if container.is_by_interface], to
    )
    _report_unsent(independent, sheets, to)
    network.structs = _used_structs(list(structs.items.values()), network.messages)
    network.declare(types.enums.declared())
    to.networks.append(network)


class _Message:
    """Container with its layout, kind and header, ready to become a message."""

    def __init__(
        self, sending: Sending, layout: EdsLayout, more: Item, sheets: Sheets
    ) -> None:
        self.container, self.layout, self.more = sending.container, layout, more
        self.name = line(f"{sending.container.get('name')} {sending.interface}", 200)
        self.line = sheets.line(sending.container)
        self.constants = layout.constants
        self.front = layout.front()
        # The type flag of the header takes precedence over the direction of the
        # interface.
        head = layout.header()
        self.kind = (
            (head.kind if head is not None else None)
            or sending.kind
            or packets.TELEMETRY
        )
        sending.kind = self.kind
        apid = sending.apid(sheets)
        self.is_by_interface = (
            head is not None and head.apid is None and apid is not None
        )
        self.parameter = sending.parameter
        self.header = (
            head._replace(apid=apid) if head is not None and head.apid is None else head
        )

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """Return the ICD message from the bit ``start`` on.

        Raises `NotSupported` if it is not supported.
        """
        fields = self.layout.fields(start)
        covered = max((part.end for part in self.layout.parts), default=start)
        first = self.layout.first_variable
        end = self.layout.at if first is None else first.at
        # Trailing padding belongs to the length, but no field covers it.
        length, covered = -(-(end - start) // 8), -(-(max(covered, start) - start) // 8)
        item: Item = {
            "name": self.name,
            "id": id,
            "kind": self.kind,
            "length": length,
            **self.more,
        }
        if self.layout.lost is not None:
            self.layout.lost.report(self.name, to, self.line)
        if length > covered:
            item["reserved"] = length - covered
        return {**item, "fields": fields} if fields else item


def _read_message(
    sending: Sending, sheets: Sheets, types: EdsTypes, structs: Structs, to: Definitions
) -> _Message | None:
    """Read the layout of a container.

    Returns None and adds a finding if the container cannot be imported.
    """
    to.total += 1
    container = sending.container
    types.message = line(container.get("name"), 200)
    layout = EdsLayout(sheets, types, structs)
    try:
        layout.read(container)
        return _Message(
            sending,
            layout,
            {**_group(sheets, container), **described(container)},
            sheets,
        )
    except NotSupported as why:
        to.left_out(line(container.get("name"), 200), why, sheets.line(container))
        settle(container)
        return None


def _title(sheets: Sheets) -> str:
    """Return the short description or name of the device, or else of the package."""
    device = sheets.root.find("Device")
    element = device if device is not None else sheets.root.find("Package")
    return (
        ""
        if element is None
        else line(element.get("shortDescription") or element.get("name"), 100)
    )


def _group(sheets: Sheets, container: Element) -> Item:
    """Return the package as the group of the message if the file has several packages."""
    return (
        {"group": line(sheets.package(container), 200)} if len(sheets.own) > 1 else {}
    )


def _used_structs(structs: list[Item], messages: list[Item]) -> list[Item]:
    """Return the structs that messages use, directly or through other structs."""
    by_name = {struct["name"]: struct for struct in structs}
    waiting, used = list(messages), set()
    while waiting:
        for field in waiting.pop().get("fields", ()):
            name = field.get("struct")
            if name is not None and name not in used:
                used.add(name)
                waiting.append(by_name[name])
    return [struct for struct in structs if struct["name"] in used]


def _report_process(containers: list[_Message], to: Definitions) -> None:
    """Report (IMP083) that application process ids are derived from interface
    parameters by convention.
    """
    if not containers:
        return
    parameters = "`, `".join(sorted({container.parameter for container in containers}))
    text = f"no application process is stated for {len(containers)} messages, only `{parameters}` of their interfaces"
    help = "their ids are computed as the library of cFS does; correct them if your mission has its own code for this"
    to.warn(PROCESS, text, help, line=containers[0].line)


def _report_unsent(containers: list[Element], sheets: Sheets, to: Definitions) -> None:
    if containers:
        shown = ", ".join(
            f"`{line(container.get('name'), 60)}`" for container in containers[:3]
        ) + (" ..." if len(containers) > 3 else "")
        text = f"no interface carries {count(len(containers), 'container')}: {shown}"
        to.warn(UNSENT, text, "they are left out", "note", sheets.line(containers[0]))
        for container in containers:
            settle(container)
