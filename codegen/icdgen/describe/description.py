"""Fields, messages and structs.

A message or struct describes its members as declared. A member describes the fields
below it on demand: elements of arrays, and members of structs.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from copy import copy
from typing import Any, TypeVar

from icdgen.describe.comments import Comment, field_comment, struct_comment
from icdgen.describe.constants import Constant, constants_of_field
from icdgen.describe.enums import EnumDescription, enum_widths
from icdgen.describe.errata import PartWithErrata, first_owners, owners_elsewhere
from icdgen.describe.lengths import ElementBytes, LengthTest, length_tests
from icdgen.describe.named import NamedPart
from icdgen.describe.scalar import ScalarDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.layout import UNDECLARED, Layout, Orders, VariablePart
from icdgen.icd.model import Enum, Icd, Message, Node, Struct
from icdgen.icd.places import NodePlace, places_of
from icdgen.once import cached_property

_OF_PLACE = ("needs", "elements", "instances", "element_struct", "comment")
"""Cached attributes that depend on the place of a field.

`FieldDescription.moved` drops them.
"""


class Into(enum.Enum):
    """How far `walk` goes; what it does not go into stands as one field."""

    STRUCTS = 1  # into single structs
    ARRAYS_OF_STRUCTS = 2  # into each element of these, too
    ALL_ARRAYS = 3  # into each element of any array: all scalars


class PresenceCondition(NamedTuple):
    """Condition of an optional field: another field has one of these raw values, in
    ascending order.
    """

    field: FieldDescription
    values: tuple[int, ...]


class FieldDescription(ScalarDescription):
    """Field of a message or struct, or a field below one: an element of an array, or a
    member of a struct.

    Names are computed at once: sets of ICDs have ten thousand fields, and every output
    needs the names of all.
    """

    member: str
    """Name in an expression, in any language: ``temperatures[3]``,
    ``satellites[2].gnss``.
    """
    holder: str
    """Name of the enclosing struct in an expression, ``satellites[2]``; empty for
    members of the message itself.
    """
    declaration: FieldDescription
    """Field as the struct or message declares it; for an element, the array."""
    array: FieldDescription | None
    """Array of which the field is an element; None for any other field."""
    member_of_message: FieldDescription
    """Member of the message that the field is, or is in."""

    def __init__(
        self, place: NodePlace, message: Composite[Any], enum: EnumDescription | None
    ) -> None:
        owner = f"field `{place.name}` of `{message.model.name}`"
        super().__init__(
            place, enum, message.node.vocabulary, owner, message.node.orders
        )
        self.message = message
        self.struct = None if place.struct is None else message.struct_of(place.struct)
        self.member = self.name
        self.holder, self.declaration = "", self
        self.array, self.member_of_message = None, self
        self.is_repeated = False
        """Whether the field is in an element of an array of structs."""

    def _element(self, place: NodePlace) -> FieldDescription:
        """Return the description of an element of an array; for any other field the
        field itself.
        """
        if place is self.model:
            return self
        element = self.moved(place)
        element.name = f"{self.name}_{place.index}"
        element.member = f"{self.member}[{place.index}]"
        element.array = self
        element.is_repeated = self.is_repeated or self.struct is not None
        return element

    def _inner(self, place: NodePlace) -> FieldDescription:
        """Return the description of a member of the struct that stands here."""
        assert self.struct is not None
        declared = self.struct.member_for[id(place.node)]
        inner = declared.moved(place)
        inner.message, inner.node_orders = self.message, self.node_orders
        inner.member_of_message = self.member_of_message
        inner.is_repeated = self.is_repeated
        inner.name = f"{self.name}_{declared.name}"
        inner.member = f"{self.member}.{declared.member}"
        inner.holder, inner.declaration = self.member, declared
        return inner

    def moved(self, place: NodePlace) -> FieldDescription:
        """Return the description of a field with the same declaration at another place."""
        # The copy takes computed names and constants along: they do not depend on the
        # place, and an array of structs has a copy per element and member.
        other = copy(self)
        other.model = place
        other.owner = f"field `{place.name}` of `{self.message.model.name}`"
        for name in _OF_PLACE:
            other.__dict__.pop(name, None)
        return other

    @property
    def count(self) -> int:
        """Number of elements of an array; 0 for any other field, and for an element."""
        return self.model.count

    @property
    def index(self) -> int | None:
        """Index in the array; None if the field is not an element."""
        return self.model.index

    @property
    def is_in_sequence(self) -> bool:
        """Whether the field is a variable part of its message, or behind or in one."""
        sequence = self.message.model.layout.sequence
        return any(self.member_of_message.model.node is node for node in sequence)

    @property
    def is_in_last_part(self) -> bool:
        """Whether the field is the last variable part of its message, or in it."""
        # Fields below a member have the node of that member in `member_of_message`.
        parts = self.message.model.layout.parts
        return bool(parts) and self.member_of_message.model.node is parts[-1].node

    @property
    def is_in_earlier_part(self) -> bool:
        """Whether the field is a variable part with another one behind it, or in such a
        part.
        """
        return any(
            self.member_of_message.model.node is part.node
            for part in self.message.model.layout.parts[:-1]
        )

    @property
    def initial_count(self) -> int:
        """Number of elements of an array, or of bytes of variable length, in a new
        message.

        The last variable part has its fewest. Earlier parts have all: the constants of
        their elements are set in advance.
        """
        if self.is_in_last_part:
            assert self.message.last_part is not None
            return self.message.last_part.model.fewest
        return self.count

    @property
    def is_initially_present(self) -> bool:
        """Whether a new message has the field: the initial values of other fields meet
        its conditions.
        """
        return all(need.field.initial_raw in need.values for need in self.needs)

    @property
    def has_initial_value(self) -> bool:
        """Whether one of its scalars has an initial value other than 0."""
        scalars = self.struct.fields if self.struct is not None else (self,)
        return any(scalar.initial_raw for scalar in scalars)

    @property
    def is_initially_zero(self) -> bool:
        """Whether all of it is 0 or absent in a new message.

        A single struct has the initial values of its own members.
        """
        if self.model.conditions:
            return not self.is_initially_present
        if self.struct is not None and not self.is_in_last_part:
            return True
        return not self.has_initial_value or (
            self.struct is None and self.is_in_last_part and not self.initial_count
        )

    @property
    def needs_range_check(self) -> bool:
        """Whether its type can store raw values that do not fit the field; for a
        struct, whether that of a member can.
        """
        return self.is_narrow if self.struct is None else self.struct.is_narrow

    @cached_property
    def needs(self) -> tuple[PresenceCondition, ...]:
        """Conditions of an optional field, which must all be met."""
        if not self.model.conditions:
            return ()
        members = {member.model.name: member for member in self.message.members}
        return tuple(
            PresenceCondition(members[condition.field], tuple(sorted(condition.values)))
            for condition in self.model.conditions
            # In an ICD with errors, a condition can name a field that the message does
            # not have.
            if condition.field in members
        )

    @cached_property
    def elements(self) -> tuple[FieldDescription, ...]:
        """Elements of an array; for any other field the field itself."""
        return tuple(map(self._element, self.model.elements()))

    @cached_property
    def instances(self) -> tuple[tuple[FieldDescription, ...], ...]:
        """Members of a struct where it stands: once, or for each element of an array;
        empty without a struct.
        """
        if self.struct is None:
            return ()
        return tuple(
            tuple(map(element._inner, element.model.inner()))
            for element in self.elements
        )

    def walk(self, into: Into) -> Iterator[FieldDescription]:
        """List the fields that it consists of, in the order of the ICD."""
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
        """All scalars that it consists of: itself, each element of an array, each field
        of a struct.
        """
        return self.walk(Into.ALL_ARRAYS)

    @cached_property
    def element_struct(self) -> StructDescription | None:
        """Struct of the elements of an array, in the orders in effect here; None for
        any other field.
        """
        return (
            None
            if self.struct is None or not self.count
            else self.message.element_struct_of(self, self.struct)
        )

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """Constants of the field by name: its only valid value, values with a meaning,
        limits.
        """
        field = self.model
        if self.declaration is not self:
            return self.declaration.constants
        if field.const is None and not field.special and field.limits is None:
            return ()
        return tuple(
            constants_of_field(
                field,
                self.declared_name,
                self.physical_name,
                self.message.node.vocabulary,
            )
        )

    @cached_property
    def comment(self) -> Comment:
        elsewhere = (
            owners_elsewhere(self.model, self.message.first_owners)
            if self.model.errata
            else {}
        )
        return field_comment(self.model, elsewhere, self.message.model)


class Chunk(NamedTuple):
    """Bytes of an element that are contiguous in every frame: bytes of fixed size, then
    the elements of an array.
    """

    begin: int  # in the longest element
    fixed: int
    inner: VariablePartDescription | None


class VariablePartDescription(NamedTuple):
    """Part of variable length: an array, bytes or text."""

    model: VariablePart
    field: FieldDescription  # the array, or the bytes or text
    # Number of elements: a field of the frame, or a count that follows from its length.
    counter: FieldDescription
    inner: tuple[VariablePartDescription, ...] = ()
    """Variable-length arrays in an element, placed as in the longest element."""

    @property
    def element_struct(self) -> StructDescription | None:
        """Struct of the elements; None for an array of scalars, for bytes and for text."""
        return self.field.element_struct

    @property
    def is_rest(self) -> bool:
        """Whether the length of the frame gives the number of elements, and no field of
        the frame.
        """
        return self.counter.model.is_count

    @property
    def counter_tests(self) -> tuple[LengthTest, ...]:
        """Comparisons that every valid value of the counter passes and another value of
        its type can fail.
        """
        tests = length_tests(range(self.model.low, self.model.high + 1))
        return tuple(
            test
            for test in tests
            # Compilers warn about a comparison that is true for all values of the type.
            if test.kind != "at most" or test.value < self.counter.storage.max
        )

    @property
    def needs_count_check(self) -> bool:
        """Whether the type of the counter can store numbers of elements that the part
        cannot have.
        """
        return bool(self.counter_tests)

    @property
    def place(self) -> ElementBytes:
        """First byte of an element in the longest frame, by its index."""
        return ElementBytes(self.model.begin, self.model.step)

    @property
    def bytes_beyond_fewest(self) -> ElementBytes:
        """Bytes up to the end of the part in the longest frame, by the number of
        elements beyond the fewest.
        """
        return ElementBytes(self.model.end_if_fewest, self.model.step)

    @property
    def chunks(self) -> tuple[Chunk, ...]:
        """Runs of bytes of an element that are contiguous in every frame, at their
        places in the longest element.
        """
        chunks, begin = [], 0
        for inner in self.inner:
            chunks.append(Chunk(begin, inner.model.begin - begin, inner))
            # In the longest element, the array has all its elements.
            begin = inner.model.begin + inner.model.most * inner.model.step
        end = self.model.step - begin
        return (*chunks, Chunk(begin, end, None)) if end else tuple(chunks)

    @property
    def counter_of_text(self) -> int:
        """Value of the counter minus number of characters of a text.

        The text is padded to the fewest characters.
        """
        return -self.model.plus


WithFields = TypeVar("WithFields", bound=Message | Struct)


class Composite(NamedPart[WithFields]):
    """Message or struct that an ICD node declares."""

    def __init__(
        self,
        declared: Declarations,
        model: WithFields,
        node: Node,
        kind: str,
        outer: Orders = UNDECLARED,
    ) -> None:
        super().__init__(model, model, node.vocabulary, f"{kind} `{model.name}`")
        self._declared, self.node = declared, node
        self.outer_orders = outer
        """Orders of the array whose element this struct is."""
        self.using_node = node
        """Node whose code reads and writes it. It can use structs of other nodes."""
        self._walks: dict[Into, tuple[FieldDescription, ...]] = {}

    @cached_property
    def comment(self) -> Comment:
        """Paragraphs of the comment in generated code."""
        raise NotImplementedError

    @cached_property
    def declared_members(self) -> tuple[FieldDescription, ...]:
        """Members, overlay fields and derived values as declared, in the order of the
        ICD.
        """
        return tuple(map(self._member, places_of(self.model.layout, self.outer_orders)))

    def _member(self, place: NodePlace) -> FieldDescription:
        return FieldDescription(
            place, self, self._declared.enum(place.enum) if place.enum else None
        )

    def struct_of(self, layout: Layout) -> StructDescription:
        """Return the struct that has a layout."""
        return self._declared.struct_of(layout)

    @cached_property
    def member_for(self) -> dict[int, FieldDescription]:
        """Members by the identity of their nodes."""
        # Two lines of an ICD can be equal, so nodes are compared by identity.
        return {id(member.model.node): member for member in self.declared_members}

    @cached_property
    def read_only_members(self) -> tuple[FieldDescription, ...]:
        """Overlay fields and derived values: getters compute them, and nothing sets
        them.
        """
        return tuple(
            member for member in self.declared_members if member.model.is_read_only
        )

    @cached_property
    def overlays(self) -> tuple[FieldDescription, ...]:
        """Overlay fields, which read bits of other fields."""
        return tuple(
            field for field in self.read_only_members if field.model.derived is None
        )

    @cached_property
    def derived(self) -> tuple[FieldDescription, ...]:
        """Values that are computed from other fields: see `icdgen.describe.derived`."""
        return tuple(
            field for field in self.read_only_members if field.model.derived is not None
        )

    @cached_property
    def members(self) -> tuple[FieldDescription, ...]:
        """Members that own bits or count elements, in the order of the ICD; an array is
        one member, and so is a struct.
        """
        if not self.read_only_members:
            return self.declared_members
        return tuple(
            member for member in self.declared_members if not member.model.is_read_only
        )

    @property
    def fields(self) -> tuple[FieldDescription, ...]:
        """All scalars of `members`: each element of an array and each field of a
        struct.
        """
        return self.walk(Into.ALL_ARRAYS)

    @property
    def constants(self) -> Iterator[tuple[FieldDescription, Constant]]:
        """Constants of all fields, in the order of the ICD."""
        for field in self.declared_members:
            for constant in field.constants:
                yield field, constant

    @property
    def last_part(self) -> VariablePartDescription | None:
        """Last part of variable length; None for structs and messages of one length."""
        return None

    def walk(self, into: Into) -> tuple[FieldDescription, ...]:
        """Return the fields of `members` in the order of the ICD, as far as `into`
        goes.
        """
        if into not in self._walks:
            self._walks[into] = tuple(
                field for member in self.members for field in member.walk(into)
            )
        return self._walks[into]

    def element_struct_of(
        self, array: FieldDescription, struct: StructDescription
    ) -> StructDescription:
        """Return the struct of the elements of an array, in the orders in effect there."""
        orders = array.model.orders_in_effect(self.node.orders)
        element_struct = StructDescription(
            self._declared, struct.model, struct.node, orders
        )
        element_struct.using_node = self.using_node
        return element_struct

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """Enumerations of its own members, each once, without enumerations in structs."""
        return tuple(
            dict.fromkeys(
                member.enum
                for member in self.declared_members
                if member.enum is not None
            )
        )

    @cached_property
    def structs(self) -> tuple[StructDescription, ...]:
        """Structs of its own members, each once."""
        return tuple(
            dict.fromkeys(
                member.struct
                for member in self.declared_members
                if member.struct is not None
            )
        )

    @property
    def is_narrow(self) -> bool:
        """Whether the type of a field can store raw values that do not fit it."""
        return any(member.needs_range_check for member in self.members)

    @property
    def range_check_bits(self) -> int:
        """Width of the widest type that can store raw values which do not fit their
        field; 0 without such a type.
        """
        widths = (
            member.struct.range_check_bits if member.struct else member.storage.bits
            for member in self.members
            if member.needs_range_check
        )
        return max(widths, default=0)

    @property
    def has_floats(self) -> bool:
        """Whether a member is a float, or a struct with one."""
        return any(
            member.struct.has_floats if member.struct else member.model.type == "float"
            for member in self.members
        )

    @property
    def has_physical(self) -> bool:
        """Whether one of its own members has a physical value other than the raw value,
        or is computed from other fields.
        """
        return any(
            field.has_physical or field.model.derived is not None
            for field in self.declared_members
        )

    @cached_property
    def has_wide_steps(self) -> bool:
        """Whether the scale of one of its own members needs arithmetic of more than 128
        bits.
        """
        return any(
            field.steps is not None and field.steps.is_wide
            for field in self.declared_members
        )

    @cached_property
    def first_owners(self) -> dict[str, PartWithErrata]:
        """First part with each erratum, by its id.

        The comment of that part explains the erratum.
        """
        return first_owners(
            (self.model, *(member.model for member in self.declared_members))
        )


class StructDescription(Composite[Struct]):
    """Struct."""

    def __init__(
        self,
        declared: Declarations,
        struct: Struct,
        node: Node,
        outer: Orders = UNDECLARED,
    ) -> None:
        super().__init__(declared, struct, node, "struct", outer)

    @cached_property
    def comment(self) -> Comment:
        return struct_comment(self.model)


class Declarations:
    """Structs and enumerations of a set of ICDs.

    Each is described once, whatever uses it.
    """

    def __init__(self, icd: Icd) -> None:
        self._icd = icd
        self._enum_bits = enum_widths(icd)
        self._enums: dict[tuple[str, str], EnumDescription] = {}
        self._structs = {
            # Structs can have equal layouts, so layouts are identified by their `id`.
            # The ICD keeps them alive, so no other object gets the same `id`.
            id(struct.layout): StructDescription(self, struct, node)
            for node in icd.nodes
            for struct in node.structs
        }

    def struct_of(self, layout: Layout) -> StructDescription:
        """Return the description of the struct that has a layout."""
        return self._structs[id(layout)]

    def enum(self, enum: Enum) -> EnumDescription:
        """Return the description of an enumeration."""
        key = enum.node, enum.name
        if key not in self._enums:
            self._enums[key] = EnumDescription(
                enum, self._icd.node(enum.node), self._enum_bits[key], self._icd
            )
        return self._enums[key]
