"""A node -> what its module says: constants, modules, and the sum types of all that it speaks."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import names
from icdgen.backends.rust.messages import MessageRow
from icdgen.backends.rust.text import CALL_WIDTH, WIDTH, arm, doc, integer, prose, rhs, sentence
from icdgen.icd.model import Icd, Node

ARM = "            "


def id_type(icd: Icd) -> str:
    """The integer for the ids of all nodes."""
    return "u8" if all(id < 256 for node in icd.nodes for message in node.messages for id in message.ids) else "u16"


class Summary:
    """A node as the crate's front page lists it."""

    def __init__(self, node: Node) -> None:
        self.name = node.name
        about = sentence(prose(node.summary)) if node.summary else ""
        item = f"[`{self.name}`], {sentence(prose(node.title))} {about}".rstrip()
        self.doc = doc([item], mark="//!  ").replace("//!  ", "//! -", 1)


class Variant(NamedTuple):
    """A message in a sum type."""

    declaration: str
    decode: str
    id: str
    length: str
    name: str
    write: str


class SumType:
    """``Telemetry`` or ``Telecommand``."""

    def __init__(self, name: str, id_type: str, variants: list[Variant], floats: bool) -> None:
        self.name, self.id_type, self.variants = name, id_type, variants
        self.derives = "Clone, Copy, Debug, PartialEq" + ("" if floats else ", Eq, Hash")
        self.direction = name.lower()
        self.id_for_error = "id" if id_type == "u16" else "id: u16::from(id)"


class NodeRow:
    """What the template of a node is given."""

    def __init__(self, icd: Icd, node: Node, rows: dict[str, list[MessageRow]]) -> None:
        self.name = node.name
        about = sentence(prose(node.summary)) if node.summary else ""
        printed = ", ".join(f"{prose(key)} {prose(value)}" for key, value in node.document)
        included = ", ".join(f"[`{one.name}`](crate::{one.name})" for one in icd.included(node))
        self.doc = doc(
            [
                f"{sentence(prose(node.title))} {about}".rstrip(),
                sentence(f"Source: {printed}") if printed else "",
                f"It also speaks the messages of {included}." if included else "",
            ],
            mark="//!",
        )
        self.has_enums = bool(node.enums)
        self.node_type = None if node.node_type is None else (unsigned(node.node_type), integer(node.node_type))
        version = node.interface_version
        self.interface_version = None if version is None else (unsigned(version), integer(version))
        self.messages = rows[node.name]
        spoken = [row for one in (*icd.included(node), node) for row in rows[one.name]]
        kind = id_type(icd)
        sums = (("Telecommand", "telecommand_id"), ("Telemetry", "telemetry_id"))
        self.sums = [self._sum(name, pick, spoken, kind) for name, pick in sums]
        self.sums = [one for one in self.sums if one.variants]

    def _sum(self, name: str, pick: str, spoken: list[MessageRow], kind: str) -> SumType:
        chosen = [row for row in spoken if getattr(row.message, pick) is not None]
        pair = "SET_ID" if pick == "telecommand_id" else "GET_ID"
        variants = [self._variant(row, "ID" if row.message.id is not None else pair) for row in chosen]
        return SumType(name, kind, variants, any(row.floats for row in chosen))

    def _variant(self, row: MessageRow, id: str) -> Variant:
        path = row.type if row.node.name == self.name else f"crate::{row.node.name}::{row.type}"
        about = doc([sentence(prose(row.message.name))], "    ")
        pattern, number = f"Self::{row.type}(message)", f"{path}::{id}"
        value = f"{path}::from_bytes(bytes)?"
        decode = f"{ARM}{number} => Self::{row.type}({value}),"
        if len(decode) > WIDTH or len(value) > CALL_WIDTH:
            bound = rhs(f"{ARM}    ", "let message =", value, ";")
            decode = f"{ARM}{number} => {{\n{bound}\n{ARM}    Self::{row.type}(message)\n{ARM}}}"
        to_bytes = "message.try_to_bytes()?" if row.fits else "message.to_bytes()"
        write = f"{ARM}{pattern} => write_to(buffer, &{to_bytes}),"
        if len(write) > WIDTH:
            write = (
                f"{ARM}{pattern} => {{\n{ARM}    let bytes = {to_bytes};\n{ARM}    write_to(buffer, &bytes)\n{ARM}}}"
            )
        bare = f"Self::{row.type}(_)"
        declaration = f"    {row.type}({path}),"
        if len(declaration) > WIDTH:
            declaration = f"    {row.type}(\n        {path},\n    ),"
        return Variant(
            f"{about}\n{declaration}",
            decode,
            arm(ARM, bare, number),
            arm(ARM, bare, f"{path}::LENGTH"),
            arm(ARM, bare, f"{path}::NAME"),
            write,
        )


def unsigned(value: int) -> str:
    """The smallest unsigned integer that holds the value."""
    return f"u{names.storage(value.bit_length())}"
