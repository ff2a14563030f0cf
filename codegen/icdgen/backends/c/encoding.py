"""The statements of a message's encode function."""

from __future__ import annotations

from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.decoding import Groups, Structs, elements, in_rounds, macro_of, members_of_round, of_array
from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import assigned_byte, call
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Composite, VariablePartDescription
from icdgen.describe.groups import Flags, FrameBytes, Rounds, Row


def size(message: MessageDescription) -> list[str]:
    """Bytes of the frame that a message makes, as the terms of a sum."""
    last = message.last_part
    assert last is not None
    parts = [
        _held(one) if one.model.step == 1 else f"{_held(one)} * {one.model.step}u"
        for one in (*message.earlier_parts, last)
    ]
    if message.earlier_parts:
        return [f"{message.model.layout.length}u", *parts]
    if not last.model.begin:
        return parts
    return [f"{last.model.begin}u", parts[0] if last.model.step == 1 else f"({parts[0]})"]


def _held(last: VariablePartDescription) -> str:
    """How many elements there are; none where the counter is smaller than any frame has it."""
    if not last.model.low:
        return elements(last)
    return f"((message->{last.counter.name} > {last.model.low}u) ? {elements(last)} : 0u)"


def counted_text(last: VariablePartDescription) -> str:
    """What the counter of an open text says of a ``text``, which is filled up to the fewest characters."""
    if last.model.fewest:
        return f"(strlen(text) > {last.model.fewest}u) ? (strlen(text) - {last.model.fewest}u) : 0u"
    return f"strlen(text) + {last.model.low}u" if last.model.low else "strlen(text)"


def statements(message: Composite[Any], groups: Groups) -> list[str]:
    """Statements that write every byte of the frame once, in order, but for structs of an open end."""
    if message.last_part is not None and message.last_part.element_struct is not None:
        return _Frame(message, groups, message.last_part.model.begin).in_order()
    frame = _Frame(message, groups, message.model.length)
    unused = [] if message.members else ["(void)message;"]
    if not message.members and not message.model.length:
        unused.append("(void)buffer;")
    return unused + frame.in_order()


class _Frame:
    """Statements for the bytes of a frame, and what has to stand before them."""

    def __init__(self, message: Composite[Any], groups: Groups, length: int, frame: str = "buffer") -> None:
        self.message, self.frame, self.bytes = message, frame, FrameBytes(length)
        self.joined: dict[int, list[str]] = {}  # byte -> statements that its terms need
        for one in groups:
            if isinstance(one, FieldDescription):
                self._one(one)
            else:
                self._group(one)

    def _one(self, field: FieldDescription) -> None:
        one = field.model
        first, size = one.at // 8, one.width // 8
        if one.is_bytes:
            self.bytes.add_whole(first, size, f"(void)memcpy(&buffer[{first}], message->{field.member}, {size}u);")
        elif field.is_word:
            self.bytes.add_whole(first, size, bits.store(field, self.frame))
        else:
            for piece in field.pieces:
                self.bytes.add_part(piece.byte, piece.shift, bits.put(field, piece))

    def _group(self, group: Flags | Row | Rounds | Structs) -> None:
        if isinstance(group, Rounds):
            rounds = group.rounds
            lines = _Frame(self.message, list(members_of_round(group)), rounds.step, "part").in_order()
            self.bytes.add_whole(rounds.begin, rounds.length, in_rounds(rounds, "", lines))
            return
        if isinstance(group, Structs):
            self.bytes.add_whole(group.array.begin, group.length, of_array(group.array, group.writing))
            return
        names = [field.member for field in group.fields]
        byte, source = group.byte, (f"{stem(self.message)}_t", "message")
        if isinstance(group, Row):
            arguments = (*source, f"&buffer[{byte}]", f"{len(names)}u", names[0], names[-1])
            self.bytes.add_whole(byte, group.length, call(f"ICDGEN_WRITE_{macro_of(group)}", arguments))
            return
        macro = f"ICDGEN_JOIN_{macro_of(group)}"
        if len(names) == 8:
            self.bytes.add_whole(byte, 1, call(f"buffer[{byte}] = {macro}", (*source, *names)))
            return
        name = f"flags_{byte}" if group.shift == 0 else f"flags_{byte}_{group.shift}"
        self.joined.setdefault(byte, []).append(call(f"const int {name} = {macro}", (*source, *names)))
        self.bytes.add_part(byte, group.shift, f"{name} << {group.shift}" if group.shift else name)

    def in_order(self) -> list[str]:
        """The statements, byte by byte; bytes without a field become 0."""
        found = []
        for byte, length, whole, parts in self.bytes.segments():
            if whole is not None:
                found.append(whole)
            elif parts:
                found += self.joined.get(byte, ())
                found.append(assigned_byte(f"{self.frame}[{byte}]", parts))
            else:
                found.append(_zero(byte, length))
        return found


def _zero(first: int, count: int) -> str:
    return f"buffer[{first}] = 0u;" if count == 1 else f"(void)memset(&buffer[{first}], 0, {count}u);"
