"""The statements of a message's decode function."""

from __future__ import annotations

from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.member_groups import Flags, Groups, Row
from icdgen.backends.c.names import reading, stem
from icdgen.backends.c.statement import call
from icdgen.backends.c.text import WIDTH
from icdgen.backends.c.types import cast, type_of
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Composite, TailDescription

EMPTY = "empty"
"""Member of the struct of a message without fields: C has no empty structs."""


def statements(message: Composite[Any], groups: Groups) -> list[str]:
    """One statement a field or a group, in the order of the struct."""
    if not message.fields:
        return ["(void)buffer;", f"message->{EMPTY} = 0u;"]
    found = [_one(one) if isinstance(one, FieldDescription) else _group(one, message) for one in groups]
    if message.tail is not None and message.tail.counter.model.implied:
        found.append(
            f"message->{message.tail.counter.name} = {cast(_count(message.tail), message.tail.counter.storage.bits)};"
        )
    return found


def _count(tail: TailDescription) -> str:
    """How many elements there are in ``length`` bytes, without the fewest that there can be."""
    rest = f"length - {tail.least}u" if tail.least else "length"
    if tail.step == 1:
        return rest
    return f"({rest}) / {tail.step}u" if tail.least else f"{rest} / {tail.step}u"


def misfit_length(tail: TailDescription, longest: str, known: int = 0) -> str:
    """What holds of a ``length`` of ``known`` bytes or more that no frame has; ``longest`` is the macro of the longest."""
    tests = [f"length < {tail.least}u"] if tail.least > known else []
    tests.append(f"length > {longest}")
    if tail.step > 1:
        tests.append(f"({_rest(tail)} % {tail.step}u) != 0u")
    return " || ".join(f"({test})" for test in tests) if len(tests) > 1 else tests[0]


def _rest(tail: TailDescription) -> str:
    return f"(length - {tail.least}u)" if tail.least else "length"


def miscounted(tail: TailDescription) -> tuple[str, str, str] | None:
    """Type and reading of the count that a frame holds, as ``value``, and what holds where it is not that of its length."""
    if tail.counter.model.implied:
        return None
    bits = max(tail.counter.storage.bits, 32)
    value = "value" if tail.counter.storage.bits == bits else cast("value", bits)
    told = cast(_count(tail), bits) + (f" + {tail.low}u" if tail.low else "")
    return type_of(tail.counter), _number(tail.counter, "value"), f"{value} != {told}"


def of_inner(message: MessageDescription) -> list[dict[str, object]]:
    """How the open parts in front of the tail are found in a frame, whose fixed part is in ``buffer``, and put into one."""
    return [
        {
            "type": type_of(one.counter),
            "reading": _number(one.counter, "value"),
            "misfit": miscount(one, "value") if one.is_bound else "",
            "begin": one.begin,
            "there": _bytes(elements(one, "value"), one.step),
            "given": _bytes(elements(one), one.step),
            "miscount": miscount(one) if one.is_bound else "",
            "counter": one.counter,
        }
        for one in message.inner
    ]


def _bytes(count: str, step: int) -> str:
    return count if step == 1 else f"{count} * {step}u"


def of_elements(message: MessageDescription, tail: TailDescription) -> list[str]:
    """The statements that read the structs of an open end, each where it stands in ``buffer``."""
    name = tail.part.member
    return [
        f"(void)memset(message->{name}, 0, sizeof message->{name});",
        f"for (size_t element = 0u; element < {there(tail)}; element++) {{",
        f"{STEP}{reading(message, tail)}(&message->{name}[element], &buffer[{element_place(tail)}]);",
        "}",
    ]


def there(tail: TailDescription) -> str:
    """How many elements a frame of ``length`` bytes has."""
    count = _count(tail)
    count = f"({count})" if " " in count else count
    return count + (f" + {tail.fewest}u" if tail.fewest else "")


def element_place(tail: TailDescription) -> str:
    """The byte at which ``element`` begins."""
    offset = "element" if tail.step == 1 else f"element * {tail.step}u"
    return f"{tail.begin}u + {f'({offset})' if tail.step > 1 else offset}" if tail.begin else offset


def elements(tail: TailDescription, counter: str = "") -> str:
    """How many elements a message has."""
    count = f"ICDGEN_SIZE({counter or f'message->{tail.counter.name}'})"
    if not tail.model.plus:
        return count
    return f"({count} {'+' if tail.fewest else '-'} {abs(tail.model.plus)}u)"


def miscount(tail: TailDescription, counter: str = "") -> str:
    """What holds of a message whose count is none that it can have."""
    count = counter or f"message->{tail.counter.name}"
    tests = [f"{count} < {tail.low}u"] if tail.low else []
    tests += [f"{count} > {tail.high}u"] if tail.counter.storage.max > tail.high else []
    return " || ".join(f"({test})" for test in tests) if len(tests) > 1 else tests[0]


def _group(group: Flags | Row, message: Composite[Any]) -> str:
    members = [field.member for field in group.members]
    target = f"{stem(message)}_t", "message"
    if isinstance(group, Flags):
        value = f"buffer[{group.byte}]" + (f" >> {group.shift}" if group.shift else "")
        return call(f"ICDGEN_READ_{group.macro}", (*target, value, *members))
    value = f"&buffer[{group.byte}]"
    return call(f"ICDGEN_READ_{group.macro}", (*target, value, f"{len(members)}u", members[0], members[-1]))


def view(field: FieldDescription) -> str:
    """The statement that reads a view."""
    return _number(field, "value")


def number(field: FieldDescription) -> str:
    """The statement that reads a number into its member."""
    return _number(field, f"message->{field.member}")


def _one(field: FieldDescription) -> str:
    one = field.model
    if one.is_bytes:
        return f"(void)memcpy(message->{field.member}, &buffer[{one.at // 8}], {one.bits // 8}u);"
    return _number(field, f"message->{field.member}")


def _number(field: FieldDescription, target: str) -> str:
    read = bits.read(field)
    line = _assigned(field, target, read.whole)
    if len(STEP) + len(line) <= WIDTH or len(read.terms) == 1:
        return line
    local = f"bits_{field.model.at}"
    first, *others = read.terms
    joined = [f"uint{read.bits}_t {local} = {first};", *(f"{local} |= {term};" for term in others)]
    return f"\n{STEP}".join([*joined, _assigned(field, target, read.value.format(bits=local))])


def _assigned(field: FieldDescription, target: str, value: str) -> str:
    if field.model.type == "float":
        return call(f"icdgen_set_f{field.model.bits}", (f"&{target}", value))
    return f"{target} = {value};"
