"""How the bytes of a message become attributes and back: one struct format, one table for each byte of bits.

Fields that begin and end with a byte are items of the struct format. All other bits come in bytes of their own: fields within
one byte are looked up in a table of 256 rows, fields that cross bytes are put together from their pieces.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

from icdgen.backends.lines import bracketed, exploded
from icdgen.backends.python.names import class_name
from icdgen.backends.python.text import WIDTH
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.layout import byte_range, is_whole_bytes

_INTEGERS = {8: "B", 16: "H", 32: "I", 64: "Q"}
_FLOATS = {32: "f", 64: "d"}


_BODY, _INNER = " " * 8, " " * 12  # indentation of a method's statements, and of those in its `try`


class Packing(NamedTuple):
    """Finished source of one message's decoder and encoder; statements stand without their indentation."""

    format: str  # of the struct.Struct
    tables: list[str]  # definitions at module level
    unpack: str  # the statement that unpacks the frame
    assign: list[str]  # statements that follow it
    prepare: list[str]  # statements that precede packing
    pack: list[str]  # statements that pack the frame and return it
    floats: bool  # whether the floats module is needed


class _Item(NamedTuple):
    """One item of the struct format."""

    byte: int
    size: int
    code: str
    target: str  # what unpacking assigns it to
    value: str  # what is packed


def _is_run(field: FieldDescription) -> bool:
    """Whether it is an array of words, which are taken apart at once."""
    one = field.model
    return bool(field.count) and is_whole_bytes(one) and one.bits in _INTEGERS and one.type != "bool"


def _target(field: FieldDescription) -> str:
    """What decoding assigns a value to: the attribute, of an element a variable."""
    return f"self.{field.name}" if field.model.element is None else f"e{field.model.at}"


class Packer:
    """Makes the packing of one message."""

    def __init__(self, message: MessageDescription) -> None:
        self.message, self.order = message.model, message.node.byte_order
        self.items: list[_Item] = []
        self.assign: list[str] = []
        self.prepare: list[str] = []
        self.tables: dict[tuple[str, ...], str] = {}  # what makes it and of what -> its name
        self.parts: dict[int, list[tuple[int, FieldDescription]]] = {}  # byte -> fields within it, from bit `shift` up
        self.terms: dict[int, list[str]] = {}  # byte -> what crossing fields add to it
        self.floats: list[str] = []  # 32-bit floats that the struct converts
        self.members, self.all_fields = message.members, message.fields
        self.fields = tuple(
            part for one in self.members for part in ((one,) if _is_run(one) else one.elements or (one,))
        )

    def packing(self) -> Packing:
        """The finished packing."""
        crossing = []
        shared = self._shared_bytes()
        for field in self.fields:
            span = byte_range(field.model)
            turned_float = field.model.type == "float" and field.byte_order != self.order
            if field.count:
                self._run(field, span.start)
            elif is_whole_bytes(field.model) and not shared.intersection(span) and not turned_float:
                self._whole(field, span.start, len(span))
            elif len(span) == 1:
                (piece,) = field.pieces
                self.parts.setdefault(piece.byte, []).append((piece.shift, field))
            else:
                crossing.append(field)
        for field in crossing:
            self._take_apart(field)
        self._check_counts()
        for byte in sorted(self.parts.keys() | self.terms.keys()):
            self._bit_byte(byte)
        for field in crossing:
            self._put_together(field)
        self._join_elements()
        self.items.sort()
        self._keep_nans()
        pack = self._pack()
        floats = any("_floats." in line for line in (*self.assign, *self.prepare))
        tables = [
            bracketed(f"{name} = _codec.{kind}(", made, ")", WIDTH) for (kind, *made), name in self.tables.items()
        ]
        return Packing(self._format(), tables, self._unpack(), self.assign, self.prepare, pack, floats)

    def _shared_bytes(self) -> set[int]:
        """Bytes that more than one field touches."""
        touched = [byte for field in self.all_fields for byte in byte_range(field.model)]
        return {byte for byte, count in Counter(touched).items() if count > 1}

    def _table(self, prefix: str, kind: str, *arguments: str) -> str:
        """The name of a table of the module; equal ones are made once."""
        key = (kind, *arguments)
        if key not in self.tables:
            number = sum(name.startswith(prefix) for name in self.tables.values())
            self.tables[key] = f"{prefix}_{number}"
        return self.tables[key]

    def _kind(self, field: FieldDescription) -> str:
        if field.enum is not None:
            return class_name(field.enum)
        return {"bool": "bool", "int": "_codec.signed"}.get(field.model.type, "int")

    def _check_counts(self) -> None:
        """Arrays that are put together element by element must have all of them, and no more."""
        checks = (
            f"_codec.counted(self.{one.name}, {one.count})" for one in self.members if one.count and not _is_run(one)
        )
        self.prepare[:0] = checks

    def _join_elements(self) -> None:
        for one in self.members:
            if one.count and not _is_run(one):
                parts = [_target(element) for element in one.elements]
                line = f"self.{one.name} = {parts[0]}," if len(parts) == 1 else ""
                self.assign.append(line or bracketed(f"self.{one.name} = (", parts, ")", WIDTH, _BODY))

    def _run(self, field: FieldDescription, byte: int) -> None:
        """An array of words: one item of the struct, which a struct of its own takes apart."""
        one, own, local = field.model, f"self.{field.name}", f"v{byte}"
        is_single = one.type == "float" and one.bits == 32  # which a struct does not keep
        code = "I" if is_single else _FLOATS[one.bits] if one.type == "float" else _INTEGERS[one.bits]
        code = code.lower() if one.signed else code
        order = "<" if field.byte_order == "little" else ">"
        size = one.bits // 8 * field.count
        packed = self._table("_ARRAY", "array", f'"{order}{field.count}{code}"')
        self.items.append(_Item(byte, size, f"{size}s", local, local))
        values, given = f"{packed}.unpack({local})", own
        if is_single:
            values, given = f"tuple(map(_floats.float32, {values}))", f"map(_floats.float32_bits, {own})"
        elif field.enum is not None:
            members = self._table("_MEMBERS", "Members", self._kind(field))
            values = f"tuple(map({members}.__getitem__, {values}))"
        self.assign.append(f"{own} = {values}")
        self.prepare.append(f"{local} = {packed}.pack(*{given})")

    def _whole(self, field: FieldDescription, byte: int, size: int) -> None:
        """A field of whole bytes: one item of the struct."""
        one, own, local = field.model, f"self.{field.member}", f"v{byte}"
        target = _target(field)
        if one.is_bytes:
            self.items.append(_Item(byte, size, f"{size}s", own, local))
            self.prepare.append(f"{local} = _codec.sized({own}, {size})")
        elif one.type == "float":
            self.items.append(_Item(byte, size, _FLOATS[one.bits], target, own))
            if one.bits == 32:
                self.floats.append(own)
        elif one.bits not in _INTEGERS or (size > 1 and field.byte_order != self.order):
            how = f'"{field.byte_order}"{", signed=True" if one.signed else ""}'
            self.items.append(_Item(byte, size, f"{size}s", local, local))
            self._assign(field, f"int.from_bytes({local}, {how})")
            self.prepare.append(f"{local} = {own}.to_bytes({size}, {how})")
        elif field.enum is None:
            code = _INTEGERS[one.bits]
            self.items.append(_Item(byte, size, code.lower() if one.signed else code, target, own))
        else:
            code = _INTEGERS[one.bits]
            self.items.append(_Item(byte, size, code.lower() if one.signed else code, local, own))
            if one.bits == 8 and not one.signed:
                rows = self._table("_BITS", "bit_table", f"(0, 8, {self._kind(field)})")
                self._store(field, f"{rows}[{local}]")
            else:
                self._assign(field, local)

    def _store(self, field: FieldDescription, value: str) -> None:
        self.assign.append(f"{_target(field)} = {value}")

    def _assign(self, field: FieldDescription, value: str) -> None:
        """Assigns an integer's value as its type needs it."""
        if field.enum is not None:
            value = f"{self._table('_MEMBERS', 'Members', self._kind(field))}[{value}]"
        self._store(field, value)

    def _bit_byte(self, byte: int) -> None:
        """A byte of bits: an item, the fields within it, and what crossing fields add to it."""
        local = f"v{byte}"
        self.items.append(_Item(byte, 1, "B", local, local))
        parts = sorted(self.parts.get(byte, ()), key=lambda part: part[0])
        if parts:
            spec = (f"({shift}, {field.model.bits}, {self._kind(field)})" for shift, field in parts)
            rows = self._table("_BITS", "bit_table", *spec)
            inverse = rows.replace("_BITS", "_BYTES")
            self.tables["Inverse", rows] = inverse
            names = [f"self.{field.member}" for _, field in parts]
            if len(names) == 1:
                self._store(parts[0][1], f"{rows}[{local}]")
                self.prepare.append(f"{local} = {inverse}[{names[0]}]")
            else:
                targets = [_target(field) for _, field in parts]
                self.assign.append(_unpacked(targets, f"{rows}[{local}]", _BODY))
                self.prepare.append(bracketed(f"{local} = {inverse}[", names, "]", WIDTH, _INNER))
        for number, term in enumerate(self.terms.get(byte, [])):
            self.prepare.append(f"{local} {'|=' if number or parts else '='} {term}")

    def _take_apart(self, field: FieldDescription) -> None:
        """Encoding of a field that crosses bytes: its bits as an integer, and its pieces for the bytes."""
        one, own = field.model, f"self.{field.member}"
        local = f"n{one.at}"
        if one.type == "float":
            self.prepare.append(f"{local} = _floats.float{one.bits}_bits({own})")
        else:
            self.prepare.append(f"{local} = _codec.{'' if one.signed else 'un'}signed_bits({own}, {one.bits})")
        for piece in field.pieces:
            is_top = piece.at + piece.bits == one.bits
            term = _moved(local, piece.at, 0 if is_top else piece.bits, piece.shift)
            self.terms.setdefault(piece.byte, []).append(term)

    def _put_together(self, field: FieldDescription) -> None:
        """Decoding of a field that crosses bytes."""
        one = field.model
        local = f"n{one.at}"
        for number, piece in enumerate(field.pieces):
            is_top = piece.shift + piece.bits == 8
            term = _moved(f"v{piece.byte}", piece.shift, 0 if is_top else piece.bits, piece.at)
            self.assign.append(f"{local} {'|=' if number else '='} {term}")
        if one.type == "float":
            self._store(field, f"_floats.float{one.bits}({local})")
        else:
            self._assign(field, f"_codec.signed({local}, {one.bits})" if one.signed else local)

    def _keep_nans(self) -> None:
        if self.floats:
            self.assign.append(_total(self.floats, _BODY))
            self.assign.append(f"if _floats.isnan(total):\n{_INNER}_floats.keep_nans(self, data)")

    def _format(self) -> str:
        reached, codes = 0, []
        for item in self.items:
            codes += ["x"] * (item.byte - reached) + [item.code]
            reached = item.byte + item.size
        codes += ["x"] * (self.message.length - reached)
        text = ">" if self.order == "big" else "<"
        for code, run in groupby(codes):
            count = len(list(run))
            text += code * count if code[-1] == "s" else f"{count if count > 1 else ''}{code}"
        return text

    def _unpack(self) -> str:
        return (
            _unpacked([item.target for item in self.items], "_unpack(data)", _INNER) if self.items else "_unpack(data)"
        )

    def _pack(self) -> list[str]:
        values = [item.value for item in self.items]
        if not self.floats:
            return [bracketed("return _pack(", values, ")", WIDTH, _INNER)]
        return [
            bracketed("frame = _pack(", values, ")", WIDTH, _INNER),
            _total(self.floats, _INNER),
            "return _floats.with_nans(self, frame) if _floats.isnan(total) else frame",
        ]


def _moved(name: str, right: int, bits: int, left: int) -> str:
    """``bits`` bits (0: all) of a variable from its bit ``right`` up, ``left`` bits higher."""
    term = f"{name} >> {right}" if right else name
    if bits:
        term = f"({term})" if right else term
        term = f"{term} & 0x{(1 << bits) - 1:02X}"
    if left:
        term = f"({term})" if " " in term else term
        term = f"{term} << {left}"
    return term


def _unpacked(targets: Sequence[str], value: str, indent: str) -> str:
    """The assignment of a tuple to its targets."""
    if len(targets) == 1:
        return f"({targets[0]},) = {value}"
    line = f"{', '.join(targets)} = {value}"
    return line if len(indent) + len(line) <= WIDTH else exploded("(", targets, f") = {value}", indent)


def _total(values: Sequence[str], indent: str) -> str:
    """The sum of floats, which is NaN if one of them is. (`sum` of a tuple takes longer.)"""
    line = f"total = {' + '.join(values)}"
    if len(indent) + len(line) <= WIDTH:
        return line
    return f"total = (\n{indent}    " + f"\n{indent}    + ".join(values) + f"\n{indent})"
