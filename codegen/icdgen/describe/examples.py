"""Examples in the documentation of generated code: a field of a message, a value for
it, and the frame with it.

`example_of_message` prefers a field that can be set by a physical value. The reference
codec encodes the frame, so that a documented example can be run as a test.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen import codec
from icdgen.describe.description import FieldDescription
from icdgen.describe.nodes import MessageDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.layout import UNDECLARED, scalar_of
from icdgen.icd.layout_nodes import walk
from icdgen.icd.places import NodePlace, places_in

_NUMBERS = (1234, 123, 12, 1, 0)
"""Raw values of an example. The first that is in the range of the field is used."""
_FLOAT = 1.5
"""Value of a float in an example: exact in any width."""
FEW = 8
"""Largest number of constants in arrays for which an example shows them."""


class ExampleValue(NamedTuple):
    """Field with a value. ``physical`` is the double; None without a scale."""

    field: FieldDescription
    raw: int
    physical: float | None


class Example(NamedTuple):
    """Frame of a new message in which one field has a value, if the message has a
    suitable field.
    """

    shown: ExampleValue | None
    frame: bytes
    brief: bytes  # the frame without constants in arrays, if there are many

    @property
    def runs(self) -> Iterator[tuple[int, bytes]]:
        """Runs of bytes of the brief frame that are not 0: the first byte, and the
        bytes.
        """
        start = 0
        for end in range(len(self.frame) + 1):
            if end == len(self.frame) or not self.brief[end]:
                if end > start:
                    yield start, self.frame[start:end]
                start = end + 1


def field_of_example(message: MessageDescription) -> FieldDescription | None:
    """Return the first field that can be set by a physical value; else the first number
    that is not constant.
    """
    # Counters keep their smallest value, because the frame of an example has the fewest
    # elements.
    counters = {part.counter for part in message.model.layout.counted_parts}
    # A value of a selector could make optional fields present, and these would need
    # values as well.
    selectors = {
        need.field.model.name
        for member in message.optional_members
        for need in member.needs
    }
    numbers = [
        member
        for member in message.members
        if _is_free_number(member) and member.model.name not in counters | selectors
    ]
    scaled = (member for member in numbers if member.is_scaled and member.is_settable)
    return next(scaled, numbers[0] if numbers else None)


def _is_free_number(member: FieldDescription) -> bool:
    """Return whether a field is a single number that is always present and not
    constant.
    """
    return not (
        member.model.conditions
        or member.model.const is not None
        or member.model.is_bytes
        or member.struct is not None
        or member.count
    )


def example_of_message(message: MessageDescription) -> Example:
    """Return the example of a message."""
    field = field_of_example(message)
    shown = _shown(field) if field else None
    raw: dict[str, int | bytes] = {}
    in_arrays: set[str] = set()  # names of constants in elements of arrays
    for place in places_in(message.model.layout):
        # Most messages have no such field: the scalars of all others are not listed.
        for scalar in place.scalars() if _has_initial_value(place) else ():
            has_const = scalar.const is not None
            if scalar.is_read_only or not (has_const or scalar.smallest_raw):
                continue
            raw[scalar.name] = scalar.initial_value
            if has_const and any(step.element is not None for step in scalar.steps):
                in_arrays.add(scalar.name)
    if shown is not None:
        raw[shown.field.model.name] = shown.raw
    frame = brief = codec.encode_partial(message.node, message.model, raw)
    if len(in_arrays) > FEW:
        few = {name: value for name, value in raw.items() if name not in in_arrays}
        brief = codec.encode_partial(message.node, message.model, few)
    return Example(shown, frame, brief)


def _has_initial_value(place: NodePlace) -> bool:
    """Return whether a field, or a field of a struct, has an initial value other than 0."""
    if place.struct is None:
        return place.const is not None or place.smallest_raw > 0
    scalars = (scalar_of(visit.node) for visit in walk(place.struct, UNDECLARED))
    return any(scalar is not None and scalar.const is not None for scalar in scalars)


def _shown(field: FieldDescription) -> ExampleValue | None:
    """Return the field with the first value that is within its limits and equals the
    raw value of its physical value.
    """
    for raw in _candidate_values(field):
        physical = codec.physical_double(field.model, raw)
        if all(
            bound.holds(raw if physical is None else physical) for bound in field.bounds
        ) and (physical is None or _is_recovered(field, raw, physical)):
            return ExampleValue(field, raw, physical)
    return None


def _candidate_values(field: FieldDescription) -> list[int]:
    place = field.model
    if place.type == "float":
        return (
            [codec.float_bits(place, _FLOAT)]
            if field.curve is not None or not field.bounds
            else []
        )
    if field.enum is not None:
        numbers = [member.model.value for member in field.enum.members[::-1]]
    else:
        numbers = list(_NUMBERS)
    return [number for number in numbers if place.raw_min <= number <= place.raw_max]


def _is_recovered(field: FieldDescription, raw: int, physical: float) -> bool:
    """Return whether setting the physical value gives the raw value: 64-bit integers
    can be finer than doubles.
    """
    try:
        return codec.raw_from_physical(field.model, physical) == raw
    except codec.CodecError:
        return False
