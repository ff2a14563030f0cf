"""What examples in the documentation of code show of a message: a field, a value for it, and the frame that holds it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen import codec
from icdgen.describe.description import FieldDescription
from icdgen.describe.nodes import MessageDescription
from icdgen.icd.places import raw_fields_in

_NUMBERS = (1234, 123, 12, 1, 0)  # the first that the field takes and may hold
_FLOAT = 1.5  # the same in any width
FEW = 8  # constants in arrays that are worth showing


class Shown(NamedTuple):
    """A field and its value; ``physical`` is the double of it, None without a scale."""

    field: FieldDescription
    raw: int
    physical: float | None


class Example(NamedTuple):
    """The frame of a new message in which one field, if any is worth showing, has a value."""

    shown: Shown | None
    frame: bytes
    brief: bytes  # the same without constants in arrays, if there are many

    @property
    def runs(self) -> Iterator[tuple[int, bytes]]:
        """What is not 0 in the frame, constants in arrays only if they are few: where it begins, and its bytes."""
        start = 0
        for end in range(len(self.frame) + 1):
            if end == len(self.frame) or not self.brief[end]:
                if end > start:
                    yield start, self.frame[start:end]
                start = end + 1


def worth_showing(message: MessageDescription) -> FieldDescription | None:
    """The first field with a formula that leads back, else the first that is neither constant nor an array or struct."""
    # these are the smallest in an example, whose frame has the fewest elements
    counters = {part.counter for part in message.model.layout.parts}
    decides = {need.field.model.name for one in message.optional_members for need in one.needs}  # what else is there
    usual = [
        one
        for one in message.members
        if not one.model.when
        and one.model.name not in decides
        and one.model.const is None
        and not one.model.is_bytes
        and one.struct is None
        and not one.count
        and one.model.name not in counters
    ]
    return next((one for one in usual if one.is_scaled and one.is_settable), usual[0] if usual else None)


def example(message: MessageDescription) -> Example:
    """The example of a message."""
    field = worth_showing(message)
    shown = _shown(field) if field else None
    owners = raw_fields_in(message.model.layout)
    raw: dict[str, int | bytes] = {
        place.name: place.initial_value for place in owners if place.const is not None or place.smallest_raw
    }
    if shown is not None:
        raw[shown.field.model.name] = shown.raw
    in_arrays = {
        place.name
        for place in owners
        if place.const is not None and any(step.element is not None for step in place.steps)
    }
    few = raw if len(in_arrays) <= FEW else {name: value for name, value in raw.items() if name not in in_arrays}
    frame, brief = (codec.frame_with(message.node, message.model, values) for values in (raw, few))
    return Example(shown, frame, brief)


def _shown(field: FieldDescription) -> Shown | None:
    """The field with the first value that is a likely one and comes back from its physical value."""
    for raw in _values(field):
        physical = codec.physical_double(field.model, raw)
        if all(bound.holds(raw if physical is None else physical) for bound in field.bounds) and (
            physical is None or _comes_back(field, raw, physical)
        ):
            return Shown(field, raw, physical)
    return None


def _values(field: FieldDescription) -> list[int]:
    one = field.model
    if one.type == "float":
        return [codec.float_bits(one, _FLOAT)] if field.curve is not None or not field.bounds else []
    if field.enum is not None:
        numbers = [member.model.value for member in field.enum.members[::-1]]
    else:
        numbers = list(_NUMBERS)
    return [number for number in numbers if one.raw_min <= number <= one.raw_max]


def _comes_back(field: FieldDescription, raw: int, physical: float) -> bool:
    """Whether doubles are fine enough for it."""
    try:
        return codec.raw_from_physical(field.model, physical) == raw
    except codec.CodecError:
        return False
