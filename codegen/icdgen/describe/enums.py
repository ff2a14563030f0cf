"""Enumerations: names in words, the width of their integer, comments."""

from __future__ import annotations

from icdgen import naming
from icdgen.describe.comments import Comment, enum_comment, member_comment
from icdgen.describe.errata import Thing, first_owners, owners_elsewhere
from icdgen.describe.named import Named
from icdgen.describe.storage import Storage, holding
from icdgen.icd.model import Enum, Icd, Member, Message, Node, Struct
from icdgen.icd.node_cache import cached_by_node
from icdgen.icd.places import places_in
from icdgen.once import cached_property

Users = dict[str, list[str]]  # by the names of fields, the messages and structs in which they stand


def enum_widths(icd: Icd) -> dict[tuple[str, str], int]:
    """Bits that the values of each enumeration need: those of its members, and of every field of the set that holds it."""
    found: dict[tuple[str, str], int] = {}
    for node in icd.nodes:
        for enum in node.enums:
            found[enum.node, enum.name] = max(found.get((enum.node, enum.name), 1), enum.bits)
        every: tuple[Struct | Message, ...] = (*node.structs, *node.messages)
        for one in every:
            for place in places_in(one.layout):
                if place.enum is not None:
                    key = place.enum.node, place.enum.name
                    found[key] = max(found.get(key, 1), place.bits)
    return found


@cached_by_node
def holders(icd: Icd, node: Node) -> dict[tuple[str, str], Users]:
    """Of each enumeration, by its node and its name, what of a node holds it."""
    found: dict[tuple[str, str], Users] = {}
    every: tuple[Struct | Message, ...] = (*node.structs, *node.messages)
    for one in every:
        for place in places_in(one.layout):
            if place.enum is not None:
                users = found.setdefault((place.enum.node, place.enum.name), {})
                users.setdefault(place.name, []).append(one.name)
    return found


class EnumDescription(Named[Enum]):
    """An enumeration of ``node``; ``storage`` holds every value of it, named or not."""

    def __init__(self, enum: Enum, node: Node, bits: int, icd: Icd) -> None:
        super().__init__(enum, node.vocabulary, f"enumeration `{enum.name}`")
        self.icd, self.node, self.storage = icd, node, Storage(holding(bits), enum.signed)

    @cached_property
    def members(self) -> tuple[MemberDescription, ...]:
        """In the order of the manual; of a range its ends, each with a name of its own."""
        return tuple(MemberDescription(end, self) for member in self.model.members for end in member.ends)

    @cached_property
    def ranges(self) -> tuple[Member, ...]:
        """What has values between its ends: these have no constants in code, and are called as the range is."""
        return tuple(member for member in self.model.members if member.last - member.value > 1)

    def range_name(self, one: Member) -> str:
        """What a range is called, in snake case."""
        return naming.snake(naming.words(one.identifier or one.name, self.node.vocabulary))

    @cached_property
    def first_owners(self) -> dict[str, Thing]:
        """By the ids of errata: which part of the enumeration tells of it."""
        return first_owners((self.model, *(member.model for member in self.members)))

    @cached_property
    def comment(self) -> Comment:
        return enum_comment(self.model, self.users)

    @property
    def users(self) -> Users:
        """By the names of the fields of its node that hold it: the messages and structs in which they stand."""
        return holders(self.icd, self.node).get((self.model.node, self.model.name), {})

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
        return member_comment(
            self.model, owners_elsewhere(self.model, self._enum.first_owners) if self.model.errata else {}
        )
