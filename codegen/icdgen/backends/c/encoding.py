"""The statements of a message's encode function."""

from __future__ import annotations

from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.decoding import elements, in_rounds, of_array
from icdgen.backends.c.member_groups import Array, Flags, Groups, Row, Structs
from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import assigned_byte, call
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Composite, TailDescription


def size(message: MessageDescription) -> list[str]:
    """Bytes of the frame that a message makes, as the terms of a sum."""
    tail = message.tail
    assert tail is not None
    parts = [
        _held(one) if one.model.step == 1 else f"{_held(one)} * {one.model.step}u" for one in (*message.inner, tail)
    ]
    if message.inner:
        return [f"{message.model.layout.length}u", *parts]
    if not tail.model.begin:
        return parts
    return [f"{tail.model.begin}u", parts[0] if tail.model.step == 1 else f"({parts[0]})"]


def _held(tail: TailDescription) -> str:
    """How many elements there are; none where the counter is smaller than any frame has it."""
    if not tail.model.low:
        return elements(tail)
    return f"((message->{tail.counter.name} > {tail.model.low}u) ? {elements(tail)} : 0u)"


def counted_text(tail: TailDescription) -> str:
    """What the counter of an open text says of a ``text``, which is filled up to the fewest characters."""
    if tail.model.fewest:
        return f"(strlen(text) > {tail.model.fewest}u) ? (strlen(text) - {tail.model.fewest}u) : 0u"
    return f"strlen(text) + {tail.model.low}u" if tail.model.low else "strlen(text)"


def statements(message: Composite[Any], groups: Groups) -> list[str]:
    """Statements that write every byte of the frame once, in order, but for structs of an open end."""
    if message.tail is not None and message.tail.element is not None:
        return _Frame(message, groups, message.tail.model.begin).in_order()
    frame = _Frame(message, groups, message.model.length)
    unused = [] if message.members else ["(void)message;"]
    if not message.members and not message.model.length:
        unused.append("(void)buffer;")
    return unused + frame.in_order()


class _Frame:
    """What goes where: whole bytes by a statement, others as terms that are or-ed together."""

    def __init__(self, message: Composite[Any], groups: Groups, length: int, frame: str = "buffer") -> None:
        self.message, self.length, self.frame = message, length, frame
        self.whole: dict[int, tuple[int, str]] = {}  # first byte -> number of bytes, statement
        self.parts: dict[int, list[tuple[int, str]]] = {}  # byte -> (shift, term)
        self.joined: dict[int, list[str]] = {}  # byte -> statements that its terms need
        for one in groups:
            if isinstance(one, FieldDescription):
                self._one(one)
            else:
                self._group(one)

    def _add(self, byte: int, shift: int, term: str) -> None:
        self.parts.setdefault(byte, []).append((shift, term))

    def _one(self, field: FieldDescription) -> None:
        one = field.model
        first, size = one.at // 8, one.width // 8
        if one.is_bytes:
            self.whole[first] = size, f"(void)memcpy(&buffer[{first}], message->{field.member}, {size}u);"
        elif field.is_word:
            self.whole[first] = size, bits.store(field, self.frame)
        else:
            for piece in field.pieces:
                self._add(piece.byte, piece.shift, bits.put(field, piece))

    def _group(self, group: Flags | Row | Array | Structs) -> None:
        if isinstance(group, Array):
            rounds = group.rounds
            lines = _Frame(self.message, list(group.members), rounds.step, "part").in_order()
            self.whole[rounds.begin] = rounds.length, in_rounds(rounds, "", lines)
            return
        if isinstance(group, Structs):
            self.whole[group.array.begin] = group.length, of_array(group.array, group.writing)
            return
        names = [field.member for field in group.members]
        byte, source = group.byte, (f"{stem(self.message)}_t", "message")
        if isinstance(group, Row):
            arguments = (*source, f"&buffer[{byte}]", f"{len(names)}u", names[0], names[-1])
            self.whole[byte] = group.length, call(f"ICDGEN_WRITE_{group.macro}", arguments)
            return
        macro = f"ICDGEN_JOIN_{group.macro}"
        if len(names) == 8:
            self.whole[byte] = 1, call(f"buffer[{byte}] = {macro}", (*source, *names))
            return
        name = f"flags_{byte}" if group.shift == 0 else f"flags_{byte}_{group.shift}"
        self.joined.setdefault(byte, []).append(call(f"const int {name} = {macro}", (*source, *names)))
        self._add(byte, group.shift, f"{name} << {group.shift}" if group.shift else name)

    def in_order(self) -> list[str]:
        """The statements, byte by byte; bytes without a field become 0."""
        found = []
        byte, length = 0, self.length
        while byte < length:
            if byte in self.whole:
                size, statement = self.whole[byte]
                found.append(statement)
                byte += size
            elif byte in self.parts:
                found += self.joined.get(byte, ())
                found.append(assigned_byte(f"{self.frame}[{byte}]", [term for _, term in sorted(self.parts[byte])]))
                byte += 1
            else:
                end = next((n for n in range(byte, length) if n in self.whole or n in self.parts), length)
                found.append(_zero(byte, end - byte))
                byte = end
        return found


def _zero(first: int, count: int) -> str:
    return f"buffer[{first}] = 0u;" if count == 1 else f"(void)memset(&buffer[{first}], 0, {count}u);"
