"""The statements of a message's encode function."""

from __future__ import annotations

from icdgen import layout
from icdgen.backends.c import bits
from icdgen.backends.c.plan import Plan
from icdgen.backends.c.runs import Flags, Row, row_macro
from icdgen.backends.c.statement import assigned_byte, call


class _Frame:
    """What goes where: whole bytes by a statement, others as terms that are or-ed together."""

    def __init__(self) -> None:
        self.whole: dict[int, tuple[int, str]] = {}  # first byte -> number of bytes, statement
        self.parts: dict[int, list[tuple[int, str]]] = {}  # byte -> (shift, term)
        self.joined: dict[int, list[str]] = {}  # byte -> statements that its terms need

    def add(self, byte: int, shift: int, term: str) -> None:
        self.parts.setdefault(byte, []).append((shift, term))


def statements(plan: Plan) -> list[str]:
    """Statements that write every byte of the frame once, in order."""
    frame = _Frame()
    index = 0
    while index < len(plan.members):
        run = plan.runs.get(index)
        if run is None:
            _one(frame, index, plan)
        elif isinstance(run, Row):
            _row(frame, run, plan)
        else:
            _flags(frame, run, plan)
        index += run.count if run else 1
    unused = [] if plan.members else ["(void)message;"] if plan.message.length else ["(void)message;", "(void)buffer;"]
    return unused + _in_order(frame, plan.message.length)


def _one(frame: _Frame, index: int, plan: Plan) -> None:
    field, name, storage = plan.members[index]
    first = field.at // 8
    if field.type == "bytes":
        frame.whole[first] = field.bits // 8, f"memcpy(&buffer[{first}], message->{name}, {field.bits // 8}u);"
    elif bits.is_word(field):
        frame.whole[first] = field.bits // 8, bits.store(field, plan.node, storage, name)
    else:
        for piece in layout.pieces(field, plan.node):
            frame.add(piece.byte, piece.shift, bits.put(field, piece, storage, name))


def _row(frame: _Frame, row: Row, plan: Plan) -> None:
    ends = plan.names[row.first], plan.names[row.first + row.count - 1]
    to = f"&buffer[{row.byte}]"
    statement = call(f"ICDGEN_WRITE_{row_macro(plan.node)}", (plan.type, "message", to, f"{row.count}u", *ends))
    frame.whole[row.byte] = row.length, statement


def _flags(frame: _Frame, flags: Flags, plan: Plan) -> None:
    macro, arguments = f"ICDGEN_JOIN_{flags.macro}", (plan.type, "message", *flags.arguments(plan.names))
    if flags.count == 8:
        frame.whole[flags.byte] = 1, call(f"buffer[{flags.byte}] = {macro}", arguments)
        return
    name = f"flags_{flags.byte}" if flags.shift == 0 else f"flags_{flags.byte}_{flags.shift}"
    frame.joined.setdefault(flags.byte, []).append(call(f"const int {name} = {macro}", arguments))
    frame.add(flags.byte, flags.shift, f"{name} << {flags.shift}" if flags.shift else name)


def _in_order(frame: _Frame, length: int) -> list[str]:
    found = []
    byte = 0
    while byte < length:
        if byte in frame.whole:
            size, statement = frame.whole[byte]
            found.append(statement)
            byte += size
        elif byte in frame.parts:
            found += frame.joined.get(byte, ())
            found.append(assigned_byte(f"buffer[{byte}]", [term for _, term in sorted(frame.parts[byte])]))
            byte += 1
        else:
            end = byte + 1
            while end < length and end not in frame.whole and end not in frame.parts:
                end += 1
            found.append(_zero(byte, end - byte))
            byte = end
    return found


def _zero(first: int, count: int) -> str:
    return f"buffer[{first}] = 0u;" if count == 1 else f"memset(&buffer[{first}], 0, {count}u);"


def excess(plan: Plan) -> list[tuple[str, str]]:
    """(name of the field as printed, expression that is 0 if its raw value fits) where a value may not fit."""
    found = []
    for field, name, storage in plan.members:
        expression = bits.excess(field, storage, name)
        if expression is not None:
            found.append((field.name, expression))
    return found
