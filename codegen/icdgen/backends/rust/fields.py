"""Fields -> the Rust expressions and statements that read and write them."""

from __future__ import annotations

from functools import lru_cache

from icdgen.backends.rust.names import Enums, integer_type, storage
from icdgen.backends.rust.text import WIDTH, mask
from icdgen.icd.model import Field, Node
from icdgen.layout import Piece, byte_range, is_whole_bytes, pieces

LONG_NAME = 36  # longer names are bound to a short one first, so that no line has to be broken
CHAIN_WIDTH = 60  # rustfmt's: calls upon calls that are wider are broken
FLAGS_FROM = 4  # so many flags of one byte are taken from the table of the support module


def raw_type(field: Field, node: Node, enums: Enums) -> str:
    """Type of the raw value."""
    if field.type == "enum":
        return f"Coded<{enums.path(field.enum, node)}>"
    if field.type == "bytes":
        return f"[u8; {field.bits // 8}]"
    if field.type == "float":
        return f"f{field.bits}"
    return "bool" if field.type == "bool" else integer_type(field)


def is_narrow(field: Field, enums: Enums) -> bool:
    """Whether the type of the raw value holds values that the field cannot."""
    if field.type == "enum":
        return field.bits < enums.storage(field.enum)
    return field.type in ("uint", "int") and field.bits not in (8, 16, 32, 64)


def reading(field: Field, node: Node, enums: Enums, tables: set[int]) -> str:
    """Expression of the raw value, from ``bytes``; ``tables`` are the bytes whose flags stand in ``flags_N``."""
    if field.type == "bytes":
        return f"array(bytes, {field.at // 8})"
    row = pieces(field, node)
    if field.type == "bool":
        byte, shift = row[0].byte, row[0].shift
        return f"flags_{byte}[{shift}]" if byte in tables else f"bytes[{byte}] & {mask(1 << shift)} != 0"
    size = storage(field.bits)
    wider = enums.storage(field.enum) if field.type == "enum" else size
    if is_whole_bytes(field) and field.bits == size:
        return _whole(field, node, size, wider)
    if len(row) == 1:
        return _finished(field, _one_byte(row[0]), size, wider)
    lines = [f"let mut value = {_first(row[0], size)};"]
    lines += [f"value |= {_placed(piece, size)};" for piece in row[1:]]
    lines.append(_finished(field, "value", size, wider))
    body = "".join(f"\n                {line}" for line in lines)
    return f"{{{body}\n            }}"


def _whole(field: Field, node: Node, size: int, wider: int) -> str:
    first = field.at // 8
    if size == 8:
        byte = f"bytes[{first}]"
        if field.type == "enum":
            return _enum(byte, size, wider)
        return byte if field.type == "uint" else f"i8::from_le_bytes([{byte}])"
    kind = {"float": "f", "int": "i"}.get(field.type, "u")
    order = "le" if node.byte_order == "little" else "be"
    value = f"{kind}{size}::from_{order}_bytes(take!(bytes[{first}; {size // 8}]))"
    return _enum(value, size, wider) if field.type == "enum" else value


def _enum(value: str, size: int, wider: int) -> str:
    return f"Coded::from_raw({value})" if size == wider else f"Coded::from_raw(u{wider}::from({value}))"


def _finished(field: Field, value: str, size: int, wider: int) -> str:
    """The unsigned value of ``size`` bits as the field's type."""
    if field.type == "enum":
        return _enum(value, size, wider)
    if field.type == "float":
        return f"f{size}::from_bits({value})"
    if field.type == "uint":
        return value
    unused = size - field.bits
    if size == 8:
        shifted = value if not unused else f"{_parenthesised(value)} << {unused}"
        signed = f"i8::from_le_bytes([{shifted}])"
    else:
        shifted = value if not unused else f"({value} << {unused})"
        signed = f"i{size}::from_le_bytes({shifted}.to_le_bytes())"
    return f"{signed} >> {unused}" if unused else signed


def _one_byte(piece: Piece) -> str:
    byte = f"bytes[{piece.byte}]"
    if piece.shift == 0:
        return f"{byte} & {mask(piece.mask)}" if piece.bits < 8 else byte
    if piece.shift + piece.bits == 8:
        return f"{byte} >> {piece.shift}"
    return f"({byte} >> {piece.shift}) & {mask((1 << piece.bits) - 1)}"


def _parenthesised(text: str) -> str:
    return f"({text})" if " " in text else text


def _first(piece: Piece, size: int) -> str:
    return _placed(piece, size) if piece.at else _widened(piece, size)


def _widened(piece: Piece, size: int) -> str:
    return _one_byte(piece) if size == 8 else f"u{size}::from({_one_byte(piece)})"


def _placed(piece: Piece, size: int) -> str:
    value = _widened(piece, size)
    return f"{_parenthesised(value) if size == 8 else value} << {piece.at}" if piece.at else value


@lru_cache(maxsize=4096)
def _bound(name: str) -> tuple[str, tuple[str, ...]]:
    """How statements call the field, and the statement that binds a long name first."""
    if len(name) <= LONG_NAME:
        return f"self.{name}", ()
    statement = f"let value = self.{name};"
    if len(statement) + 8 > WIDTH:
        statement = f"let value =\n            self.{name};"
    return "value", (statement,)


def fitting(field: Field, name: str, constant: str) -> list[str]:
    """Statements that return with an error if the raw value does not fit its bits; ``constant`` is the entry that checks it."""
    source, before = _bound(name)
    if field.type == "enum":
        source = f"{source}.raw()"
    statement = f"{constant}.fit({source})?;"
    if len(statement) > (CHAIN_WIDTH if field.type == "enum" else WIDTH - 8):
        return [*before, *(() if source == "value" else (f"let value = {source};",)), f"{constant}.fit(value)?;"]
    return [*before, statement]


def writing(field: Field, node: Node, enums: Enums, name: str) -> list[str]:
    """Statements that put the raw value into ``bytes``, without the bits that its field has no room for."""
    source, before = _bound(name)
    lines = list(before)
    if field.type == "bytes":
        lines.append(f"put_array(&mut bytes, {field.at // 8}, &{source});")
        return lines
    row = pieces(field, node)
    if field.type == "bool":
        shift = f" << {row[0].shift}" if row[0].shift else ""
        lines.append(f"bytes[{row[0].byte}] |= u8::from({source}){shift};")
        return lines
    size = enums.storage(field.enum) if field.type == "enum" else storage(field.bits)
    narrow = is_narrow(field, enums)
    if is_whole_bytes(field) and not narrow:
        return lines + _put_whole(field, node, source, size)
    if field.type == "enum":
        source = f"{source}.raw()"
    elif field.type == "float":
        source = f"{source}.to_bits()"
    if source != "value" and len(row) > 1:
        lines.append(f"let value = {source};")
        source = "value"
    if field.type == "int":
        lines.append(f"let value = u{size}::from_le_bytes({source}.to_le_bytes());")
        source = "value"
    return lines + _put_pieces(field, row, source, size)


def _copied(first: int, count: int, source: str) -> str:
    return f"put!({source} => bytes[{first}; {count}]);"


def _put_whole(field: Field, node: Node, source: str, size: int) -> list[str]:
    first = field.at // 8
    if size == 8 and field.type != "int":
        return [f"bytes[{first}] = {source}{'.raw()' if field.type == 'enum' else ''};"]
    order = "le" if node.byte_order == "little" else "be"
    if field.type == "enum":
        return [f"let value = {source}.raw();", _copied(first, size // 8, f"value.to_{order}_bytes()")]
    return [_copied(first, size // 8, f"{source}.to_{order}_bytes()")]


def _put_pieces(field: Field, row: tuple[Piece, ...], source: str, size: int) -> list[str]:
    lines = []
    if size > 8 and all(piece.at % 8 == 0 for piece in row):
        lines.append(f"let value = {source}.to_le_bytes();")
        return lines + [_put(field, piece, f"value[{piece.at // 8}]") for piece in row]
    for piece in row:
        part = f"{source} >> {piece.at}" if piece.at else source
        if size > 8:
            part = f"{_parenthesised(part)}.to_le_bytes()[0]"
        lines.append(_put(field, piece, part))
    return lines


def _put(field: Field, piece: Piece, part: str) -> str:
    """The statement that puts the low bits of ``part`` into their byte."""
    if piece.bits == 8:
        return f"bytes[{piece.byte}] = {part};"
    if piece.shift + piece.bits < 8:
        part = f"{_parenthesised(part)} & {mask((1 << piece.bits) - 1)}"
    if piece.shift:
        part = f"{_parenthesised(part)} << {piece.shift}"
    return f"bytes[{piece.byte}] |= {part};"


def flag_tables(fields: tuple[Field, ...], node: Node) -> set[int]:
    """The bytes that hold so many flags that a table is worth its load."""
    count: dict[int, int] = {}
    for field in fields:
        if field.type == "bool":
            byte = byte_range(field)[0]
            count[byte] = count.get(byte, 0) + 1
    return {byte for byte, flags in count.items() if flags >= FLAGS_FROM}
