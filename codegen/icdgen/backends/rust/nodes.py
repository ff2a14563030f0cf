"""A node -> what its module says: constants, modules, and the sum types of all that it speaks."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import names
from icdgen.backends.rust.messages import MessageRow
from icdgen.backends.rust.text import arm, doc, integer, prose
from icdgen.describe import MessageDescription, NodeDescription
from icdgen.describe.comments import sentence
from icdgen.describe.storage import holding
from icdgen.icd.model import Node


class Summary:
    """A node as the crate's front page lists it."""

    def __init__(self, node: Node) -> None:
        self.name = node.name
        item = f"[`{node.name}`], {prose(sentence(node.title))} {prose(sentence(node.summary))}".rstrip()
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

    def __init__(self, name: str, id_bits: int, variants: list[Variant], floats: bool) -> None:
        self.name, self.id_type, self.variants = name, f"u{id_bits}", variants
        self.derives = "Clone, Copy, Debug, PartialEq" + ("" if floats else ", Eq, Hash")
        self.direction = name.lower()
        self.id_for_error = "id" if id_bits == 32 else "id: u32::from(id)"


class NodeRow:
    """What the template of a node is given."""

    def __init__(self, node: NodeDescription, messages: list[MessageRow], id_bits: int) -> None:
        one, spoken = node.model, dict.fromkeys(message.node.name for message in node.spoken)
        self.name = node.name
        printed = ", ".join(f"{key} {value}" for key, value in one.document)
        included = ", ".join(f"[`{name}`](crate::{name})" for name in spoken if name != node.name)
        self.doc = doc(
            [
                f"{prose(sentence(one.title))} {prose(sentence(one.summary))}".rstrip(),
                prose(sentence(f"Source: {printed}")) if printed else "",
                f"It also speaks the messages of {included}." if included else "",
            ],
            mark="//!",
        )
        self.has_enums = bool(node.enums)
        self.node_type, self.interface_version = _number(one.node_type), _number(one.interface_version)
        self.messages = [(message.name, row.type) for message, row in zip(node.messages, messages, strict=True)]
        sums = (
            ("Telecommand", [(m, m.telecommand_id_name) for m in node.telecommands]),
            ("Telemetry", [(m, m.telemetry_id_name) for m in node.telemetry]),
        )
        self.sums = [
            SumType(name, id_bits, [_variant(m, id, one) for m, id in pairs], any(m.has_floats for m, _ in pairs))
            for name, pairs in sums
            if pairs
        ]


def _variant(message: MessageDescription, id_name: str, node: Node) -> Variant:
    name, path = names.type_name(message), names.message_path(message, node)
    bare, number = f"Self::{name}(_)", f"{path}::{id_name.upper()}"
    about = doc([prose(sentence(message.model.name))], "    ")
    to_bytes = "message.try_to_bytes()?" if message.is_narrow else "message.to_bytes()"
    return Variant(
        f"{about}\n    {name}({path}),",
        arm(number, f"Self::{name}({path}::from_bytes(bytes)?)"),
        arm(bare, number),
        arm(bare, f"{path}::LENGTH"),
        arm(bare, f"{path}::NAME"),
        arm(f"Self::{name}(message)", f"write_to(buffer, &{to_bytes})"),
    )


def _number(value: int | None) -> tuple[str, str] | None:
    """Type and literal."""
    return None if value is None else (f"u{holding(value.bit_length())}", integer(value))
