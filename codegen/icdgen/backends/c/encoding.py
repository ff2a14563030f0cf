"""The statements of a message's encode function."""

from __future__ import annotations

from icdgen.backends.c import bits
from icdgen.backends.c.member_groups import Flags, Groups, Row
from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import assigned_byte, call
from icdgen.describe import FieldDescription, MessageDescription


def size(message: MessageDescription) -> str:
    """Bytes of the frame that a message makes."""
    tail = message.tail
    assert tail is not None
    count = f"ICDGEN_SIZE(message->{tail.counter.name})"
    if tail.step == 1:
        return f"{tail.least}u + {count}" if tail.least else count
    return f"{tail.least}u + ({count} * {tail.step}u)" if tail.least else f"{count} * {tail.step}u"


def statements(message: MessageDescription, groups: Groups) -> list[str]:
    """Statements that write every byte of the frame once, in order."""
    frame = _Frame(message, groups)
    unused = [] if message.fields else ["(void)message;"]
    if not message.fields and not message.model.length:
        unused.append("(void)buffer;")
    return unused + frame.in_order()


class _Frame:
    """What goes where: whole bytes by a statement, others as terms that are or-ed together."""

    def __init__(self, message: MessageDescription, groups: Groups) -> None:
        self.message = message
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
        first, size = one.at // 8, one.bits // 8
        if one.is_bytes:
            self.whole[first] = size, f"(void)memcpy(&buffer[{first}], message->{field.member}, {size}u);"
        elif bits.is_word(field):
            self.whole[first] = size, bits.store(field)
        else:
            for piece in field.pieces:
                self._add(piece.byte, piece.shift, bits.put(field, piece))

    def _group(self, group: Flags | Row) -> None:
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
        byte, length = 0, self.message.model.length
        while byte < length:
            if byte in self.whole:
                size, statement = self.whole[byte]
                found.append(statement)
                byte += size
            elif byte in self.parts:
                found += self.joined.get(byte, ())
                found.append(assigned_byte(f"buffer[{byte}]", [term for _, term in sorted(self.parts[byte])]))
                byte += 1
            else:
                end = next((n for n in range(byte, length) if n in self.whole or n in self.parts), length)
                found.append(_zero(byte, end - byte))
                byte = end
        return found


def _zero(first: int, count: int) -> str:
    return f"buffer[{first}] = 0u;" if count == 1 else f"(void)memset(&buffer[{first}], 0, {count}u);"
