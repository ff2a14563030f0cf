"""``x=100 y=-100`` -> the bytes of a message. Everything that is wrong is reported at once."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction

from icdgen import codec
from icdgen.describe.comments import condition_text
from icdgen.errors import UserError
from icdgen.icd.frames import FrameField
from icdgen.icd.layout import VariablePart, struct_layout_of
from icdgen.icd.model import Icd, Message
from icdgen.values import numbers
from icdgen.values.entry import members, out_of_range, typed, without_unit
from icdgen.values.errors import BadValue
from icdgen.values.find import by_name, find_array, find_field, find_message, find_node
from icdgen.values.frame import Frame, frame, outside, unlisted

_EACH = "give each field as name=value"


def encode(
    icd: Icd, node_name: str, key: str, assignments: list[str], raw: bool = False, kind: str | None = None
) -> Frame:
    """The frame of a message from ``name=value`` texts; values are physical, or raw with ``raw``.

    Fields with a constant fill themselves; every other field needs a value. Values that the ICD does not allow (another
    constant, no member, beyond a limit) are refused unless ``raw``. Raises `NotFound`, `Ambiguous`, `BadValue`.
    """
    node = find_node(icd, node_name)
    message = find_message(icd, node_name, key, kind)
    fields = icd.longest_frame(message)
    wrong = _Wrong()
    given: dict[str, str] = {}
    is_empty = False  # the open end is said to have no element
    for assignment in assignments:
        with wrong.collect():
            pairs = split(message, fields, assignment, node.vocabulary)
            is_empty = is_empty or not pairs
            for field, text in pairs:
                if field.name in given:
                    raise BadValue(f"`{field.name}` is given twice: {given[field.name]} and {text}")
                given[field.name] = text
    misnamed = bool(wrong.messages)
    values, notes = _values(message, fields, given, raw, wrong)
    needed = (one for one in fields if one.is_raw and one.const is None and _is_needed(one, given, values))
    missing = [one.name for one in needed if one.name not in given]
    with wrong.collect():
        _are_there(message, fields, given, values)
    for part in message.layout.parts:
        elements = [field for field in fields if field.steps[0].node is part.node]
        missing = _without_elements(part, elements, missing, given, is_empty)
        with wrong.collect():
            _count(part, elements, given, values)
    if not misnamed:
        with wrong.collect():
            _require(missing)
    wrong.report(f"`icdgen show {node.name} {shlex.quote(message.name)}` lists the values of each field")
    return frame(icd, node, message, codec.encode(icd.node(message.node), message, values), notes)


def _require(names: list[str]) -> None:
    """Raises `BadValue` for fields without a value, if there are any."""
    if names:
        raise BadValue("no value for " + ", ".join(f"`{name}`" for name in names), _EACH)


def _is_needed(field: FrameField, given: dict[str, str], values: dict[str, int | bytes]) -> bool:
    """Whether a field must be given: one that is not always there, if what it depends on is given and says so."""
    return all(one.field in given for one in field.conditions) and codec.is_present(field, values)


def _are_there(
    message: Message, fields: Sequence[FrameField], given: dict[str, str], values: dict[str, int | bytes]
) -> None:
    """Raises `BadValue` for what is given and not there."""
    for field in fields:
        if field.name in given and not codec.is_present(field, values):
            needs = " and ".join(condition_text(one, message) for one in field.conditions)
            raise BadValue(f"`{field.name}` is not there: it is only if {needs}", f"leave `{field.name}` out")


class _Wrong:
    """Collects what is wrong, so that it is all reported at once."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.helps: list[str] = []

    @contextmanager
    def collect(self, about: str = "") -> Iterator[None]:
        try:
            yield
        except UserError as error:
            self.messages.append(about + str(error))
            self.helps.append(error.help)

    def report(self, help: str) -> None:
        """Raises `BadValue` if anything is wrong. Remedies that differ stand each with what it is good for."""
        if len(set(self.helps)) == 1:
            raise BadValue("\n".join(self.messages), self.helps[0] or help)
        if self.messages:
            pairs = zip(self.messages, self.helps, strict=True)
            raise BadValue("\n".join(f"{message} ({own})" if own else message for message, own in pairs), help)


def _without_elements(
    part: VariablePart, elements: list[FrameField], missing: list[str], given: dict[str, str], is_empty: bool
) -> list[str]:
    """Return what is missing: of a variable-length node only its name, unless some of it or its counter is given."""
    names = {field.name for field in elements}
    missing = [name for name in missing if name not in names and name != part.counter]
    is_given = is_empty or part.counter in given or bool(names & given.keys())
    return missing if is_given else [*missing, part.name]


def _count(
    part: VariablePart, elements: list[FrameField], given: dict[str, str], values: dict[str, int | bytes]
) -> None:
    """Sets the counter of a variable-length node to the number of elements, or bytes, that are given.

    Raises `BadValue` where an element is left out, or the counter is given with another number.
    """
    if not part.is_array:
        octets = values[part.name]
        assert isinstance(octets, bytes)
        count = len(octets) if part.name in given else 0
        values[part.name] = octets.ljust(part.most, b"\0")
    else:
        indexes = list(dict.fromkeys(field.steps[0].element or 0 for field in elements if field.name in given))
        count = len(indexes)
        if indexes and indexes[-1] != count - 1:
            raise BadValue(f"`{part.name}[{indexes[-1]}]` is given, and not all elements before it")
        present = (field for field in elements if (field.steps[0].element or 0) < count)
        _require([field.name for field in present if field.const is None and field.name not in given])
    if count < part.fewest:
        least = f"{part.fewest} element{'s' * (part.fewest != 1)}"
        raise BadValue(f"`{part.name}` has at least {least}, {count} given", _EACH)
    if part.counter not in given:
        values[part.counter] = count - part.plus
    elif values[part.counter] != count - part.plus:
        given_text = f"{count} element{'s' * (count != 1)} of `{part.name}` {'are' if count != 1 else 'is'} given"
        raise BadValue(f"`{part.counter}` is {given[part.counter]}, and {given_text}", f"leave `{part.counter}` out")


def split(
    message: Message, fields: Sequence[FrameField], assignment: str, vocabulary: tuple[str, ...]
) -> list[tuple[FrameField, str]]:
    """The field and the text of its value, or those of all elements of an array: ``temperatures=[1, 2.5, 3]``.

    `fields` are those of the longest frame. A field's name may itself hold a ``=``. Raises `NotFound`, `Ambiguous`,
    `BadValue`.
    """
    exact = [f for f in fields if assignment.startswith(f.name + "=")]
    if exact:
        field = max(exact, key=lambda f: len(f.name))
        return [(field, assignment[len(field.name) + 1 :].strip())]
    name, equals, text = assignment.partition("=")
    if not equals:
        raise BadValue(f"`{assignment}` is not of the form name=value", "for instance `speed=100`")
    elements = find_array(fields, name.strip(), vocabulary)
    if elements:
        has_variable_length = elements[0].steps[0].node in message.layout.sequence
        texts = listed(name.strip(), text, len(elements), has_variable_length)
        return list(zip(elements[: len(texts)], texts, strict=True))
    structs = by_name([node for node in message.layout.nodes if struct_layout_of(node)], name, vocabulary)
    if structs:
        has_variable_length = structs[0] in message.layout.sequence
        if has_variable_length and text.strip() == "[]":
            return []
        none = f", or `{name.strip()}=[]` for none" if has_variable_length else ""
        first = next(field for field in fields if field.steps[0].node is structs[0])
        help = f"for instance `{first.name}=1`{none}"
        raise BadValue(f"`{name.strip()}` is made of structs, whose fields are given one by one", help)
    return [(find_field(message, fields, name.strip(), vocabulary), text.strip())]


def listed(name: str, text: str, count: int, is_open: bool = False) -> list[str]:
    """The texts of an array's elements: of ``[1, 2.5, 3]``; of an open one there may be fewer. Raises `BadValue`."""
    text = text.strip()
    is_list = text[:1] == "[" and text[-1:] == "]"
    if is_list and is_open and not text[1:-1].strip():
        return []
    parts = [part.strip() for part in text[1:-1].split(",")] if is_list else []
    if len(parts) != count and not (is_open and is_list and len(parts) < count):
        said = f"{len(parts)} given" if parts else f"not {text}"
        some = ", ".join(["1", "2", "3"][:count]) + (", ..." if count > 3 else "")
        help = f"`{name}=[{some}]`, or `{name}[0]=1` for one"
        raise BadValue(f"`{name}` takes {'up to ' if is_open else ''}{count} values in brackets, {said}", help)
    return parts


def _values(
    message: Message, fields: Sequence[FrameField], given: dict[str, str], raw: bool, wrong: _Wrong
) -> tuple[dict[str, int | bytes], dict[str, str]]:
    """Raw value of each field, and a note where a value was rounded."""
    values: dict[str, int | bytes] = {}
    notes: dict[str, str] = {}
    for field in fields:
        if field.is_raw:
            values[field.name] = codec.initial_value(message, field)
        if field.name not in given:
            continue
        text = given[field.name]
        with wrong.collect(f"{field.name}: "):
            values[field.name] = value = typed(field, text, raw)
            if isinstance(value, bytes):
                continue
            _check(field, value, text, raw)
            if not raw:
                exact = numbers.rational(without_unit(field, text))
                if field.has_formula and exact is not None and _differs(field, value, exact):
                    notes[field.name] = f"rounded from {text}"
    return values, notes


def _differs(field: FrameField, raw: int, exact: Fraction) -> bool:
    """Whether the physical value of a raw one is another than the one that was given."""
    if field.curve is not None:
        return codec.physical_double(field, raw) != float(exact)
    return codec.physical(field, raw) != exact


def _check(field: FrameField, value: int, text: str, raw: bool) -> None:
    """Raise `BadValue` for a value that the field cannot have: of physical values by type and limits together."""
    fits = field.raw_min <= value <= field.raw_max
    if raw:
        if not fits:
            raise BadValue(f"takes {field.raw_min} to {field.raw_max}, not {text}")
        return
    if fits and codec.special_of(field, value):
        return
    help = "--raw takes it all the same" if fits else ""
    if reasons := unlisted(field, value):
        raise BadValue(f"{text} is not allowed: {'; '.join(reasons)}{members(field)}", help)
    if not fits or outside(field, value):
        raise BadValue(out_of_range(field, text), help)
