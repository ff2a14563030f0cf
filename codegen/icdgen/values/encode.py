"""``x=100 y=-100`` -> the bytes of a message. Everything that is wrong is reported at once."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

from icdgen import codec
from icdgen.describe.numbers import exact_text
from icdgen.describe.steps import steps
from icdgen.errors import UserError
from icdgen.icd.model import Field, Icd, Message
from icdgen.values import numbers
from icdgen.values.entry import from_physical, members, raw_value, without_unit
from icdgen.values.errors import BadValue
from icdgen.values.find import find_array, find_field, find_message, find_node
from icdgen.values.frame import Frame, frame, violations


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
    for assignment in assignments:
        with wrong.collect():
            for field, text in split(message, assignment, node.vocabulary):
                if field.name in given:
                    raise BadValue(f"`{field.name}` is given twice: {given[field.name]} and {text}")
                given[field.name] = text
    misnamed = bool(wrong.messages)
    values, notes = _values(message, given, raw, wrong)
    missing = [f.name for f in message.owners if f.name not in given and f.const is None]
    if missing and not misnamed:
        with wrong.collect():
            raise BadValue(
                "no value for " + ", ".join(f"`{name}`" for name in missing), "give each field as name=value"
            )
    wrong.report(f"`icdgen show {node.name} {shlex.quote(message.name)}` says what each field takes")
    return frame(icd, node, message, codec.encode(icd.node(message.node), message, values), notes)


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
        if self.messages:
            raise BadValue("\n".join(self.messages), next(filter(None, self.helps), help))


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
        return list(zip(elements, listed(name.strip(), text, len(elements)), strict=True))
    return [(find_field(message, name.strip(), vocabulary), text.strip())]


def listed(name: str, text: str, count: int) -> list[str]:
    """The texts of an array's elements: of ``[1, 2.5, 3]``. Raises `BadValue`."""
    text = text.strip()
    parts = [part.strip() for part in text[1:-1].split(",")] if text[:1] == "[" and text[-1:] == "]" else []
    if len(parts) != count:
        said = f"{len(parts)} given" if parts else f"not {text}"
        some = ", ".join(["1", "2", "3"][:count]) + (", ..." if count > 3 else "")
        help = f"`{name}=[{some}]`, or `{name}[0]=1` for one"
        raise BadValue(f"`{name}` takes {count} values in brackets, {said}", help)
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
            values[field.name] = value = (raw_value if raw else from_physical)(field, text)
            if isinstance(value, bytes):
                continue
            _fits(field, value, text, raw)
            if not raw:
                _allowed(field, value, text)
                exact = numbers.rational(without_unit(field, text))
                if field.has_formula and exact is not None and _differs(field, value, exact):
                    notes[field.name] = f"rounded from {text}"
    return values, notes


def _differs(field: Field, raw: int, exact: Fraction) -> bool:
    """Whether the physical value of a raw one is another than the one that was given."""
    if field.curve is not None:
        return codec.physical_double(field, raw) != float(exact)
    return codec.physical(field, raw) != exact


def _fits(field: Field, value: int, text: str, raw: bool) -> None:
    if field.raw_min <= value <= field.raw_max:
        return
    scaled = None if raw else steps(field)
    low, high = scaled.span if scaled else (field.raw_min, field.raw_max)
    unit = f" {field.unit.symbol}" if field.unit and not raw else ""
    raise BadValue(f"takes {exact_text(low)} to {exact_text(high)}{unit}, not {text}")


def _allowed(field: Field, value: int, text: str) -> None:
    if any(s.value == value for s in field.special):
        return
    found = violations(field, value)
    if found:
        raise BadValue(f"{text} is not allowed: {'; '.join(found)}{members(field)}", "--raw sends it all the same")
