"""Enumerations: names in words, the width of their integer, comments.

An `EnumDescription` has its members, ranges and users. `enum_widths` needs the whole
set of ICDs, because a field of any node can be wider than the largest member.
"""

from __future__ import annotations

from icdgen import naming
from icdgen.describe.comments import Comment, enum_comment, member_comment
from icdgen.describe.errata import PartWithErrata, first_owners, owners_elsewhere
from icdgen.describe.named import NamedPart
from icdgen.describe.storage import Storage, storage_bits
from icdgen.icd.model import Enum, Icd, Member, Message, Node, Struct
from icdgen.icd.node_cache import cached_by_node
from icdgen.icd.places import places_in
from icdgen.once import cached_property

# Name of a field -> names of the messages and structs that have it.
Users = dict[str, list[str]]


def enum_widths(icd: Icd) -> dict[tuple[str, str], int]:
    """Return the bits that each enumeration needs, by its node and name: for its
    members and for all fields of its type.
    """
    # A field can be wider than the largest member: the type must also store values
    # without a name.
    widths: dict[tuple[str, str], int] = {}
    for node in icd.nodes:
        for enum in node.enums:
            widths[enum.node, enum.name] = max(
                widths.get((enum.node, enum.name), 1), enum.bits
            )
        composites: tuple[Struct | Message, ...] = (*node.structs, *node.messages)
        for composite in composites:
            for place in places_in(composite.layout):
                if place.enum is not None:
                    key = place.enum.node, place.enum.name
                    widths[key] = max(widths.get(key, 1), place.bits)
    return widths


@cached_by_node
def users_of_enums(icd: Icd, node: Node) -> dict[tuple[str, str], Users]:
    """Return the fields of a node that have an enumeration as their type, by node and
    name of the enumeration.
    """
    users_of_enums: dict[tuple[str, str], Users] = {}
    composites: tuple[Struct | Message, ...] = (*node.structs, *node.messages)
    for composite in composites:
        for place in places_in(composite.layout):
            if place.enum is not None:
                users = users_of_enums.setdefault(
                    (place.enum.node, place.enum.name), {}
                )
                users.setdefault(place.name, []).append(composite.name)
    return users_of_enums


class EnumDescription(NamedPart[Enum]):
    """Enumeration of ``node``.

    Its ``storage`` can store every value, with or without a name.
    """

    def __init__(self, enum: Enum, node: Node, bits: int, icd: Icd) -> None:
        super().__init__(enum, enum, node.vocabulary, f"enumeration `{enum.name}`")
        self.icd = icd
        self.node = node
        self.storage = Storage(storage_bits(bits), enum.signed)

    @cached_property
    def members(self) -> tuple[MemberDescription, ...]:
        """Members in the order of the manual.

        A range has two, its ends, each with a name of its own.
        """
        return tuple(
            MemberDescription(end, self, member)
            for member in self.model.members
            for end in member.ends
        )

    @cached_property
    def ranges(self) -> tuple[Member, ...]:
        """Ranges with values between their ends.

        Code has no constants for these values and shows the name of the range.
        """
        return tuple(
            member for member in self.model.members if member.last - member.value > 1
        )

    def range_name(self, member: Member) -> str:
        """Return the name of a range in snake case."""
        return naming.snake(
            naming.words(member.identifier or member.name, self.node.vocabulary)
        )

    @cached_property
    def first_owners(self) -> dict[str, PartWithErrata]:
        """First part with each erratum, by its id.

        The comment of that part explains the erratum.
        """
        return first_owners((self.model, *(member.model for member in self.members)))

    @cached_property
    def comment(self) -> Comment:
        return enum_comment(self.model, self.users)

    @property
    def users(self) -> Users:
        """Fields of its node that have it as their type, and the messages and structs
        that have these fields.
        """
        return users_of_enums(self.icd, self.node).get(
            (self.model.node, self.model.name), {}
        )

    def member(self, value: int) -> MemberDescription | None:
        """Return the first member with a value; None if no member has it."""
        return next(
            (member for member in self.members if member.model.value == value), None
        )


class MemberDescription(NamedPart[Member]):
    """Value of an enumeration that has a name: a member, or the first or last value of
    a range (``declared``).
    """

    def __init__(self, member: Member, enum: EnumDescription, declared: Member) -> None:
        super().__init__(
            member,
            declared,
            enum.node.vocabulary,
            f"member `{member.name}` of `{enum.model.name}`",
        )
        self.enum = enum

    @cached_property
    def comment(self) -> Comment:
        return member_comment(
            self.model,
            (
                owners_elsewhere(self.model, self.enum.first_owners)
                if self.model.errata
                else {}
            ),
        )
