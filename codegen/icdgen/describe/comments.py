"""Comments on messages, fields, enumerations and accessors in generated code, as
paragraphs of plain text.

Text in backticks is code; there is no other markup. Backticks in the ICD become
apostrophes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from icdgen.describe.bounds import Bound, bounds_of_limits, settable_span
from icdgen.describe.numbers import (
    array_text,
    bit_range,
    byte_count,
    byte_range,
    count_text,
    exact_text,
    length_text,
    octets_text,
    points_text,
    special_text,
    value_text,
)
from icdgen.describe.steps import Steps, steps_of_scale
from icdgen.frozen import NamedTuple
from icdgen.icd.erratum import Erratum
from icdgen.icd.layout import Array, Counted, LayoutNode, Scalar, VariablePart
from icdgen.icd.model import CONFIGURATION, Condition, Enum, Member, Message, Struct
from icdgen.icd.places import NodePlace
from icdgen.wording import listing

_LISTED = 6
"""Largest number of names that a sentence lists."""


class Comment(NamedTuple):
    """Paragraphs of a comment.

    ``head`` has one or two sentences; ``details`` and ``errata`` are further
    paragraphs.
    """

    head: str
    details: tuple[str, ...] = ()
    errata: tuple[str, ...] = ()

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """All paragraphs."""
        return self.head, *self.details, *self.errata


def one_line(text: str) -> str:
    """Return a text on one line, with single blanks between its words."""
    return (
        # Most texts are on one line already. Line breaks and tabs are not printable.
        text.strip()
        if text.isprintable() and "  " not in text
        else " ".join(text.split())
    )


@lru_cache(maxsize=8192)
def words(text: str) -> str:
    """Return text of the ICD for a paragraph: on one line, without backticks."""
    return one_line(text.replace("`", "'"))


def sentence(text: str) -> str:
    """Return `words` with a full stop; empty if there are no words."""
    text = words(text)
    return text if not text or text.endswith((".", "?", "!", ":")) else f"{text}."


def _comment(
    head: str,
    paragraphs: Iterable[str],
    errata: Iterable[Erratum],
    elsewhere: Mapping[str, str],
) -> Comment:
    """Return a comment.

    ``elsewhere`` has the parts that explain an erratum in place of this comment, by its
    id.
    """
    explained = tuple(
        f"{e.label} {words(e.id)}{e.sureness}: {_explained(e, elsewhere.get(e.id))}"
        for e in errata
    )
    return Comment(head, tuple(filter(None, paragraphs)), explained)


def _explained(erratum: Erratum, owner: str | None) -> str:
    """Return title and reason of an erratum, or a reference to the part whose comment
    has them.
    """
    return (
        f"see {words(owner)}."
        if owner
        else f"{sentence(erratum.title)} {sentence(erratum.why)}".strip()
    )


def message_comment(
    message: Message, log_bit: int | None = None, sharing: str = ""
) -> Comment:
    """Return the comment of a message: name, kind, ids, length and table; summary;
    hazard, acknowledge and other facts.

    ``log_bit`` is the bit of the log mask that selects it; ``sharing`` is a sentence on
    messages with the same id.
    """
    ids = str(message.id)
    if message.kind == CONFIGURATION:
        ids = f"set by telecommand {message.set_id}, read by telemetry {message.get_id}"
    kind = f"{message.kind}{',' if message.kind == CONFIGURATION else ''}"
    facts = [f"Dangerous: {sentence(message.hazard)}"] if message.hazard else []
    if message.expects_reset:
        facts.append("The node restarts instead of sending an acknowledge.")
    elif not message.acknowledge:
        facts.append("The node does not send an acknowledge.")
    if message.period_ms is not None:
        facts.append(f"Sent every {message.period_ms} ms.")
    if log_bit is not None:
        facts.append(f"Bit {log_bit} of the log mask.")
    facts += [sharing] if sharing else []
    facts += (
        f"Repeats {words(part.message)} from {_start_text(part.at)}."
        for part in message.contains
    )
    if message.may_end_early:
        facts.append("Trailing zeros of a frame may be omitted.")
    if message.reserved:
        facts.append(
            f"The last {'byte is' if message.reserved == 1 else f'{message.reserved} bytes are'} reserved."
        )
    head = f"{words(message.name)}: {kind} {ids}, {length_text(message)}.{_table_sentence(message.table)}"
    return _comment(
        head, (sentence(message.summary), " ".join(facts)), message.errata, {}
    )


def condition_text(condition: Condition, message: Message | None = None) -> str:
    """Return ``Mode is 1 or 2``; with the message of the field, names of an enumeration
    instead of numbers.
    """
    nodes = {node.name: node for node in message.layout.fixed} if message else {}
    node = nodes.get(condition.field)
    values = [_value_of(node, value) for value in condition.values]
    return f"{words(condition.field)} is {' or '.join(values)}"


def _value_of(field: LayoutNode | None, value: int) -> str:
    if not isinstance(field, Scalar):
        return str(value)
    if field.type == "bool":
        return "true" if value else "false"
    members = field.enum.members if field.enum is not None else ()
    return next(
        (
            words(member.name)
            for member in members
            # The name of a range would mean its other values, too.
            if member.value == value and member.to is None
        ),
        str(value),
    )


def presence_comment(field: NodePlace, message: Message) -> str:
    """Return the comment of the function that returns whether an optional field is
    present.
    """
    return f"Return whether {words(field.name)} is present: if {_conditions(field, message)}."


def _conditions(field: NodePlace, message: Message) -> str:
    return " and ".join(
        condition_text(condition, message) for condition in field.conditions
    )


def part_comment(part: Message, positions: Sequence[int]) -> str:
    """Return the comment of the function that returns a contained message."""
    return f"{words(part.name)}, repeated from {' and from '.join(map(_start_text, positions))}."


def _start_text(at: int) -> str:
    return f"byte {at // 8}" if at % 8 == 0 else f"bit {at}"


def _table_sentence(number: int | None) -> str:
    return "" if number is None else f" Table {number}."


def struct_comment(struct: Struct) -> Comment:
    """Return the comment of a struct: name, length and table; summary."""
    size = f"{'up to ' * bool(struct.layout.inner_parts)}{byte_count(struct.length)}"
    head = f"{words(struct.name)}: a struct of {size}.{_table_sentence(struct.table)}"
    return _comment(head, (sentence(struct.summary),), struct.errata, {})


def enum_comment(enum: Enum, users: Mapping[str, Sequence[str]]) -> Comment:
    """Return the comment of an enumeration: name and table; summary; fields with this
    type.

    ``users`` are the messages and structs that have these fields, by the names of the
    fields.
    """
    head = f"{words(enum.name)}: an enumeration.{_table_sentence(enum.table)}"
    return _comment(
        head, (sentence(enum.summary), _users_sentence(users)), enum.errata, {}
    )


def _users_sentence(users: Mapping[str, Sequence[str]]) -> str:
    """Return ``Used by Mode in Status and Set Mode; Boot Mode in Status.``"""
    fields = [
        f"{words(field)} in {_listed_names(list(map(words, owners)))}"
        for field, owners in users.items()
    ]
    if len(fields) > _LISTED:
        # The note takes the last place of the list, so it stands for two fields at
        # least.
        fields[_LISTED - 1 :] = [f"{len(fields) - _LISTED + 1} other fields"]
    return f"Used by {'; '.join(fields)}." if fields else ""


def _listed_names(names: Sequence[str]) -> str:
    """Return a list of the first names, and the number of others if there are many."""
    few = (
        names
        if len(names) <= _LISTED
        else [*names[: _LISTED - 1], f"{len(names) - _LISTED + 1} others"]
    )
    return listing(few)


def member_comment(member: Member, elsewhere: Mapping[str, str]) -> Comment:
    """Return the comment of a member of an enumeration: name and value; summary.

    ``elsewhere`` as for `_comment`.
    """
    return _comment(
        f"{words(member.name)} ({member.value}).",
        (sentence(member.summary),),
        member.errata,
        elsewhere,
    )


def field_comment(
    field: NodePlace, elsewhere: Mapping[str, str], message: Message
) -> Comment:
    """Return the comment of a field: name, place, range and unit; summary; conditions,
    limits and special values.

    ``elsewhere`` as for `_comment`.
    """
    parts = message.layout.parts
    if field.is_count:
        last = parts[-1]
        what = f"how much of {words(last.name)} the frame has, up to {last.most}; identified by its length"
        return Comment(f"{words(field.name)}: {what}.")
    if field.derived is not None:
        how = f"derived as `{words(field.formula)}`, computed in doubles"
        head = f"{words(field.name)}{_unit_text(field)}: {how}; it has no setter."
        return _comment(head, (sentence(field.summary),), field.errata, elsewhere)
    facts = []
    if field.is_read_only:
        facts.append("Overlay field: reads bits of other fields and has no setter.")
    if field.conditions:
        facts.append(f"Present only if {_conditions(field, message)}.")
    if field.const is not None:
        facts.append(f"Always {value_text(field.const)}.")
    if field.limits is not None:
        facts.append(_limits_sentence(field))
    facts += (
        f"{special_text(special)}: {sentence(special.meaning)}"
        for special in field.special
    )
    for part in message.layout.counted_parts:
        if part.counter == field.name:
            more = f"{abs(part.plus)} {'more' if part.plus > 0 else 'less'}"
            plus = f", of which there are {more}" if part.plus else ""
            facts.append(f"Counts {words(part.name)}{plus}: at most {part.most}.")
    own_part = next((part for part in parts if part.name == field.name), None)
    if own_part is not None:
        place = _variable_place(field, message, own_part)
    else:
        place = _place_text(field) + _inner_count(field)
        front = message.layout.part_in_front_of(field.node)
        if front is not None:
            # Behind a part of variable length the position depends on the frame.
            place = f"behind {words(front.name)}, in the longest frame {place}"
    head = f"{words(field.name)}: {place}{_values_text(field)}."
    return _comment(
        head, (sentence(field.summary), " ".join(facts)), field.errata, elsewhere
    )


def _limits_sentence(field: NodePlace) -> str:
    return f"Must be {limits_text(bounds_of_limits(field.limits), field)}, which setters do not check."


def limits_text(limits: Iterable[Bound], field: NodePlace) -> str:
    """Return limits in words: ``above 0 and at most 10 mA``."""
    return " and ".join(
        f"{bound.kind.words} {exact_text(bound.value)}" for bound in limits
    ) + _unit_text(field, " ")


def _place_text(field: NodePlace) -> str:
    if field.is_bytes:
        where = byte_range(field.at // 8, field.width // 8)
        where += f", {octets_text(field.count, field.bits)}" if field.count else ""
        return f"{where}, text filled with NUL" if field.type == "text" else where
    if field.struct is not None:
        where = byte_range(field.at // 8, field.width // 8)
        return f"{where}, {f'{field.count} ' if field.count else ''}{words(field.struct.name)}"
    where = bit_range(field.at, field.width)
    elements = array_text(field.count, field.bits) if field.count else ""
    return ", ".join(filter(None, (where, elements, orders_text(field))))


def _inner_count(field: NodePlace) -> str:
    """Return the number of elements of a variable-length array in a struct; empty for
    any other field.
    """
    size = field.node.size if isinstance(field.node, Array) else None
    return (
        f", as many as {words(count_text(size.counter, size.plus))} says"
        if isinstance(size, Counted)
        else ""
    )


def _variable_place(field: NodePlace, message: Message, part: VariablePart) -> str:
    """Return the place of a variable part: ``from byte 4 on, up to 12 elements of 16
    bits``.
    """
    if field.is_bytes and field.count:
        what = f"up to {octets_text(part.most, field.bits)}{', text filled with NUL' if field.type == 'text' else ''}"
    elif field.type == "bytes":
        what = f"up to {byte_count(part.most)}"
    elif field.type == "text":
        what = f"text of up to {part.most} character{'s' * (part.most != 1)}"
    else:
        what = f"up to {array_text(part.most, field.bits)}"
    front = message.layout.part_in_front_of(field.node)
    place = f"behind {words(front.name)}" if front else f"from byte {field.at // 8} on"
    counted = "" if part.is_rest else f"as many as {words(part.counter)} says"
    return ", ".join(filter(None, (place, what, counted, orders_text(field))))


def orders_text(field: NodePlace) -> str:
    """Return byte order and bit order, ``big-endian``, if the field or its message
    declares them; else empty.
    """
    bit = {
        "msb0": "bit 0 of a byte is the most significant",
        "lsb0": "bit 0 of a byte is the least significant",
    }
    orders = (
        f"{field.byte_order}-endian" if field.byte_order else "",
        bit.get(field.bit_order, ""),
    )
    return ", ".join(filter(None, orders))


def _values_text(field: NodePlace) -> str:
    """Return raw range, formula, physical range and unit, each after a comma."""
    text = ""
    if field.type == "float":
        text = f", {field.bits}-bit float"
    elif field.type in ("uint", "int"):
        text = f", raw {field.raw_min} to {field.raw_max}"
    if not field.has_formula:
        return text + _unit_text(field, ", in ")
    if field.curve is None:
        how = f"`{words(field.formula)}`"
    elif field.curve.points:
        how = f"by points {points_text(field.curve, 6)}"
    else:
        how = f"`{words(field.formula)}`, in doubles"
    range = span_text(field)
    if range:
        return f"{text}; physical {how}, {range}{_unit_text(field, ' ')}"
    return f"{text}; physical {how}{_unit_text(field, ', in ')}"


def span_text(field: NodePlace) -> str:
    """Return the range of the physical values, ``-327.68 to 327.67``; empty for a
    calibration without an inverse.
    """
    if field.curve is not None:
        ends = settable_span(field.curve, field)
        return " to ".join(repr(float(end)) for end in ends) if ends else ""
    scaled = steps_of_scale(field)
    return _span_text(scaled) if scaled is not None else ""


def accepted_values_text(field: NodePlace, is_narrow: bool) -> str:
    """Return the values that setters and encoders accept: ``0 to 6553.5 m/s``, ``Mode,
    0 to 15``.

    The raw range is included if the type can store other raw values.
    """
    unit = _unit_text(field, " ")
    if field.type == "float":
        return f"what {field.bits} bits of a float hold"
    raw, span = f"{field.raw_min} to {field.raw_max}", span_text(field)
    if field.enum is not None:
        return f"{words(field.enum.name)}, {raw}"
    if span:
        return f"{span}{unit}{f', raw {raw}' if is_narrow else ''}"
    return raw if field.has_formula else f"{raw}{unit}"


@lru_cache(maxsize=4096)
def _span_text(scaled: Steps) -> str:
    low, high = scaled.span
    return f"{exact_text(low)} to {exact_text(high)}"


def physical_name(field: NodePlace) -> str:
    """Return the title of a physical value: ``Roll Angle in deg``."""
    return f"{words(field.name)}{_unit_text(field) or ', as a physical value'}"


def _unit_text(field: NodePlace, before: str = " in ") -> str:
    return before + words(field.unit.symbol) if field.unit else ""


def text_comment(field: NodePlace) -> str:
    """Return the comment of the accessors of a text."""
    return f"{words(field.name)} as text: up to {field.bits // 8} ASCII characters, ending at the first NUL."


def physical_comment(field: NodePlace) -> str:
    """Return the comment of a physical value: title, range and limits."""
    limits = f" {_limits_sentence(field)}" if field.limits is not None else ""
    range = span_text(field)
    return f"{physical_name(field)}{f': {range}' if range else ''}.{limits}"
