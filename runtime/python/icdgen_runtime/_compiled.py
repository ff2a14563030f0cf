"""Compiler of `Message.from_bytes` and `Message.to_bytes`, at their first use.

Byte-aligned fields are items of one struct format. The other bits are read as single
bytes. Fields within one byte are looked up in a table of 256 rows. Fields that cross
bytes are assembled from their pieces.
"""

from __future__ import annotations

import struct
from itertools import groupby

from . import _codec, _floats, _types
from ._layout import byte_order, pieces
from ._types import FieldInfo, MessageFacts, StructFacts

_INTEGERS = {8: "B", 16: "H", 32: "I", 64: "Q"}
_FLOATS = {32: "f", 64: "d"}
_NO_WORDS = ("bool", "bytes", "text")
_DECODER = """\
def from_bytes(cls, data):
    self = new(cls)
    {made}
    try:
        {unpack}
    except error:
        raise length_error(cls, data) from None
    {assign}
    return self
"""
_ENCODER = """\
def to_bytes(self):
    try:
        {prepare}
        {pack}
    except ENCODING_ERRORS:
        raise range_error(self) from None
"""

_functions: dict[tuple[type, str], _types.Any] = {}


def compiled(message: type[MessageFacts], name: str) -> _types.Any:
    """Return the function ``name`` of the class that declares the fields.

    The class gets it as its method.
    """
    owner = next(base for base in message.__mro__ if "FIELDS" in vars(base))
    if (owner, name) not in _functions:
        function = longest(owner, name)
        if message.CONDITIONAL:
            from . import _conditions

            function = {
                "from_bytes": _conditions.decoder,
                "to_bytes": _conditions.encoder,
            }[name](owner, function)
        if message.TAIL is not None:
            from . import _tails

            if name == "from_bytes":
                function = _tails.decoder(owner, function)
            else:
                function = _tails.encoder(owner, function, _padding(owner))
        elif message.ENDS_EARLY and name == "from_bytes":
            from . import _tails

            function = _tails.filling_decoder(owner, function)
        _functions[owner, name] = function
        inherited = getattr(super(owner, owner), name)
        function.__doc__, function.__module__ = inherited.__doc__, owner.__module__
        function.__qualname__ = f"{owner.__qualname__}.{name}"
        if name not in vars(owner):
            setattr(
                owner, name, classmethod(function) if name == "from_bytes" else function
            )
    return _functions[owner, name]


def longest(owner: type[MessageFacts], name: str) -> _types.Any:
    """Compile the function ``name`` of the class, for frames of exactly ``LENGTH``
    bytes.
    """
    codec = Codec(owner)
    source = {"from_bytes": codec.decoder, "to_bytes": codec.encoder}[name]()
    # The source contains only numbers and names of attributes (see `_units_of`).
    code = compile(source, f"<{owner.__qualname__}.{name}>", "exec")
    exec(code, codec.names)  # noqa: S102
    return codec.names[name]


def _padding(owner: type[MessageFacts]) -> _types.Any:
    """Return the maximum number of elements of the variable-length end, all of them 0."""
    tail: _types.Any = owner.TAIL
    info = next(field for field in owner.FIELDS if field.attribute == tail.part)
    if not info.elements:
        return bytes(tail.most)
    zeros = longest(owner, "from_bytes")(owner, bytes(owner.LENGTH))
    return getattr(zeros, tail.part)


class _Item:
    """One item of the struct format."""

    __slots__ = ("byte", "code", "size", "target", "value")

    def __init__(
        self, byte: int, size: int, code: str, target: str, value: str
    ) -> None:
        self.byte, self.size, self.code = byte, size, code
        self.target = target
        """Target of the assignment in the unpacking code."""
        self.value = value
        """Expression of the packed value."""


class Codec:
    """Sources of the decoder and the encoder of a message, and the objects that they
    refer to.
    """

    def __init__(self, message: type[MessageFacts]) -> None:
        self.message, self.order = message, message.BYTE_ORDER
        self.fields = [info for info in message.FIELDS if not info.when]
        self.names: dict[str, _types.Any] = {
            "new": object.__new__,
            "error": struct.error,
            "length_error": _codec.length_error,
            "range_error": _codec.range_error,
            "ENCODING_ERRORS": _codec.ENCODING_ERRORS,
        }
        self._items: list[_Item] = []
        self._assign: list[str] = []
        self._prepare: list[str] = []
        # byte -> fields within it, from bit `shift` up
        self._parts: dict[int, list[tuple[int, FieldInfo]]] = {}
        self._terms: dict[int, list[str]] = {}  # byte -> what crossing fields add to it
        self._floats: list[str] = []  # 32-bit floats that the struct converts
        self._holders: dict[str, str] = {}  # attribute of a struct -> its variable
        self._made: list[str] = []  # statements that create the structs
        self._placed: list[str] = []  # statements that assign them to attributes
        self._arrays: list[FieldInfo] = []  # arrays whose elements are read singly
        self._plan()

    def decoder(self) -> str:
        """Return the source of ``from_bytes``."""
        targets = "".join(f"{item.target}, " for item in self._items)
        unpack = f"({targets}) = unpack(data)" if targets else "unpack(data)"
        create = _lines(self._made, 4)
        return _DECODER.format(
            made=create, unpack=unpack, assign=_lines(self._assign, 4)
        )

    def encoder(self) -> str:
        """Return the source of ``to_bytes``."""
        values = ", ".join(item.value for item in self._items)
        pack = [f"return pack({values})"]
        if self._floats:
            pack = [
                f"frame = pack({values})",
                f"if isnan({' + '.join(self._floats)}):",
                "    return with_nans(self, frame)",
            ]
            pack.append("return frame")
        return _ENCODER.format(prepare=_lines(self._prepare, 8), pack=_lines(pack, 8))

    def _plan(self) -> None:
        crossing, shared = [], self._shared_bytes()
        for info in self._units():
            span = _bytes_of(info)
            if info.elements:
                self._word_array(info, span.start)
                continue
            is_whole = info.at % 8 == info.bits % 8 == 0 and not shared.intersection(
                span
            )
            if is_whole and (info.type != "float" or self._is_in_order(info)):
                self._aligned_field(info, span.start, len(span))
            elif len(span) == 1:
                (piece,) = pieces(info, self.message)
                self._parts.setdefault(piece.byte, []).append((piece.shift, info))
            else:
                crossing.append(info)
        for info in crossing:
            self._encode_crossing(info)
        for byte in sorted(self._parts.keys() | self._terms.keys()):
            self._byte_of_bits(byte)
        for info in crossing:
            self._decode_crossing(info)
        self._join_elements()
        self._assign += reversed(self._placed)  # inner structs before outer structs
        self._items.sort(key=lambda item: item.byte)
        if self._floats:
            self.names |= {
                "isnan": _floats.isnan,
                "keep_nans": _floats.keep_nans,
                "with_nans": _floats.with_nans,
            }
            self._assign += [
                f"if isnan({' + '.join(self._floats)}):",
                "    keep_nans(self, data)",
            ]
        self.form = struct.Struct(self._format())
        self.names |= {"unpack": self.form.unpack, "pack": self.form.pack}

    def _units(self) -> _types.Iterator[FieldInfo]:
        """Iterate over the parts that are packed separately.

        These are fields, arrays of words and the elements of other arrays.
        """
        for info in self.fields:
            yield from self._units_of(info)

    def _units_of(self, info: FieldInfo) -> _types.Iterator[FieldInfo]:
        if not info.attribute.rpartition(".")[2].isidentifier():
            raise ValueError(f"{info.attribute!r} is no name of an attribute")
        if info.struct is not None:
            yield from self._within(info, info.struct)
        elif info.elements and not _is_run(info):
            self.names["check_count"] = _codec.check_count
            self._prepare.append(
                f"check_count({self._attribute_of(info)}, {info.elements})"
            )
            self._arrays.append(info)
            yield from info.parts
        else:
            yield info

    def _within(
        self, info: FieldInfo, struct: type[StructFacts]
    ) -> _types.Iterator[FieldInfo]:
        """Iterate over the fields of a struct, or of each struct of an array.

        Each struct is a local variable of the compiled function.
        """
        own, parts = self._attribute_of(info), info.parts
        kind = self._named("struct", struct)
        variables = []
        for part in parts:
            self._holders[part.attribute] = name = f"s{len(self._holders)}"
            self._made.append(f"{name} = new({kind})")
            variables.append(name)
        row = (
            "".join(f"{name}, " for name in variables)
            if info.elements
            else variables[0]
        )
        self._placed.append(f"{own} = ({row})")
        self._prepare.append(f"{row} = {own}")
        for part in parts:
            for inner in struct.FIELDS:
                yield from self._units_of(inner.within(part))

    def _attribute_of(self, info: FieldInfo) -> str:
        """Return the attribute of a field as an expression, of the message or of a
        struct in it.
        """
        holder, _, name = info.attribute.rpartition(".")
        return f"{self._holders[holder] if holder else 'self'}.{name}"

    def _target(self, info: FieldInfo) -> str:
        """Return the target of a decoded value: the attribute, or a variable for an
        element.
        """
        is_element = info.attribute.endswith("]")
        return f"e{info.at}" if is_element else self._attribute_of(info)

    def _word_array(self, info: FieldInfo, byte: int) -> None:
        """Add an array of words: one item of the struct format, which a second format
        splits.
        """
        own, local = self._attribute_of(info), f"v{byte}"
        # `struct` makes signalling 32-bit NaNs quiet: unpack these floats as integers.
        is_single = info.type == "float" and info.bits == 32
        code = (_INTEGERS if info.type != "float" or is_single else _FLOATS)[info.bits]
        code = code.lower() if info.signed else code
        order = "<" if byte_order(info, self.message) == "little" else ">"
        words = struct.Struct(f"{order}{info.elements}{code}")
        unpack = self._named("unpack", words.unpack)
        pack = self._named("pack", words.pack)
        self._items.append(_Item(byte, words.size, f"{words.size}s", local, local))
        values, given = f"{unpack}({local})", own
        if is_single:
            value_of = self._named("value_of", _floats.float32)
            bits_of = self._named("bits_of", _floats.float32_bits)
            values, given = (
                f"tuple(map({value_of}, {values}))",
                f"map({bits_of}, {own})",
            )
        elif info.enum is not None:
            members = self._named("members", _codec.Members(info.enum).__getitem__)
            values = f"tuple(map({members}, {values}))"
        self._assign.append(f"{own} = {values}")
        self._prepare.append(f"{local} = {pack}(*{given})")

    def _join_elements(self) -> None:
        for info in self._arrays:
            values = "".join(f"{self._target(part)}, " for part in info.parts)
            self._assign.append(f"{self._attribute_of(info)} = ({values})")

    def _shared_bytes(self) -> set[int]:
        """Return the bytes that contain bits of more than one field."""
        once: set[int] = set()
        more: set[int] = set()
        for info in (leaf for field in self.fields for leaf in field.leaves):
            span = _bytes_of(info)
            more |= once.intersection(span)
            once.update(span)
        return more

    def _is_in_order(self, info: FieldInfo) -> bool:
        return byte_order(info, self.message) == self.order

    def _named(self, stem: str, value: _types.Any) -> str:
        """Return a new name for an object that the sources refer to."""
        name = f"{stem}{len(self.names)}"
        self.names[name] = value
        return name

    def _aligned_field(self, info: FieldInfo, byte: int, size: int) -> None:
        """Add a byte-aligned field: one item of the struct format."""
        own, local, target = self._attribute_of(info), f"v{byte}", self._target(info)
        code = _INTEGERS.get(info.bits, "")
        if info.type in ("bytes", "text"):
            self._items.append(_Item(byte, size, f"{size}s", target, local))
            self.names["checked_bytes"] = _codec.checked_bytes
            self._prepare.append(f"{local} = checked_bytes({own}, {size})")
        elif info.type == "float" and info.bits == 32 and "." in info.attribute:
            # Unpacked as an integer, as `with_nans` knows only fields of the message.
            self._items.append(_Item(byte, size, code, local, local))
            self._store(info, f"{self._named('value_of', _floats.float32)}({local})")
            bits_of = self._named("bits_of", _floats.float32_bits)
            self._prepare.append(f"{local} = {bits_of}({own})")
        elif info.type == "float":
            self._items.append(_Item(byte, size, _FLOATS[info.bits], target, own))
            if info.bits == 32:
                self._floats.append(own)
        elif not code or (size > 1 and not self._is_in_order(info)):
            how = f'"{byte_order(info, self.message)}"{", signed=True" if info.signed else ""}'
            self._items.append(_Item(byte, size, f"{size}s", local, local))
            self._store(info, f"int.from_bytes({local}, {how})")
            self._prepare.append(f"{local} = {own}.to_bytes({size}, {how})")
        else:
            code = code.lower() if info.signed else code
            self._items.append(
                _Item(byte, size, code, target if info.enum is None else local, own)
            )
            if info.bits == 8 and info.enum is not None and not info.signed:
                rows = self._named("rows", _codec.bit_table(((0, info),)))
                self._assign.append(f"{target} = {rows}[{local}]")
            elif info.enum is not None:
                self._store(info, local)

    def _store(self, info: FieldInfo, value: str) -> None:
        """Assign the decoded value, converted to the type of the field."""
        if info.enum is not None:
            value = f"{self._named('members', _codec.Members(info.enum))}[{value}]"
        self._assign.append(f"{self._target(info)} = {value}")

    def _byte_of_bits(self, byte: int) -> None:
        """Add a byte with fields of single bits: an item, a table, and pieces of
        crossing fields.
        """
        local = f"v{byte}"
        self._items.append(_Item(byte, 1, "B", local, local))
        parts = sorted(self._parts.get(byte, ()), key=lambda part: part[0])
        if parts:
            table = _codec.bit_table(tuple((shift, info) for shift, info in parts))
            rows = self._named("rows", table)
            inverse = self._named("bytes", _codec.Inverse(table))
            names = ", ".join(self._attribute_of(info) for _, info in parts)
            targets = ", ".join(self._target(info) for _, info in parts)
            self._assign.append(f"{targets} = {rows}[{local}]")
            self._prepare.append(f"{local} = {inverse}[{names}]")
        for number, term in enumerate(self._terms.get(byte, [])):
            self._prepare.append(f"{local} {'|=' if number or parts else '='} {term}")

    def _encode_crossing(self, info: FieldInfo) -> None:
        """Encode a field that crosses bytes: its bits as an integer, and its pieces for
        the bytes.
        """
        own, local = self._attribute_of(info), f"n{info.at}"
        if info.type == "float":
            bits_of = self._named(
                "bits_of",
                _floats.float32_bits if info.bits == 32 else _floats.float64_bits,
            )
            self._prepare.append(f"{local} = {bits_of}({own})")
        else:
            bits_of = self._named(
                "bits_of", _codec.signed_bits if info.signed else _codec.unsigned_bits
            )
            self._prepare.append(f"{local} = {bits_of}({own}, {info.bits})")
        for piece in pieces(info, self.message):
            term = f"({local} >> {piece.at} & {(1 << piece.bits) - 1}) << {piece.shift}"
            self._terms.setdefault(piece.byte, []).append(term)

    def _decode_crossing(self, info: FieldInfo) -> None:
        """Decode a field that crosses bytes."""
        runs = pieces(info, self.message)
        value = " | ".join(
            f"(v{piece.byte} >> {piece.shift} & {(1 << piece.bits) - 1}) << {piece.at}"
            for piece in runs
        )
        if info.type == "float":
            value_of = self._named(
                "value_of", _floats.float32 if info.bits == 32 else _floats.float64
            )
            value = f"{value_of}({value})"
        elif info.signed:
            value = f"{self._named('signed', _codec.signed)}({value}, {info.bits})"
        self._store(info, value)

    def _format(self) -> str:
        """Return the struct format, with pad bytes between the items."""
        reached = 0
        codes: list[str] = []
        for item in self._items:
            codes += ["x"] * (item.byte - reached) + [item.code]
            reached = item.byte + item.size
        codes += ["x"] * (self.message.LENGTH - reached)
        runs = ((code, len([*same])) for code, same in groupby(codes))
        order = ">" if self.order == "big" else "<"
        return order + "".join(f"{n}{c}" if len(c) == 1 else c * n for c, n in runs)


def _is_run(info: FieldInfo) -> bool:
    """Return whether the field is an array of words, which one struct format can
    unpack.
    """
    is_word = info.at % 8 == 0 and info.bits in _INTEGERS
    return bool(info.elements) and is_word and info.type not in _NO_WORDS


def _bytes_of(info: FieldInfo) -> range:
    """Return the bytes that contain bits of the field."""
    return range(info.at // 8, (info.at + info.bits + 7) // 8)


def _lines(statements: list[str], indent: int) -> str:
    return f"\n{' ' * indent}".join(statements)
