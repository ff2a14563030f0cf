"""Fields: names in words, the integer that holds them, what they are at first, steps of the scale, constants, comments."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from icdgen import layout, naming
from icdgen.describe import steps
from icdgen.describe.bounds import Bound, bounds
from icdgen.describe.comments import Comment, field_comment
from icdgen.describe.constants import Constant, constants
from icdgen.describe.storage import Storage, holding
from icdgen.icd.model import Field

if TYPE_CHECKING:
    from icdgen.describe.enums import EnumDescription
    from icdgen.describe.messages import MessageDescription


class FieldDescription:
    """A field (``model``) of ``message``. ``name`` is its identifier in snake case, ``words`` what that is made of."""

    def __init__(self, field: Field, message: MessageDescription, enum: EnumDescription | None) -> None:
        self.model, self.message, self.enum = field, message, enum
        self.words = naming.words(field.identifier or field.name, message.node.vocabulary)
        self.name = naming.snake(self.words)

    @cached_property
    def storage(self) -> Storage:
        """The integer that holds the raw value (the bits of a float); of an enumeration, that of its type. None of bytes."""
        if self.enum is not None:
            return self.enum.storage
        return Storage(holding(self.model.bits), self.model.signed)

    @property
    def is_narrow(self) -> bool:
        """Whether `storage` holds raw values that the field can't."""
        return self.model.type in ("uint", "int", "enum") and self.model.bits != self.storage.bits

    @property
    def fresh(self) -> int:
        """The raw value in a new message, as a number: see `icdgen.describe.fresh`."""
        return self.model.const or 0

    @property
    def pieces(self) -> tuple[layout.Piece, ...]:
        """The runs of bits of the frame that make up a number."""
        return layout.pieces(self.model, self.message.node)

    @cached_property
    def steps(self) -> steps.Steps | None:
        """How the physical value is computed; None where that is the raw value."""
        return steps.steps(self.model)

    @property
    def unit_name(self) -> str:
        """What names of the physical value end in: the unit's identifier, or ``physical``."""
        return self.model.unit.identifier if self.model.unit else "physical"

    @property
    def physical_name(self) -> str:
        """``estimated_roll_angle_deg``"""
        return f"{self.name}_{self.unit_name}"

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits, one by one."""
        return bounds(self.model.limits)

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """The only valid value, values with a meaning, limits: all by name."""
        vocabulary = self.message.node.vocabulary
        return tuple(constants(self.model, self.name, self.physical_name, vocabulary))

    @cached_property
    def comment(self) -> Comment:
        return field_comment(self.model)
