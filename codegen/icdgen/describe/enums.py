"""Enumerations: names in words, the width of their integer, comments."""

from __future__ import annotations

from icdgen.describe.comments import Comment, enum_comment, member_comment
from icdgen.describe.errata import Thing, tellers, told_elsewhere
from icdgen.describe.named import Named
from icdgen.describe.storage import Storage, holding
from icdgen.icd.model import Enum, Icd, Member, Message, Node, Struct
from icdgen.once import cached_property


def enum_widths(icd: Icd) -> dict[tuple[str, str], int]:
    """Bits that the values of each enumeration need: those of its members, and of every field of the set that holds it."""
    found: dict[tuple[str, str], int] = {}
    for node in icd.nodes:
        for enum in node.enums:
            bits = enum.bits_for(enum.widest.value) if enum.widest else 1
            found[enum.node, enum.name] = max(found.get((enum.node, enum.name), 1), bits)
        every: tuple[Struct | Message, ...] = (*node.structs, *node.messages)
        for one in every:
            for field in one.fields:
                if field.enum is not None:
                    key = field.enum.node, field.enum.name
                    found[key] = max(found.get(key, 1), field.bits)
    return found


class EnumDescription(Named[Enum]):
    """An enumeration of ``node``; ``storage`` holds every value of it, named or not."""

    def __init__(self, enum: Enum, node: Node, bits: int) -> None:
        super().__init__(enum, node.vocabulary, f"enumeration `{enum.name}`")
        self.node, self.storage = node, Storage(holding(bits), enum.signed)

    @cached_property
    def members(self) -> tuple[MemberDescription, ...]:
        """In the order of the manual."""
        return tuple(MemberDescription(member, self) for member in self.model.members)

    @cached_property
    def tellers(self) -> dict[str, Thing]:
        """By the ids of errata: which part of the enumeration tells of it."""
        return tellers((self.model, *self.model.members))

    @cached_property
    def comment(self) -> Comment:
        return enum_comment(self.model)

    def member(self, value: int) -> MemberDescription | None:
        """The first member of a value, if one has it."""
        return next((one for one in self.members if one.model.value == value), None)


class MemberDescription(Named[Member]):
    """A value of an enumeration."""

    def __init__(self, member: Member, enum: EnumDescription) -> None:
        super().__init__(member, enum.node.vocabulary, f"member `{member.name}` of `{enum.model.name}`")
        self._enum = enum

    @cached_property
    def comment(self) -> Comment:
        return member_comment(self.model, told_elsewhere(self.model, self._enum.tellers) if self.model.errata else {})
