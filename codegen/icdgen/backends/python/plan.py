"""How the bytes of a message become attributes and back: one struct format, one table for each byte of bits.

Fields that begin and end with a byte are items of the struct format. All other bits come in bytes of their own: fields within
one byte are looked up in a table of 256 rows, fields that cross bytes are put together from their pieces.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

from icdgen.backends.python.black import bracketed, stored
from icdgen.backends.python.statements import BODY, INNER, call, moved, table, to_bytes, total, unpacked
from icdgen.icd.model import Field, Message, Node
from icdgen.layout import byte_range, is_whole_bytes, pieces

_INTEGERS = {8: "B", 16: "H", 32: "I", 64: "Q"}
_FLOATS = {32: "f", 64: "d"}


class Plan(NamedTuple):
    """Finished source of one message's decoder and encoder."""

    format: str  # of the struct.Struct
    tables: list[str]  # definitions at module level
    unpack: str  # the statement that unpacks the frame
    assign: list[str]  # statements that follow it
    prepare: list[str]  # statements that precede packing
    pack: str  # the statements that pack the frame and return it
    floats: bool  # whether the floats module is needed


class _Item(NamedTuple):
    """One item of the struct format."""

    byte: int
    size: int
    code: str
    target: str  # what unpacking assigns it to
    value: str  # what is packed


class Planner:
    """Makes the plan of one message from its fields and their attributes."""

    def __init__(self, message: Message, node: Node, attributes: Sequence[str], enums: dict[int, str]) -> None:
        self.message, self.node, self.enums = message, node, enums
        self.items: list[_Item] = []
        self.assign: list[str] = []
        self.prepare: list[str] = []
        self.tables: dict[tuple[str, ...], str] = {}  # what makes it and of what -> its name
        self.parts: dict[int, list[tuple[int, Field, str]]] = {}  # byte -> shift, field, attribute
        self.terms: dict[int, list[str]] = {}  # byte -> what crossing fields add to it
        self.floats: list[str] = []  # 32-bit floats that the struct converts
        self.fields = list(zip(message.fields, attributes, strict=True))

    def plan(self) -> Plan:
        """The finished plan."""
        crossing = []
        shared = self._shared_bytes()
        for field, name in self.fields:
            span = byte_range(field)
            if is_whole_bytes(field) and not shared.intersection(span):
                self._whole(field, name, span.start, len(span))
            elif len(span) == 1:
                (piece,) = pieces(field, self.node)
                self.parts.setdefault(piece.byte, []).append((piece.shift, field, name))
            else:
                crossing.append((field, name))
        for field, name in crossing:
            self._take_apart(field, name)
        for byte in sorted(self.parts.keys() | self.terms.keys()):
            self._bit_byte(byte)
        for field, name in crossing:
            self._put_together(field, name)
        self.items.sort()
        self._keep_nans()
        packing = self._pack()
        floats = any("_floats." in line for line in (*self.assign, *self.prepare))
        return Plan(self._format(), self._definitions(), self._unpack(), self.assign, self.prepare, packing, floats)

    def _shared_bytes(self) -> set[int]:
        """Bytes that more than one field touches."""
        seen: set[int] = set()
        shared: set[int] = set()
        for field in self.message.fields:
            span = byte_range(field)
            shared.update(seen.intersection(span))
            seen.update(span)
        return shared

    def _table(self, prefix: str, kind: str, *arguments: str) -> str:
        """The name of a table of the module; equal ones are made once."""
        key = (kind, *arguments)
        if key not in self.tables:
            number = sum(name.startswith(prefix) for name in self.tables.values())
            self.tables[key] = f"{prefix}_{number}"
        return self.tables[key]

    def _kind(self, field: Field) -> str:
        if field.type == "enum":
            return self.enums[id(field.enum)]
        return {"bool": "bool", "int": "_codec.signed"}.get(field.type, "int")

    def _whole(self, field: Field, name: str, byte: int, size: int) -> None:
        """A field of whole bytes: one item of the struct."""
        own, local = f"self.{name}", f"v{byte}"
        if field.type == "bytes":
            self.items.append(_Item(byte, size, f"{size}s", own, local))
            self.prepare.append(call(local, "_codec.sized", own, str(size)))
        elif field.type == "float":
            self.items.append(_Item(byte, size, _FLOATS[field.bits], own, own))
            if field.bits == 32:
                self.floats.append(name)
        elif field.bits not in _INTEGERS:
            signed = ", signed=True" if field.signed else ""
            order = f'"{self.node.byte_order}"'
            self.items.append(_Item(byte, size, f"{size}s", local, local))
            self._assign(field, name, f"int.from_bytes({local}, {order}{signed})")
            self.prepare.append(to_bytes(local, own, f"to_bytes({size}, {order}{signed})"))
        else:
            code = _INTEGERS[field.bits]
            if field.type != "enum":
                self.items.append(_Item(byte, size, code.lower() if field.signed else code, own, own))
                return
            self.items.append(_Item(byte, size, code, local, own))
            if field.bits == 8:
                rows = self._table("_BITS", "bit_table", f"(0, 8, {self._kind(field)})")
                self._store(name, f"{rows}[{local}]")
            else:
                self._assign(field, name, local)

    def _store(self, name: str, value: str) -> None:
        self.assign.append(stored(BODY, f"self.{name}", value, f"value_{len(self.assign)}"))

    def _assign(self, field: Field, name: str, value: str) -> None:
        """Assigns an integer's value as its type needs it."""
        if field.type == "enum":
            value = f"{self._table('_MEMBERS', 'Members', self._kind(field))}[{value}]"
        self._store(name, value)

    def _bit_byte(self, byte: int) -> None:
        """A byte of bits: an item, the fields within it, and what crossing fields add to it."""
        local = f"v{byte}"
        self.items.append(_Item(byte, 1, "B", local, local))
        parts = sorted(self.parts.get(byte, ()), key=lambda part: part[0])
        terms = self.terms.get(byte, [])
        if parts:
            spec = (f"({shift}, {field.bits}, {self._kind(field)})" for shift, field, _ in parts)
            rows = self._table("_BITS", "bit_table", *spec)
            inverse = rows.replace("_BITS", "_BYTES")
            self.tables["Inverse", rows] = inverse
            names = [f"self.{name}" for _, _, name in parts]
            if len(names) == 1:
                self._store(parts[0][2], f"{rows}[{local}]")
            else:
                self.assign.append(unpacked(BODY, names, f"{rows}[{local}]"))
            self.prepare.append(bracketed(INNER, f"{local} = {inverse}[", names, "]").lstrip())
        for number, term in enumerate(terms):
            self.prepare.append(f"{local} {'|=' if number or parts else '='} {term}")

    def _take_apart(self, field: Field, name: str) -> None:
        """Encoding of a field that crosses bytes: its bits as an integer, and its pieces for the bytes."""
        local = f"n{field.at}"
        if field.type == "float":
            self.prepare.append(call(local, f"_floats.float{field.bits}_bits", f"self.{name}"))
        else:
            function = "signed_bits" if field.signed else "unsigned_bits"
            self.prepare.append(call(local, f"_codec.{function}", f"self.{name}", str(field.bits)))
        for piece in pieces(field, self.node):
            is_top = piece.at + piece.bits == field.bits
            term = moved(local, piece.at, 0 if is_top else piece.bits, piece.shift)
            self.terms.setdefault(piece.byte, []).append(term)

    def _put_together(self, field: Field, name: str) -> None:
        """Decoding of a field that crosses bytes."""
        local = f"n{field.at}"
        for number, piece in enumerate(pieces(field, self.node)):
            is_top = piece.shift + piece.bits == 8
            term = moved(f"v{piece.byte}", piece.shift, 0 if is_top else piece.bits, piece.at)
            self.assign.append(f"{local} {'|=' if number else '='} {term}")
        if field.type == "float":
            self._store(name, f"_floats.float{field.bits}({local})")
        elif field.signed:
            self._store(name, f"_codec.signed({local}, {field.bits})")
        else:
            self._assign(field, name, local)

    def _keep_nans(self) -> None:
        if self.floats:
            values = [f"self.{name}" for name in self.floats]
            self.assign.append(total(BODY, values))
            self.assign.append("if _floats.isnan(total):\n            _floats.keep_nans(self, data)")

    def _format(self) -> str:
        reached, codes = 0, []
        for item in self.items:
            codes += ["x"] * (item.byte - reached) + [item.code]
            reached = item.byte + item.size
        codes += ["x"] * (self.message.length - reached)
        text = ">" if self.node.byte_order == "big" else "<"
        for code, run in groupby(codes):
            count = len(list(run))
            text += code * count if code[-1] == "s" else f"{count if count > 1 else ''}{code}"
        return text

    def _definitions(self) -> list[str]:
        return [table(name, *made) for made, name in self.tables.items()]

    def _unpack(self) -> str:
        if not self.items:
            return "            _unpack(data)"
        return " " * INNER + unpacked(INNER, [item.target for item in self.items], "_unpack(data)")

    def _pack(self) -> str:
        values = [item.value for item in self.items]
        if not self.floats:
            return bracketed(INNER, "return _pack(", values, ")")
        lines = [bracketed(INNER, "frame = _pack(", values, ")")]
        lines.append(" " * INNER + total(INNER, [f"self.{name}" for name in self.floats]))
        lines.append("            return _floats.with_nans(self, frame) if _floats.isnan(total) else frame")
        return "\n".join(lines)
