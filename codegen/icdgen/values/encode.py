"""``x=100 y=-100`` -> the bytes of a message. Everything that is wrong is reported at once."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

from icdgen import codec
from icdgen.describe.comments import condition_text
from icdgen.errors import UserError
from icdgen.icd.model import Field, Icd, Message, Tail
from icdgen.values import numbers
from icdgen.values.entry import members, out_of_range, typed, without_unit
from icdgen.values.errors import BadValue
from icdgen.values.find import by_name, find_array, find_field, find_message, find_node, open_part
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
    wrong = _Wrong()
    given: dict[str, str] = {}
    is_empty = False  # the open end is said to have no element
    for assignment in assignments:
        with wrong.collect():
            pairs = split(message, assignment, node.vocabulary)
            is_empty = is_empty or not pairs
            for field, text in pairs:
                if field.name in given:
                    raise BadValue(f"`{field.name}` is given twice: {given[field.name]} and {text}")
                given[field.name] = text
    misnamed = bool(wrong.messages)
    values, notes = _values(message, given, raw, wrong)
    needed = (one for one in message.owners if one.const is None and _is_needed(one, given, values))
    missing = [one.name for one in needed if one.name not in given]
    with wrong.collect():
        _are_there(message, given, values)
    for part in message.open_parts:
        missing = _without_open(message, part, missing, given, is_empty)
        with wrong.collect():
            _count(message, part, given, values)
    if not misnamed:
        with wrong.collect():
            _require(missing)
    wrong.report(f"`icdgen show {node.name} {shlex.quote(message.name)}` lists the values of each field")
    return frame(icd, node, message, codec.encode(icd.node(message.node), message, values), notes)


def _require(names: list[str]) -> None:
    """Raises `BadValue` for fields without a value, if there are any."""
    if names:
        raise BadValue("no value for " + ", ".join(f"`{name}`" for name in names), _EACH)


def _is_needed(field: Field, given: dict[str, str], values: dict[str, int | bytes]) -> bool:
    """Whether a field must be given: one that is not always there, if what it depends on is given and says so."""
    return all(one.field in given for one in field.when) and codec.is_present(field, values)


def _are_there(message: Message, given: dict[str, str], values: dict[str, int | bytes]) -> None:
    """Raises `BadValue` for what is given and not there."""
    for field in message.fields:
        if field.name in given and not codec.is_present(field, values):
            needs = " and ".join(condition_text(one, message) for one in field.when)
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


def _without_open(message: Message, part: Tail, missing: list[str], given: dict[str, str], is_empty: bool) -> list[str]:
    """What is missing: of an open part its name alone, unless some of it is given; how many there are follows from that."""
    own = {one.name for one in message.fields if one.name == part.name or (one.path and one.path[0].name == part.name)}
    left = [name for name in missing if name not in own and name != part.counter]
    is_given = is_empty or part.counter in given or bool(own & given.keys())
    return left if is_given else [*left, part.name]


def _count(message: Message, tail: Tail, given: dict[str, str], values: dict[str, int | bytes]) -> None:
    """Counts the elements that are given, unless a number is. Raises `BadValue` where they have a gap or another number."""
    is_octets = tail.name in values
    elements = [one for one in message.fields if one.path and one.path[0].name == tail.name]
    indexes = [one.path[0].index or 0 for one in elements]
    there = list(dict.fromkeys(index for index, one in zip(indexes, elements, strict=True) if one.name in given))
    count = len(there)
    if is_octets and isinstance(octets := values[tail.name], bytes):
        count = len(octets) if tail.name in given else 0
        values[tail.name] = octets.ljust(tail.most, b"\0")
    if there and there[-1] != count - 1:
        raise BadValue(f"`{tail.name}[{there[-1]}]` is given, and not all elements before it")
    left = [one.name for index, one in zip(indexes, elements, strict=True) if index < count and one.const is None]
    _require([name for name in left if name not in given])
    if count < tail.fewest:
        least = f"{tail.fewest} element{'s' * (tail.fewest != 1)}"
        raise BadValue(f"`{tail.name}` has at least {least}, {count} given", _EACH)
    if tail.counter not in given:
        values[tail.counter] = count - tail.plus
    elif values[tail.counter] != count - tail.plus:
        given_text = f"{count} element{'s' * (count != 1)} of `{tail.name}` {'are' if count != 1 else 'is'} given"
        raise BadValue(f"`{tail.counter}` is {given[tail.counter]}, and {given_text}", f"leave `{tail.counter}` out")


def split(message: Message, assignment: str, vocabulary: tuple[str, ...]) -> list[tuple[Field, str]]:
    """The field and the text of its value, or those of all elements of an array: ``temperatures=[1, 2.5, 3]``.

    A field's name may itself hold a ``=``. Raises `NotFound`, `Ambiguous`, `BadValue`.
    """
    exact = [f for f in message.fields if assignment.startswith(f.name + "=")]
    if exact:
        field = max(exact, key=lambda f: len(f.name))
        return [(field, assignment[len(field.name) + 1 :].strip())]
    name, equals, text = assignment.partition("=")
    if not equals:
        raise BadValue(f"`{assignment}` is not of the form name=value", "for instance `speed=100`")
    elements = find_array(message, name.strip(), vocabulary)
    if elements:
        is_open = open_part(message, elements[0].path[0].name) is not None
        texts = listed(name.strip(), text, len(elements), is_open)
        return list(zip(elements[: len(texts)], texts, strict=True))
    structs = by_name([one for one in message.members if one.struct is not None], name, vocabulary)
    if structs:
        is_open = open_part(message, structs[0].name) is not None
        if is_open and text.strip() == "[]":
            return []
        none = f", or `{name.strip()}=[]` for none" if is_open else ""
        help = f"for instance `{structs[0].elements[0].name}=1`{none}"
        raise BadValue(f"`{name.strip()}` is made of structs, whose fields are given one by one", help)
    return [(find_field(message, name.strip(), vocabulary), text.strip())]


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
    message: Message, given: dict[str, str], raw: bool, wrong: _Wrong
) -> tuple[dict[str, int | bytes], dict[str, str]]:
    """Raw value of each field, and a note where a value was rounded."""
    values: dict[str, int | bytes] = {}
    notes: dict[str, str] = {}
    for field in message.fields:
        values[field.name] = field.fresh
        if field.name not in given:
            continue
        text = given[field.name]
        with wrong.collect(f"{field.name}: "):
            is_open = open_part(message, field.name) is not None
            values[field.name] = value = typed(field, text, raw, is_open)
            if isinstance(value, bytes):
                continue
            _check(field, value, text, raw)
            if not raw:
                exact = numbers.rational(without_unit(field, text))
                if field.has_formula and exact is not None and _differs(field, value, exact):
                    notes[field.name] = f"rounded from {text}"
    return values, notes


def _differs(field: Field, raw: int, exact: Fraction) -> bool:
    """Whether the physical value of a raw one is another than the one that was given."""
    if field.curve is not None:
        return codec.physical_double(field, raw) != float(exact)
    return codec.physical(field, raw) != exact


def _check(field: Field, value: int, text: str, raw: bool) -> None:
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
