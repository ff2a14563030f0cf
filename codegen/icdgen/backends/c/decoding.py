"""Statements of decode functions.

`decode_statements` returns a statement for each field, or for each group of fields
(`icdgen.describe.groups`) that a macro of the support header reads at once. The other
functions spell lengths and counts of variable-length parts; `encoding` uses some of
them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.names import constant, element_reader
from icdgen.backends.c.statement import FAILED, call, either, length_test, loop
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.text import WIDTH
from icdgen.backends.c.types import cast, type_of
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.arrays import ArrayLoop, StructArray
from icdgen.describe.description import Chunk, Composite, VariablePartDescription
from icdgen.describe.groups import (
    Flags,
    Group,
    LoopElements,
    Thresholds,
    WordRow,
    group_fields,
)
from icdgen.describe.lengths import ElementBytes

THRESHOLDS = Thresholds(flags=(8, 4), row=8)
"""Sizes of groups for which the support header has macros."""

EMPTY = "empty"
"""Member of the struct of a message without fields, because C has no empty structs."""


def elements_of_iteration(group: LoopElements) -> tuple[FieldDescription, ...]:
    """Return the elements of an iteration, the first of which is ``element`` in the
    array.
    """
    name = group.array.member
    return group.loop.members(
        group.first,
        lambda element: f"{name}[element{f' + {element}u' if element else ''}]",
    )


def macro_of(group: Flags | WordRow) -> str:
    """Return the end of the name of the macro for a group."""
    if isinstance(group, WordRow):
        return f"ROW_{group.fields[0].order.upper()}"
    return f"{len(group.fields)}_FLAGS{'_FALLING' if group.is_falling else ''}"


def groups_of(composite: Composite[Any], prefix: str = "") -> list[Group]:
    """Return the fields of a message or struct in the groups for which the support
    header has macros.

    Names of arrays of structs start with ``prefix``.
    """
    return group_fields(composite, THRESHOLDS, prefix)


def decode_statements(message: MessageDescription, groups: list[Group]) -> list[str]:
    """Return the statements of a decode function: one per field or group, then the
    elements of the last variable part.
    """
    if not message.members:
        return ["(void)buffer;", f"message->{EMPTY} = 0u;"]
    lines = _group_statements(message, message, groups)
    last = message.last_part
    if last is not None and last.is_rest:
        count = cast(_count_from_length(last), last.counter.storage.bits)
        lines.append(f"message->{last.counter.name} = {count};")
    if last is not None and last.element_struct is not None:
        name, function = last.field.member, element_reader(message, last.field.name)
        # A frame has only some of the elements. The message may have values of an
        # earlier frame in the others.
        lines.append(f"(void)memset(message->{name}, 0, sizeof message->{name});")
        lines.append(for_each(name, elements_received(last), function, last.place))
    return lines


def read_statements(
    message: MessageDescription, array: StructArray, groups: list[Group]
) -> list[str]:
    """Return the statements that read an element of an array of structs."""
    return _group_statements(array.element_struct, message, groups)


def _group_statements(
    composite: Composite[Any], message: MessageDescription, groups: list[Group]
) -> list[str]:
    """Return a statement per field or group of a message, or of a struct in it."""
    lines = []
    for group in groups:
        if isinstance(group, FieldDescription):
            lines.append(_read_field(group))
        elif isinstance(group, StructArray):
            lines.append(for_each_struct(group, element_reader(message, group.name)))
        else:
            lines.append(_read_group(group, composite))
    return lines


def _count_from_length(part: VariablePartDescription) -> str:
    """Return the number of elements in ``length`` bytes beyond the fewest."""
    before, step = part.bytes_beyond_fewest
    # The difference does not underflow: the function tests the length before.
    remaining = f"length - {before}u" if before else "length"
    if step == 1:
        return remaining
    return f"({remaining}) / {step}u" if before else f"{remaining} / {step}u"


def misfit_length(message: MessageDescription) -> str:
    """Return the condition for a ``length`` that no frame has."""
    last = message.last_part
    longest = (
        f"{last.model.end}u"
        if last is not None and last.model.behind
        else constant(message, "length")
    )
    return either([length_test(test, longest, FAILED) for test in message.length_tests])


def test_of_count(part: VariablePartDescription) -> tuple[str, str, str] | None:
    """Return type and statement of the count in a frame, as ``value``, and the
    condition that it does not match the length.
    """
    if part.is_rest:
        return None
    bits = max(part.counter.storage.bits, 32)
    value = "value" if part.counter.storage.bits == bits else cast("value", bits)
    expected = cast(_count_from_length(part), bits) + (
        f" + {part.model.low}u" if part.model.low else ""
    )
    return (
        type_of(part.counter),
        read_number(part.counter, "value"),
        f"{value} != {expected}",
    )


def element_bytes(part: VariablePartDescription) -> str:
    """Return the bytes of an element with variable-length arrays."""
    return " + ".join(chunk_bytes(part, chunk) for chunk in part.chunks)


def chunk_bytes(part: VariablePartDescription, chunk: Chunk) -> str:
    """Return the bytes of a chunk of an element.

    The variables ``inner_1``, ``inner_2`` ... have the bytes of variable-length arrays.
    """
    terms = [f"{chunk.fixed}u"] if chunk.fixed or chunk.inner is None else []
    if chunk.inner is not None:
        terms.append(f"inner_{part.inner.index(chunk.inner) + 1}")
    return " + ".join(terms)


def counter_tests(message: MessageDescription) -> list[tuple[str, FieldDescription]]:
    """Return the conditions for counts that parts cannot have, with the counters."""
    tests = ((invalid_count(part), part.counter) for part in message.counted_parts)
    return [test for test in dict.fromkeys(tests) if test[0]]


def in_bytes(count: str, step: int) -> str:
    """Return the bytes of elements of ``step`` bytes."""
    return count if step == 1 else f"{count} * {step}u"


def for_each(name: str, count: str, function: str, bytes: ElementBytes) -> str:
    """Return the loop that calls a function with each element of an array of structs
    and its place in ``buffer``.
    """
    if count == "1u":
        return call(function, (f"&message->{name}[0]", f"&buffer[{bytes.before}]"))
    statement = call(
        function,
        (f"&message->{name}[element]", f"&buffer[{first_byte(bytes)}]"),
        depth=2,
    )
    return f"{loop('element', count)}\n{STEP * 2}{statement}\n{STEP}}}"


def for_each_struct(array: StructArray, function: str) -> str:
    """Return the loop that calls a function with each element of a complete array of
    structs.
    """
    return for_each(
        array.field.member,
        f"{array.field.count}u",
        function,
        ElementBytes(array.begin, array.step),
    )


def elements_received(part: VariablePartDescription) -> str:
    """Return the number of elements in a frame of ``length`` bytes."""
    count = _count_from_length(part)
    count = f"({count})" if " " in count else count
    return count + (f" + {part.model.fewest}u" if part.model.fewest else "")


def first_byte(bytes: ElementBytes, per_iteration: int = 1) -> str:
    """Return the first byte of ``element``, or of the iteration that starts with it."""
    begin, step = bytes
    number = "element" if per_iteration == 1 else f"(element / {per_iteration}u)"
    offset = number if step == 1 else f"{number} * {step}u"
    return f"{begin}u + {f'({offset})' if step > 1 else offset}" if begin else offset


def element_count(part: VariablePartDescription, counter: str = "") -> str:
    """Return the number of elements of a variable part in a message."""
    # Bytes are counted in `size_t`, which can hold the size of any object (C99 7.17).
    # An `unsigned int` need not.
    count = f"ICDGEN_SIZE({counter or f'message->{part.counter.name}'})"
    if not part.model.plus:
        return count
    return f"({count} {'+' if part.model.fewest else '-'} {abs(part.model.plus)}u)"


def part_bytes(part: VariablePartDescription, counter: str = "") -> str:
    """Return the number of bytes of a variable part in a message."""
    return in_bytes(element_count(part, counter), part.model.step)


def invalid_count(part: VariablePartDescription, counter: str = "") -> str:
    """Return the condition for a count that the variable part cannot have; empty if it
    can have all.
    """
    count = counter or f"message->{part.counter.name}"
    tests = [
        f"{count} {FAILED[test.kind]} {test.value}u" for test in part.counter_tests
    ]
    return either(tests) if tests else ""


def loop_over_bytes(array_loop: ArrayLoop, const: str, lines: Iterable[str]) -> str:
    """Return the loop around the lines of an iteration.

    ``part`` points to its bytes, ``const`` if they are read.
    """
    begin = first_byte(
        ElementBytes(array_loop.begin, array_loop.step), array_loop.per_iteration
    )
    pointer = f"{const}uint8_t *const part = &buffer[{begin}];"
    body = "".join(
        # Statements on several lines are indented for the body of a function, which is
        # one step less than that of the loop.
        f"{STEP * 2}{line}\n".replace(f"\n{STEP}", f"\n{STEP * 2}")
        for line in (pointer, *lines)
    )
    return f"{loop('element', f'{array_loop.elements}u', array_loop.per_iteration)}\n{body}{STEP}}}"


def _read_group(group: Flags | WordRow | LoopElements, message: Composite[Any]) -> str:
    if isinstance(group, LoopElements):
        lines = (
            read_number(element, f"message->{element.member}", "part")
            for element in elements_of_iteration(group)
        )
        return loop_over_bytes(group.loop, "const ", lines)
    members = [field.member for field in group.fields]
    target = C_NAMES.symbol(message, "t"), "message"
    if isinstance(group, Flags):
        value = f"buffer[{group.byte}]" + (f" >> {group.shift}" if group.shift else "")
        return call(f"ICDGEN_READ_{macro_of(group)}", (*target, value, *members))
    value = f"&buffer[{group.byte}]"
    return call(
        f"ICDGEN_READ_{macro_of(group)}",
        (*target, value, f"{len(members)}u", members[0], members[-1]),
    )


def _read_field(field: FieldDescription) -> str:
    place = field.model
    if place.is_bytes:
        return f"(void)memcpy(message->{field.member}, &buffer[{place.at // 8}], {place.width // 8}u);"
    return read_number(field, f"message->{field.member}")


def read_number(field: FieldDescription, target: str, frame: str = "buffer") -> str:
    """Return the statement that reads a number from the bytes at ``frame``."""
    read = bits.read_field(field, frame)
    line = _assign_raw(field, target, read.whole)
    if len(STEP) + len(line) <= WIDTH or len(read.terms) == 1:
        return line
    # In a loop the variable must not hide one of the function.
    within = "" if frame == "buffer" else f"{frame}_"
    local = f"{within}bits_{field.model.at}"
    first, *further = read.terms
    joined = [
        f"uint{read.bits}_t {local} = {first};",
        *(f"{local} |= {term};" for term in further),
    ]
    return f"\n{STEP}".join(
        [*joined, _assign_raw(field, target, read.value.format(bits=local))]
    )


def _assign_raw(field: FieldDescription, target: str, value: str) -> str:
    # C forbids access to the bits of a float through a pointer to an integer (C99,
    # 6.5), so a function copies them.
    if field.model.type == "float":
        return call(f"icdgen_set_f{field.model.bits}", (f"&{target}", value))
    return f"{target} = {value};"
