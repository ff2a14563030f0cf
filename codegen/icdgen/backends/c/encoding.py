"""Statements of encode functions.

`encode_statements` collects the statements and terms of all fields by byte, so that
each byte of the frame is written exactly once, in order. Bytes without a field become
0.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.decoding import (
    element_count,
    elements_of_iteration,
    for_each,
    for_each_struct,
    in_bytes,
    loop_over_bytes,
    macro_of,
)
from icdgen.backends.c.names import element_writer
from icdgen.backends.c.statement import assigned_byte, call
from icdgen.backends.c.symbols import C_NAMES
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.arrays import StructArray
from icdgen.describe.description import Composite, VariablePartDescription
from icdgen.describe.groups import (
    Flags,
    FrameBytes,
    Group,
    LoopElements,
    WordRow,
)


def size_terms(message: MessageDescription) -> list[str]:
    """Return the length of the frame of a message as the terms of a sum."""
    parts = []
    for part in message.variable_parts:
        count = _encoded_elements(part)
        has_one_size = not part.inner
        parts.append(
            in_bytes(count, part.model.step)
            if has_one_size
            else f"{count} * ({_size_of_element(part)})"
        )
    fixed = message.fixed_length
    if message.has_inner_gaps:
        return [f"{fixed}u", *parts]
    if not fixed:
        return parts
    # Without gaps there is exactly one variable-length part.
    (part,) = message.variable_parts
    # The product gets parentheses next to the sum (MISRA C:2012, rule 12.1).
    return [f"{fixed}u", *(parts if part.model.step == 1 else [f"({parts[0]})"])]


def _encoded_elements(last: VariablePartDescription) -> str:
    """Return the number of elements; 0 for a counter below the smallest, which encode
    refuses.
    """
    if not last.model.low:
        return element_count(last)
    return f"((message->{last.counter.name} > {last.model.low}u) ? {element_count(last)} : 0u)"


def _size_of_element(part: VariablePartDescription) -> str:
    """Return the bytes of an element with variable-length arrays."""
    fixed = sum(chunk.fixed for chunk in part.chunks)
    arrays = (
        in_bytes(_encoded_elements(inner), inner.model.step) for inner in part.inner
    )
    grouped = (f"({array})" if " * " in array else array for array in arrays)
    return " + ".join((*([f"{fixed}u"] if fixed else []), *grouped))


def counted_text(last: VariablePartDescription) -> str:
    """Return the value of the counter for a ``text``."""
    more = last.counter_of_text
    if more < 0:
        # The difference of two `size_t` would wrap around for a text that is too short.
        return f"(strlen(text) > {-more}u) ? (strlen(text) - {-more}u) : 0u"
    return f"strlen(text) + {more}u" if more else "strlen(text)"


def encode_statements(message: MessageDescription, groups: list[Group]) -> list[str]:
    """Return the statements that write every byte of the frame once."""
    last = message.last_part
    frame = _FrameStatements(message, message, groups, message.model.length)
    if last is not None and last.element_struct is not None:
        function, (begin, step) = element_writer(message, last.field.name), last.place
        each = for_each(last.field.member, element_count(last), function, last.place)
        frame.bytes.add_whole(begin, last.model.most * step, each)
    # Without these lines, compilers warn about parameters that are not used.
    unused = [] if message.members else ["(void)message;"]
    if not message.members and not message.model.length:
        unused.append("(void)buffer;")
    return unused + frame.in_order()


def write_statements(
    message: MessageDescription, array: StructArray, groups: list[Group]
) -> list[str]:
    """Return the statements that write an element of an array of structs."""
    struct = array.element_struct
    return _FrameStatements(struct, message, groups, struct.model.length).in_order()


class _FrameStatements:
    """Statements for the bytes of a message, or of a struct in it, and variables that
    these statements need.
    """

    def __init__(
        self,
        composite: Composite[Any],
        message: MessageDescription,
        groups: Iterable[Group],
        length: int,
        frame: str = "buffer",
    ) -> None:
        self.composite, self.message = composite, message
        self.frame, self.bytes = frame, FrameBytes(length)
        self.joined: dict[int, list[str]] = {}  # byte -> variables of its terms
        for item in groups:
            if isinstance(item, FieldDescription):
                self._add_field(item)
            else:
                self._add_group(item)

    def _add_field(self, field: FieldDescription) -> None:
        place = field.model
        first, size = place.at // 8, place.width // 8
        if place.is_bytes:
            self.bytes.add_whole(
                first,
                size,
                f"(void)memcpy(&buffer[{first}], message->{field.member}, {size}u);",
            )
        elif field.is_word:
            self.bytes.add_whole(first, size, bits.store_word(field, self.frame))
        else:
            for piece in field.pieces:
                # Other fields can share the byte, so its terms are collected and
                # written by one statement.
                self.bytes.add_part(
                    piece.byte, piece.shift, bits.field_term(field, piece)
                )

    def _add_group(self, group: Flags | WordRow | LoopElements | StructArray) -> None:
        if isinstance(group, LoopElements):
            loop = group.loop
            fields = elements_of_iteration(group)
            part = _FrameStatements(
                self.composite, self.message, fields, loop.step, "part"
            )
            lines = loop_over_bytes(loop, "", part.in_order())
            self.bytes.add_whole(loop.begin, loop.length, lines)
            return
        if isinstance(group, StructArray):
            loop_over = for_each_struct(group, element_writer(self.message, group.name))
            self.bytes.add_whole(group.begin, group.length, loop_over)
            return
        names = [field.member for field in group.fields]
        byte, source = group.byte, (C_NAMES.symbol(self.composite, "t"), "message")
        if isinstance(group, WordRow):
            arguments = (
                *source,
                f"&buffer[{byte}]",
                f"{len(names)}u",
                names[0],
                names[-1],
            )
            self.bytes.add_whole(
                byte, group.length, call(f"ICDGEN_WRITE_{macro_of(group)}", arguments)
            )
            return
        macro = f"ICDGEN_JOIN_{macro_of(group)}"
        # Eight flags are a byte of their own; four share it with other terms and are
        # combined in a variable before.
        if len(names) == 8:
            self.bytes.add_whole(
                byte, 1, call(f"buffer[{byte}] = {macro}", (*source, *names))
            )
            return
        name = f"flags_{byte}" if group.shift == 0 else f"flags_{byte}_{group.shift}"
        self.joined.setdefault(byte, []).append(
            call(f"const int {name} = {macro}", (*source, *names))
        )
        self.bytes.add_part(
            byte, group.shift, f"{name} << {group.shift}" if group.shift else name
        )

    def in_order(self) -> list[str]:
        """Return the statements in the order of the bytes; bytes without a field become
        0.
        """
        lines = []
        for byte, length, statement, terms in self.bytes.segments():
            if statement is not None:
                lines.append(statement)
            elif terms:
                lines += self.joined.get(byte, ())
                lines.append(assigned_byte(f"{self.frame}[{byte}]", terms))
            elif length == 1:
                lines.append(f"buffer[{byte}] = 0u;")
            else:
                lines.append(f"(void)memset(&buffer[{byte}], 0, {length}u);")
        return lines
