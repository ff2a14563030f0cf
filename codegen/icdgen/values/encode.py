"""Encoding of a message from assignments such as ``x=100 y=-100``.

`encode` finds the fields, converts their texts, sets constants and counters, and
returns the frame with its values. It reports all errors at once.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction

from icdgen import codec
from icdgen.describe.comments import condition_text
from icdgen.errors import UserError
from icdgen.icd.frames import FrameField
from icdgen.icd.layout import VariablePart, is_variable, struct_layout_of
from icdgen.icd.model import Icd, Message
from icdgen.values import numbers
from icdgen.values.entry import (
    members_text,
    out_of_range_text,
    parse_value,
    without_unit,
)
from icdgen.values.errors import BadValue
from icdgen.values.find import (
    find_array,
    find_field,
    find_message,
    find_node,
    items_by_name,
)
from icdgen.values.frame import (
    DecodedFrame,
    decoded_frame,
    reasons_not_listed,
    reasons_out_of_limits,
)

_EACH = "give each field as name=value"


def encode(
    icd: Icd,
    node_name: str,
    key: str,
    assignments: list[str],
    raw: bool = False,
    kind: str | None = None,
) -> DecodedFrame:
    """Return the frame of a message from ``name=value`` texts.

    Values are physical, or raw with ``raw``.

    Constants are set automatically; every other field needs a value. Values that the
    ICD does not allow (another constant, no member, beyond a limit) are errors unless
    ``raw``. Raises `NotFound`, `Ambiguous` or `BadValue`.
    """
    node = find_node(icd, node_name)
    message = find_message(icd, node_name, key, kind)
    fields = icd.longest_frame(message)
    errors = _Errors()
    given: dict[str, str] = {}
    is_empty = False  # a variable-length array is explicitly empty
    for assignment in assignments:
        with errors.collect():
            pairs = split_assignment(message, fields, assignment, node.vocabulary)
            is_empty = is_empty or not pairs
            for field, text in pairs:
                if field.name in given:
                    raise BadValue(
                        f"`{field.name}` is given twice: {given[field.name]} and {text}"
                    )
                given[field.name] = text
    has_wrong_names = bool(errors.messages)
    values, notes = _values(message, fields, given, raw, errors)
    missing: list[str] = []
    for field in fields:
        # An optional field is required only if the fields that it depends on are given,
        # and meet its conditions.
        is_decided = all(condition.field in given for condition in field.conditions)
        is_required = (
            field.is_raw
            and field.const is None
            and is_decided
            and codec.is_present(field, values)
        )
        if is_required and field.name not in given:
            missing.append(field.name)
    with errors.collect():
        _check_presence(message, fields, given, values)
    for part in message.layout.parts:
        elements = [field for field in fields if field.steps[0].node is part.node]
        missing = _without_elements(part, elements, missing, given, is_empty)
        with errors.collect():
            _set_counter(part, elements, given, values)
        for inner in part.inner:
            missing = [name for name in missing if name != inner.counter]
            with errors.collect():
                _set_inner_counter(part, inner, elements, given, values)
    # A field that seems to be missing may have been given under a wrong name.
    if not has_wrong_names:
        with errors.collect():
            _require_values(missing)
    errors.report(
        f"`icdgen show {node.name} {shlex.quote(message.name)}` lists the values of each field"
    )
    return decoded_frame(
        icd, node, message, codec.encode(icd.node(message.node), message, values), notes
    )


def _require_values(names: list[str]) -> None:
    """Raise `BadValue` if there are names of fields without a value."""
    if names:
        raise BadValue(
            "no value for " + ", ".join(f"`{name}`" for name in names), _EACH
        )


def _check_presence(
    message: Message,
    fields: Sequence[FrameField],
    given: dict[str, str],
    values: dict[str, int | bytes],
) -> None:
    """Raise `BadValue` if a value is given for an absent optional field."""
    for field in fields:
        if field.name in given and not codec.is_present(field, values):
            needs = " and ".join(
                condition_text(condition, message) for condition in field.conditions
            )
            raise BadValue(
                f"`{field.name}` is absent: it is present only if {needs}",
                f"leave `{field.name}` out",
            )


class _Errors:
    """Collects the errors of all assignments."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.helps: list[str] = []

    @contextmanager
    def collect(self, about: str = "") -> Iterator[None]:
        """Add a `UserError` that is raised in the context, with the prefix ``about``."""
        try:
            yield
        except UserError as error:
            self.messages.append(about + str(error))
            self.helps.append(error.help)

    def report(self, help: str) -> None:
        """Raise `BadValue` with all errors, if there are any.

        If their helps differ, each error has its own help.
        """
        if len(set(self.helps)) == 1:
            raise BadValue("\n".join(self.messages), self.helps[0] or help)
        if self.messages:
            pairs = zip(self.messages, self.helps, strict=True)
            raise BadValue(
                "\n".join(
                    f"{message} ({own})" if own else message for message, own in pairs
                ),
                help,
            )


def _without_elements(
    part: VariablePart,
    elements: list[FrameField],
    missing: list[str],
    given: dict[str, str],
    is_empty: bool,
) -> list[str]:
    """Return the missing names, with the name of a variable-length part instead of the
    names of its elements.

    If an element or the counter is given, the part is not missing, and `_set_counter` checks
    the elements.
    """
    names = {field.name for field in elements}
    missing = [name for name in missing if name not in names and name != part.counter]
    is_given = is_empty or part.counter in given or bool(names & given.keys())
    return missing if is_given else [*missing, part.name]


def _set_counter(
    part: VariablePart,
    elements: list[FrameField],
    given: dict[str, str],
    values: dict[str, int | bytes],
) -> None:
    """Set the counter of a variable-length part to the number of given elements or
    bytes.

    Raises `BadValue` if an element is missing, or if the counter is given with another
    number.
    """
    if not part.is_array:
        octets = values[part.name]
        assert isinstance(octets, bytes)
        count = len(octets) if part.name in given else 0
        # The codec takes the bytes of the longest frame, and cuts them to the number in
        # the counter.
        values[part.name] = octets.ljust(part.most, b"\0")
    else:
        # An element that is a struct has several fields with the same index.
        indexes = list(
            dict.fromkeys(
                field.steps[0].element or 0 for field in elements if field.name in given
            )
        )
        count = len(indexes)
        if indexes and indexes[-1] != count - 1:
            raise BadValue(
                f"`{part.name}[{indexes[-1]}]` is given, and not all elements before it"
            )
        # `_set_inner_counter` checks the arrays within the elements.
        nested = [inner.node for inner in part.inner]
        missing = []
        for field in elements:
            is_nested = any(
                step.node is node for step in field.steps for node in nested
            )
            if is_nested or (field.steps[0].element or 0) >= count:
                continue
            if field.const is None and field.name not in given:
                missing.append(field.name)
        _require_values(missing)
    if count < part.fewest:
        least = f"{part.fewest} element{'s' * (part.fewest != 1)}"
        raise BadValue(f"`{part.name}` has at least {least}, {count} given", _EACH)
    if part.counter not in given:
        values[part.counter] = count - part.plus
    elif values[part.counter] != count - part.plus:
        given_text = f"{count} element{'s' * (count != 1)} of `{part.name}` {'are' if count != 1 else 'is'} given"
        raise BadValue(
            f"`{part.counter}` is {given[part.counter]}, and {given_text}",
            f"leave `{part.counter}` out",
        )


def _set_inner_counter(
    part: VariablePart,
    inner: VariablePart,
    fields: list[FrameField],
    given: dict[str, str],
    values: dict[str, int | bytes],
) -> None:
    """Set the counter of an array in elements of a part to the number of given
    elements, which all of them must have.

    Raises `BadValue` if an element is missing, or if the counter is given with another
    number.
    """
    nested = [field for field in fields if field.steps[1].node is inner.node]
    numbers = [
        1 + (field.steps[1].element or 0) for field in nested if field.name in given
    ]
    if inner.counter in given or not numbers:
        value = values[inner.counter]
        assert isinstance(value, int)
        count = value + inner.plus
    else:
        count = max(numbers)
        # Several arrays can have the same counter; then the longest of them sets it
        # first.
        values[inner.counter] = count - inner.plus
        given[inner.counter] = str(count - inner.plus)
    if count < max(numbers, default=0) or count < inner.fewest:
        text = f"`{inner.counter}` is {count - inner.plus}, so `{inner.name}` has {count} element{'s' * (count != 1)}"
        raise BadValue(
            f"{text}, {max(numbers, default=0)} given", f"leave `{inner.counter}` out"
        )
    outer = {field.steps[0].element for field in fields if field.name in given}
    missing = []
    for field in nested:
        if (
            field.steps[0].element not in outer
            or (field.steps[1].element or 0) >= count
        ):
            continue
        if field.const is None and field.name not in given:
            missing.append(field.name)
    _require_values(missing)


def split_assignment(
    message: Message,
    fields: Sequence[FrameField],
    assignment: str,
    vocabulary: tuple[str, ...],
) -> list[tuple[FrameField, str]]:
    """Return the fields of an assignment with the texts of their values: one, or all
    elements of an array.

    An array is assigned as ``temperatures=[1, 2.5, 3]``. `fields` are the scalars of
    the longest frame. Raises `NotFound`, `Ambiguous` or `BadValue`.
    """
    # The name of a field can contain "=", so try exact names first, the longest of
    # them.
    exact = [field for field in fields if assignment.startswith(field.name + "=")]
    if exact:
        field = max(exact, key=lambda field: len(field.name))
        return [(field, assignment[len(field.name) + 1 :].strip())]
    name, equals, text = assignment.partition("=")
    if not equals:
        raise BadValue(
            f"`{assignment}` is not of the form name=value", "for instance `speed=100`"
        )
    elements = find_array(fields, name.strip(), vocabulary)
    if elements:
        has_variable_length = is_variable(elements[0].steps[0].node)
        texts = texts_of_elements(
            name.strip(), text, len(elements), has_variable_length
        )
        return list(zip(elements[: len(texts)], texts, strict=True))
    structs = items_by_name(
        [node for node in message.layout.nodes if struct_layout_of(node)],
        name,
        vocabulary,
    )
    if structs:
        has_variable_length = is_variable(structs[0])
        if has_variable_length and text.strip() == "[]":
            return []
        none = f", or `{name.strip()}=[]` for none" if has_variable_length else ""
        first = next(field for field in fields if field.steps[0].node is structs[0])
        help = f"for instance `{first.name}=1`{none}"
        raise BadValue(
            f"`{name.strip()}` is made of structs, whose fields are given one by one",
            help,
        )
    return [(find_field(message, fields, name.strip(), vocabulary), text.strip())]


def texts_of_elements(
    name: str, text: str, count: int, has_variable_length: bool = False
) -> list[str]:
    """Return the texts of the elements of an array, from ``[1, 2.5, 3]``.

    Raises `BadValue` for a wrong number.

    An array of variable length can have fewer than ``count``.
    """
    text = text.strip()
    is_list = text[:1] == "[" and text[-1:] == "]"
    if is_list and has_variable_length and not text[1:-1].strip():
        return []
    parts = [part.strip() for part in text[1:-1].split(",")] if is_list else []
    if len(parts) != count and not (
        has_variable_length and is_list and len(parts) < count
    ):
        actual = f"{len(parts)} given" if parts else f"not {text}"
        example = ", ".join(["1", "2", "3"][:count]) + (", ..." if count > 3 else "")
        help = f"`{name}=[{example}]`, or `{name}[0]=1` for one"
        up_to = "up to " if has_variable_length else ""
        raise BadValue(
            f"`{name}` takes {up_to}{count} values in brackets, {actual}", help
        )
    return parts


def _values(
    message: Message,
    fields: Sequence[FrameField],
    given: dict[str, str],
    raw: bool,
    errors: _Errors,
) -> tuple[dict[str, int | bytes], dict[str, str]]:
    """Return the raw value of each field, and a note for each value that was rounded."""
    values: dict[str, int | bytes] = {}
    notes: dict[str, str] = {}
    for field in fields:
        if field.is_raw:
            values[field.name] = codec.initial_value(message, field)
        if field.name not in given:
            continue
        text = given[field.name]
        with errors.collect(f"{field.name}: "):
            values[field.name] = value = parse_value(field, text, raw)
            if isinstance(value, bytes):
                continue
            _check_allowed(field, value, text, raw)
            # A value with a formula is rounded to the nearest raw value, which the user
            # should know.
            if not raw:
                exact = numbers.rational(without_unit(field, text))
                if (
                    field.has_formula
                    and exact is not None
                    and _differs(field, value, exact)
                ):
                    notes[field.name] = f"rounded from {text}"
    return values, notes


def _differs(field: FrameField, raw: int, exact: Fraction) -> bool:
    """Return whether the physical value of a raw value differs from the given value."""
    if field.curve is not None:
        return codec.physical_double(field, raw) != float(exact)
    return codec.physical(field, raw) != exact


def _check_allowed(field: FrameField, value: int, text: str, raw: bool) -> None:
    """Raise `BadValue` for a value that is out of range; a physical value must also
    satisfy constant, members and limits.
    """
    is_in_range = field.raw_min <= value <= field.raw_max
    if raw:
        if not is_in_range:
            raise BadValue(f"takes {field.raw_min} to {field.raw_max}, not {text}")
        return
    if is_in_range and codec.special_of(field, value):
        return
    help = "--raw encodes it anyway" if is_in_range else ""
    if reasons := reasons_not_listed(field, value):
        raise BadValue(
            f"{text} is not allowed: {'; '.join(reasons)}{members_text(field)}", help
        )
    if not is_in_range or reasons_out_of_limits(field, value):
        raise BadValue(out_of_range_text(field, text), help)
