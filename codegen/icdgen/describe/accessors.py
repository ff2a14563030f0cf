"""Accessors of physical values: in which types a field can be read and set, with names
and comments for all languages.

A language generates the kinds that it has types for.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from icdgen.describe.arithmetic import IntegerAccess
from icdgen.describe.comments import (
    physical_comment,
    physical_name,
    text_comment,
    words,
)
from icdgen.describe.description import FieldDescription
from icdgen.describe.integer_scale import IntegerScale, part_of_unit
from icdgen.frozen import NamedTuple

Kind = Literal["text", "double", "single", "integer", "long integer"]
"""Characters, floats of 64 and 32 bits, and whole thousandths or millionths of the
unit.

Integers of at most 64 bits compute an ``integer``; a step for a ``long integer`` may
need more.
"""


class Accessor(NamedTuple):
    """Getter of a physical value, and setter if it is settable.

    Both have the index as a parameter if the field is an array.
    """

    field: FieldDescription
    kind: Kind
    name: str  # ``estimated_roll_angle_deg``, ``estimated_roll_angle_mdeg``
    is_settable: bool
    scale: IntegerScale | None = None  # of an integer

    @property
    def integer_access(self) -> IntegerAccess:
        """Integer types and limits of an accessor of the kind ``integer``."""
        access = (
            self.field.arithmetic.integer_access
            if self.field.arithmetic is not None
            else None
        )
        assert access is not None, f"{self.name} is no `integer`"
        return access

    @property
    def title(self) -> str:
        """Name of the value in words: ``Estimated Roll Angle in thousandths of deg``."""
        field = self.field.model
        if self.scale is not None:
            return f"{words(field.name)} in {words(part_of_unit(field, self.scale.per)[1])}"
        return words(field.name) if self.kind == "text" else physical_name(field)

    @property
    def comment(self) -> str:
        """Comment of the getter."""
        if self.scale is not None:
            return f"{self.title}, exact: {self.scale.low} to {self.scale.high}."
        if self.kind == "single":
            return f"{self.title}, the nearest float of 32 bits."
        return (
            text_comment(self.field.model)
            if self.kind == "text"
            else physical_comment(self.field.model)
        )


def accessors_of(field: FieldDescription, *kinds: Kind) -> Iterator[Accessor]:
    """List the accessors of the physical value of a field, as far as a language has
    these kinds of them.
    """
    if not field.has_physical:
        return
    kind: Kind = "text" if field.is_text else "double"
    if kind in kinds:
        yield Accessor(field, kind, field.physical_name, field.is_settable)
    # Calibrations are computed in doubles only.
    if field.steps is None or field.arithmetic is None:
        return
    if "single" in kinds:
        yield Accessor(field, "single", f"{field.physical_name}_f32", False)
    scale = field.integer_scale
    if scale is not None:
        kind = "long integer" if field.arithmetic.integer_access is None else "integer"
        if kind in kinds:
            name = f"{field.declared_name}_{part_of_unit(field.model, scale.per)[0]}"
            yield Accessor(field, kind, name, field.is_settable, scale)
