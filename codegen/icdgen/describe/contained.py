"""Messages that a composite message contains (key ``contains``), and where their values
are in it.

A backend generates a conversion from `contained_messages`: each member of the contained
message is copied from the fields of the composite that have its bits.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.describe.description import FieldDescription, Into
from icdgen.describe.nodes import MessageDescription
from icdgen.frozen import NamedTuple
from icdgen.once import cached_by_owner


class CopiedMember(NamedTuple):
    """Member of a contained message, and the fields of the composite message that have
    its value.

    If both are arrays of the same size, the source is the array; else each element has
    a source.
    """

    member: FieldDescription
    sources: tuple[FieldDescription, ...]

    @property
    def is_whole(self) -> bool:
        """Whether a single assignment copies the member."""
        return len(self.sources) == 1 and self.sources[0].count == self.member.count


class ContainedDescription(NamedTuple):
    """Message that a composite message contains, once or several times."""

    message: MessageDescription
    # Its first bit in the composite, each time, in the order of the ICD.
    positions: tuple[int, ...]

    def copies(
        self, composite: MessageDescription, begin: int
    ) -> Iterator[CopiedMember]:
        """List its members, opening structs, with their sources in a composite from bit
        ``begin`` on.
        """
        fields, arrays = _by_position(composite)
        for member in self.message.walk(Into.ARRAYS_OF_STRUCTS):
            at = begin + member.model.at
            array = arrays.get(at) if member.count else None
            # The composite may declare the elements of an array as separate fields.
            if array is not None and array.count == member.count:
                yield CopiedMember(member, (array,))
            else:
                yield CopiedMember(
                    member,
                    tuple(
                        fields[begin + element.model.at] for element in member.elements
                    ),
                )


@cached_by_owner
def _by_position(
    composite: MessageDescription,
) -> tuple[dict[int, FieldDescription], dict[int, FieldDescription]]:
    """Return the scalars and the arrays of a composite message by their first bits.

    The composite declares the bits of contained messages in lines of its own, so its
    fields are found by their positions.
    """
    fields = {field.model.at: field for field in composite.fields}
    members = composite.walk(Into.ARRAYS_OF_STRUCTS)
    return fields, {field.model.at: field for field in members if field.count}


def contained_messages(
    composite: MessageDescription,
) -> tuple[ContainedDescription, ...]:
    """Return the messages that a composite message contains, except messages without
    fields.
    """
    positions: dict[MessageDescription, list[int]] = {}
    for part, begin in composite.contained:
        # A message without fields has no values that could be returned.
        if part.members:
            positions.setdefault(part, []).append(begin)
    return tuple(
        ContainedDescription(part, tuple(bits)) for part, bits in positions.items()
    )
