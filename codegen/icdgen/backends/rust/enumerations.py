"""An enumeration -> everything that its type says, as finished strings."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import names
from icdgen.backends.rust.text import arm, doc, integer, prose, string
from icdgen.describe import EnumDescription


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

    def __init__(self, enum: EnumDescription) -> None:
        self.type = names.type_name(enum)
        self.doc = doc(map(prose, enum.comment.paragraphs))
        self.raw = f"u{enum.storage.bits}"
        self.other = names.catch_all(enum)
        self.members = []
        for one in enum.members:
            name, value = names.type_name(one), one.model.value
            self.members.append(
                Variant(
                    name,
                    doc(map(prose, one.comment.paragraphs), "    "),
                    value == 0,
                    arm(integer(value), f"Self::{name}"),
                    arm(f"Self::{name}", integer(value)),
                    arm(f"Self::{name}", string(one.model.name)),
                )
            )
        self.complete = len(enum.members) == 1 << enum.storage.bits
        self.has_zero = any(member.default for member in self.members)
