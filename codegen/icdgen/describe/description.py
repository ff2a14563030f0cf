"""Fields and what has them, which know each other."""

from __future__ import annotations

import enum
from collections.abc import Iterator
from copy import copy
from typing import Any, NamedTuple, TypeVar

from icdgen.describe.comments import Comment, field_comment, struct_comment
from icdgen.describe.constants import Constant, constants
from icdgen.describe.enums import EnumDescription, enum_widths
from icdgen.describe.errata import Thing, first_owners, owners_elsewhere
from icdgen.describe.named import Named
from icdgen.describe.scalar import ScalarDescription
from icdgen.icd.layout import UNDECLARED, Layout, Orders, VariablePart
from icdgen.icd.model import Enum, Icd, Message, Node, Struct
from icdgen.icd.places import NodePlace, places_of
from icdgen.once import cached_property

_OF_PLACE = ("needs", "elements", "instances", "element_struct", "comment")
"""Attributes that are worked out for one place of a field."""


class Into(enum.Enum):
    """How far `walk` goes; what it does not go into stands as one field."""

    STRUCTS = 1  # into single structs
    ARRAYS_OF_STRUCTS = 2  # into each element of these, too
    ALL_ARRAYS = 3  # into each element of any array: all scalars


class Need(NamedTuple):
    """What a field that is not always there needs: another one with one of these raw values, in their order."""

    field: FieldDescription
    values: tuple[int, ...]


class FieldDescription(ScalarDescription):
    """A field of ``message``, or of a struct; of an array, an element, or among ``members`` all of it.

    Made by the ten thousand, and each asked for its names at once: what these need is worked out at the beginning.
    """

    member: str
    """Name in an expression, in any language: ``temperatures[3]``, ``satellites[2].gnss``."""
    holder: str
    """Name of its struct in an expression, ``satellites[2]``; empty of what its message has itself."""
    declaration: FieldDescription
    """The field as its struct, or its message, declares it; of an element its array."""
    array: FieldDescription | None
    """The array that it is an element of; else None."""
    member_of_message: FieldDescription
    """The member of its message that it is, or stands in."""

    def __init__(self, place: NodePlace, message: Composite[Any], enum: EnumDescription | None) -> None:
        owner = f"field `{place.name}` of `{message.model.name}`"
        super().__init__(place, enum, message.node.vocabulary, owner, message.node.orders)
        self.message = message
        self.struct = None if place.struct is None else message.struct_of(place.struct)
        self.member = self.name
        self.holder, self.declaration = "", self
        self.array, self.member_of_message = None, self
        self.is_repeated = False
        """Whether it stands in an element of an array of structs."""

    def _element(self, place: NodePlace) -> FieldDescription:
        """The description of an element of an array; of anything else the field itself."""
        if place is self.model:
            return self
        element = self.moved(place)
        element.name, element.member = f"{self.name}_{place.index}", f"{self.member}[{place.index}]"
        element.array, element.is_repeated = self, self.is_repeated or self.struct is not None
        return element

    def _inner(self, place: NodePlace) -> FieldDescription:
        """The description of a field of a struct, where the struct stands."""
        assert self.struct is not None
        declared = self.struct.member_for[id(place.node)]
        inner = declared.moved(place)
        inner.message, inner.node_orders = self.message, self.node_orders
        inner.member_of_message, inner.is_repeated = self.member_of_message, self.is_repeated
        inner.name, inner.member = f"{self.name}_{declared.name}", f"{self.member}.{declared.member}"
        inner.holder, inner.declaration = self.member, declared
        return inner

    def moved(self, place: NodePlace) -> FieldDescription:
        """A field that is declared like this one, at another place."""
        other = copy(self)
        other.model, other.owner = place, f"field `{place.name}` of `{self.message.model.name}`"
        for name in _OF_PLACE:
            other.__dict__.pop(name, None)
        return other

    @property
    def count(self) -> int:
        """How many elements an array has that stands as one; else 0."""
        return self.model.count

    @property
    def index(self) -> int | None:
        """Which element of its array it is; None of what is no element."""
        return self.model.index

    @property
    def is_in_last_part(self) -> bool:
        """Whether it is the open end of its message, or stands in it."""
        sequence = self.message.model.layout.sequence
        return bool(sequence) and self.member_of_message.model.node is sequence[-1]

    @property
    def initial_count(self) -> int:
        """Elements of an array in a new message, or bytes of variable length: the last variable part has its fewest."""
        if self.is_in_last_part:
            assert self.message.last_part is not None
            return self.message.last_part.model.fewest
        return self.count

    @property
    def is_initially_present(self) -> bool:
        """Whether a new message has the field: the initial values of other fields meet its conditions."""
        return all(need.field.initial_raw in need.values for need in self.needs)

    @property
    def has_initial_value(self) -> bool:
        """Whether some scalar of it has an initial value other than 0."""
        return any(one.initial_raw for one in (self.struct.fields if self.struct is not None else (self,)))

    @property
    def is_initially_zero(self) -> bool:
        """Whether all of it is 0 or absent in a new message. A struct has the initial values of its own members."""
        if self.model.when:
            return not self.is_initially_present
        if self.struct is not None and not self.is_in_last_part:
            return True
        return not self.has_initial_value or (self.struct is None and self.is_in_last_part and not self.initial_count)

    @property
    def needs_range_check(self) -> bool:
        """Whether its type holds raw values that the field does not; of a struct, whether that of a member does."""
        return self.is_narrow if self.struct is None else self.struct.is_narrow

    @property
    def is_in_earlier_part(self) -> bool:
        """Whether it is open with something else behind it, or stands in such a part."""
        return any(self.member_of_message.model.node is node for node in self.message.model.layout.sequence[:-1])

    @cached_property
    def needs(self) -> tuple[Need, ...]:
        """Of a field that is not always there, all that it needs."""
        known = {one.model.name: one for one in self.message.members} if self.model.when else {}
        return tuple(Need(known[one.field], tuple(sorted(one.values))) for one in self.model.when if one.field in known)

    @cached_property
    def elements(self) -> tuple[FieldDescription, ...]:
        """The elements of an array; of anything else the field itself."""
        return tuple(map(self._element, self.model.elements()))

    @cached_property
    def instances(self) -> tuple[tuple[FieldDescription, ...], ...]:
        """The members of a struct where it stands: once, or for each element of an array; empty without a struct."""
        if self.struct is None:
            return ()
        return tuple(tuple(map(element._inner, element.model.inner())) for element in self.elements)

    def walk(self, into: Into) -> Iterator[FieldDescription]:
        """The fields that it is made of, in the order of the ICD."""
        if self.struct is None:
            yield from self.elements if into is Into.ALL_ARRAYS else (self,)
        elif self.count and into is Into.STRUCTS:
            yield self
        else:
            for members in self.instances:
                for member in members:
                    yield from member.walk(into)

    @property
    def scalars(self) -> Iterator[FieldDescription]:
        """All scalars that it is made of: itself, each element of an array, each field of a struct."""
        return self.walk(Into.ALL_ARRAYS)

    @cached_property
    def element_struct(self) -> StructDescription | None:
        """What an element of an array of structs is made of, in the orders that hold where it stands; else None."""
        return None if self.struct is None or not self.count else self.message.element_struct_of(self, self.struct)

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """The only valid value, values with a meaning, limits: all by name."""
        field = self.model
        if self.declaration is not self:
            return self.declaration.constants
        if field.const is None and not field.special and field.limits is None:
            return ()
        return tuple(constants(field, self.declared_name, self.physical_name, self.message.node.vocabulary))

    @cached_property
    def comment(self) -> Comment:
        told = owners_elsewhere(self.model, self.message.first_owners) if self.model.errata else {}
        return field_comment(self.model, told, self.message.model)


class VariablePartDescription(NamedTuple):
    """A part of variable length: an array, bytes or text."""

    model: VariablePart
    field: FieldDescription  # the array as one, or the bytes or text
    counter: FieldDescription  # how many elements there are; a field of the frame, or what only its length tells

    @property
    def element_struct(self) -> StructDescription | None:
        """What an element is made of, where that is a struct."""
        return self.field.element_struct

    @property
    def needs_count_check(self) -> bool:
        """Whether the integer that holds the count holds larger or smaller ones than there can be."""
        return self.model.low > 0 or self.counter.storage.max > self.model.high


Fielded = TypeVar("Fielded", bound=Message | Struct)


class Composite(Named[Fielded]):
    """What has fields: a message, or a struct, that ``node`` declares."""

    def __init__(
        self, declared: Declarations, model: Fielded, node: Node, what: str, outer: Orders = UNDECLARED
    ) -> None:
        super().__init__(model, node.vocabulary, f"{what} `{model.name}`")
        self._declared, self.node = declared, node
        self.outer_orders = outer
        """Those of the array of which it is an element."""
        self.using_node = node
        """The node in whose code it is read and written."""

    @cached_property
    def comment(self) -> Comment:
        """What comments say of it."""
        raise NotImplementedError

    @cached_property
    def declared_members(self) -> tuple[FieldDescription, ...]:
        """Members and views, in the order of the ICD: what is declared in code."""
        return tuple(map(self._member, places_of(self.model.layout, self.outer_orders)))

    def _member(self, place: NodePlace) -> FieldDescription:
        return FieldDescription(place, self, self._declared.enum(place.enum) if place.enum else None)

    def struct_of(self, layout: Layout) -> StructDescription:
        """The struct that has a layout."""
        return self._declared.struct_of(layout)

    @cached_property
    def member_for(self) -> dict[int, FieldDescription]:
        """Members by the identity of their nodes."""
        return {id(member.model.node): member for member in self.declared_members}

    @cached_property
    def read_only_members(self) -> tuple[FieldDescription, ...]:
        """What reads bits of others, or is derived: it is asked of a message, and never set."""
        return tuple(member for member in self.declared_members if member.model.view)

    @cached_property
    def overlays(self) -> tuple[FieldDescription, ...]:
        """The views that read bits."""
        return tuple(field for field in self.read_only_members if field.model.derived is None)

    @cached_property
    def derived(self) -> tuple[FieldDescription, ...]:
        """The views that are derived from the values of fields: see `icdgen.describe.derived`."""
        return tuple(field for field in self.read_only_members if field.model.derived is not None)

    @cached_property
    def members(self) -> tuple[FieldDescription, ...]:
        """What it is made of, in the order of the ICD, an array as one, and a struct."""
        return (
            tuple(member for member in self.declared_members if not member.model.view)
            if self.read_only_members
            else self.declared_members
        )

    @cached_property
    def fields(self) -> tuple[FieldDescription, ...]:
        """What has bits of its own, in the order of the ICD, each element of an array, each field of a struct."""
        return tuple(self.walk(Into.ALL_ARRAYS))

    @property
    def last_part(self) -> VariablePartDescription | None:
        """The open end of a message, where frames differ in length."""
        return None

    def walk(self, into: Into) -> Iterator[FieldDescription]:
        """The fields that it is made of, in the order of the ICD, without overlay fields and derived values."""
        for member in self.members:
            yield from member.walk(into)

    def element_struct_of(self, part: FieldDescription, struct: StructDescription) -> StructDescription:
        """What an array of structs in it has as an element."""
        found = StructDescription(
            self._declared, struct.model, struct.node, part.model.orders_in_effect(self.node.orders)
        )
        found.using_node = self.using_node
        return found

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """The enumerations of the members that it declares itself, each once."""
        return tuple(dict.fromkeys(one.enum for one in self.declared_members if one.enum is not None))

    @cached_property
    def structs(self) -> tuple[StructDescription, ...]:
        """The structs that stand in it, each once."""
        return tuple(dict.fromkeys(one.struct for one in self.declared_members if one.struct is not None))

    @property
    def is_narrow(self) -> bool:
        """Whether a field of it may be given a raw value that does not fit."""
        return any(member.needs_range_check for member in self.members)

    @property
    def range_check_bits(self) -> int:
        """Bits of the widest integer that holds raw values which its field does not; 0 if there is none."""
        widths = (
            member.struct.range_check_bits if member.struct else member.storage.bits
            for member in self.members
            if member.needs_range_check
        )
        return max(widths, default=0)

    @property
    def has_floats(self) -> bool:
        return any(
            member.struct.has_floats if member.struct else member.model.type == "float" for member in self.members
        )

    @cached_property
    def has_wide_steps(self) -> bool:
        """Whether the formula of a field that it declares has numbers of many digits."""
        return any(field.steps is not None and field.steps.is_wide for field in self.declared_members)

    @cached_property
    def first_owners(self) -> dict[str, Thing]:
        """By the ids of errata: which part of it tells of it."""
        return first_owners((self.model, *(member.model for member in self.declared_members)))


class StructDescription(Composite[Struct]):
    """A struct."""

    def __init__(self, declared: Declarations, struct: Struct, node: Node, outer: Orders = UNDECLARED) -> None:
        super().__init__(declared, struct, node, "struct", outer)

    @cached_property
    def comment(self) -> Comment:
        return struct_comment(self.model)


class Declarations:
    """The structs and enumerations of a set of ICDs: each is described once, whoever uses it."""

    def __init__(self, icd: Icd) -> None:
        self._icd = icd
        self._enum_bits = enum_widths(icd)
        self._enums: dict[tuple[str, str], EnumDescription] = {}
        self._structs = {
            id(struct.layout): StructDescription(self, struct, node) for node in icd.nodes for struct in node.structs
        }

    def struct_of(self, layout: Layout) -> StructDescription:
        """The description of the struct that has a layout."""
        return self._structs[id(layout)]

    def enum(self, enum: Enum) -> EnumDescription:
        """The description of an enumeration."""
        key = enum.node, enum.name
        if key not in self._enums:
            self._enums[key] = EnumDescription(enum, self._icd.node(enum.node), self._enum_bits[key], self._icd)
        return self._enums[key]
