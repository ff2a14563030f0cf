"""The way from a message to its fields: through arrays, and through structs. Part of the `model`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, TypeAlias

from icdgen.frozen import dataclass

Field: TypeAlias = Any  # those of the model, which imports this
Struct: TypeAlias = Any


@dataclass(frozen=True, slots=True)
class Step:
    """A step of the path from a message to a field of its: what stands there, and which element of it, where it is an array."""

    name: str
    index: int | None = None  # None of what is no array, and where all its elements are meant
    count: int = 0  # of all elements
    stride: int = 0  # bits from one element to the next
    identifier: str | None = None
    member: Field | None = None  # that is a struct; the next step is one of its fields

    @property
    def struct(self) -> Struct | None:
        """Of which the next step is a field."""
        return None if self.member is None else self.member.struct

    @property
    def text(self) -> str:
        """``Temperatures[3]``"""
        return self.name if self.index is None else f"{self.name}[{self.index}]"

    @property
    def alias(self) -> str:
        """The same of its identifier, if it has one."""
        return self.text if self.identifier is None else replace(self, name=self.identifier).text

    @property
    def is_open(self) -> bool:
        """Whether all elements are meant."""
        return self.index is None and self.count > 0


def name_of(path: tuple[Step, ...]) -> str:
    """``Satellites[2].GNSS``"""
    return ".".join(step.text for step in path)


def placed(member: Field, element: Field, fields: Iterable[Field]) -> tuple[Field, ...]:
    """``fields`` of the struct that a member is, as those of the message, where ``element`` of the member stands."""
    here = element.path[-1] if element.path else Step(member.name, identifier=member.identifier)
    before = (*element.path[:-1], replace(here, member=member))
    head = name_of(before)
    return tuple(
        replace(
            one,
            name=f"{head}.{one.name}",
            at=element.at + one.at,
            path=(*before, *(one.path or (Step(one.name, None, one.count, one.bits, one.identifier),))),
            byte_order=one.byte_order or member.byte_order,
            bit_order=one.bit_order or member.bit_order,
        )
        for one in fields
    )


def members_of(fields: tuple[Field, ...]) -> tuple[Field, ...]:
    """Fields as they are declared: an array stands as one, and so does a struct."""
    if not any(field.path for field in fields):
        return fields
    return tuple(_declared(one) for one in fields if not one.path or _is_first(one))


def _is_first(field: Field) -> bool:
    """Whether it is the first field of the member in which it stands."""
    step = field.path[0]
    if step.member is None or step.struct is None:
        return not step.index
    first = step.struct.fields[0]
    return bool(field.name == f"{step.text}.{first.name}" and field.at == step.member.at + first.at)


def _declared(field: Field) -> Field:
    if not field.path:
        return field
    step = field.path[0]
    return step.member or replace(field, name=step.name, path=(), count=step.count)


def arrays_of(fields: tuple[Field, ...]) -> tuple[Field, ...]:
    """The arrays among fields, each as one, those in each struct by themselves: ``Satellites[2].Angles``."""
    firsts = (one for one in fields if one.path and one.path[-1].count and not one.path[-1].index)
    return tuple(_array(one) for one in firsts)


def _array(field: Field) -> Field:
    if len(field.path) == 1:
        return _declared(field)
    path = (*field.path[:-1], replace(field.path[-1], index=None))
    return replace(field, name=name_of(path), path=path, count=path[-1].count)
