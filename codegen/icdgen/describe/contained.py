"""The messages that a composite message repeats (``contains``), and which of its values are theirs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.describe.description import FieldDescription, Into
from icdgen.describe.nodes import MessageDescription


class CopiedMember(NamedTuple):
    """A member of a part, and what of the composite message has its value.

    Of an array that stands as one in both that is the array; else there is one twin for each element.
    """

    member: FieldDescription
    sources: tuple[FieldDescription, ...]

    @property
    def is_whole(self) -> bool:
        """Whether one assignment copies the member."""
        return len(self.sources) == 1 and self.sources[0].count == self.member.count


class ContainedDescription(NamedTuple):
    """A message that a composite message repeats."""

    message: MessageDescription
    positions: tuple[int, ...]  # the bits at which it does, in the order of the ICD

    def copies(self, composite: MessageDescription, begin: int) -> Iterator[CopiedMember]:
        """What its members are of a message, from a bit on; of a struct what stands in it."""
        fields = {field.model.at: field for field in composite.fields}
        arrays = {field.model.at: field for field in composite.walk(Into.ARRAYS_OF_STRUCTS) if field.count}
        for member in self.message.walk(Into.ARRAYS_OF_STRUCTS):
            at = begin + member.model.at
            array = arrays.get(at) if member.count else None
            if array is not None and array.count == member.count:
                yield CopiedMember(member, (array,))
            else:
                yield CopiedMember(member, tuple(fields[begin + one.model.at] for one in member.elements))


def contained_messages(composite: MessageDescription) -> tuple[ContainedDescription, ...]:
    """Each message that it repeats, but for those that hold nothing."""
    positions: dict[MessageDescription, list[int]] = {}
    for part, begin in composite.contained:
        if part.members:
            positions.setdefault(part, []).append(begin)
    return tuple(ContainedDescription(part, tuple(bits)) for part, bits in positions.items())
