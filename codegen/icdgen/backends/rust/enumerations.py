"""An enumeration -> everything that its type says, as finished strings."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import comments, names
from icdgen.backends.rust.names import Enums
from icdgen.backends.rust.text import arm, doc, implementation, integer, signature, string
from icdgen.icd.model import Enum, Node


class Variant(NamedTuple):
    """A member of the enumeration."""

    name: str
    doc: str
    default: bool
    from_raw: str
    to_raw: str
    to_name: str


class EnumRow:
    """What the template is given of an enumeration."""

    def __init__(self, enum: Enum, node: Node, enums: Enums) -> None:
        self.type = names.type_name(enum, node)
        self.name = string(enum.name)
        self.doc = doc(comments.enum(enum))
        bits = enums.storage(enum)
        self.raw = f"u{bits}"
        self.other = names.catch_all(enum, node)
        self.members = []
        for member in enum.members:
            name = names.variant_name(member, node)
            self.members.append(
                Variant(
                    name,
                    doc(comments.member(member), "    "),
                    member.value == 0,
                    arm("            ", integer(member.value), f"Self::{name}"),
                    arm("            ", f"Self::{name}", integer(member.value)),
                    arm("            ", f"Self::{name}", string(member.name)),
                )
            )
        self.complete = len(enum.members) == 1 << bits
        self.has_zero = any(member.default for member in self.members)
        self.enumeration_head = implementation("Enumeration", self.type)
        self.from_raw_head = implementation(f"From<{self.raw}>", self.type)
        self.to_raw_head = implementation(f"From<{self.type}>", self.raw)
        self.to_raw_signature = signature("fn from", (f"value: {self.type}",), "Self")
