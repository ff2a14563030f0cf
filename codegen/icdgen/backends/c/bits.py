"""Expressions that read a field from the bytes of a frame, and that put it there."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.names import has
from icdgen.backends.c.statement import grouped, joined
from icdgen.backends.c.types import cast, mask
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.layout import Piece

BITS = "{bits}"  # stands for the bits of the field in the expressions made here


class Read(NamedTuple):
    """The bits of a field, as terms to be or-ed together, and how the raw value is made of them."""

    bits: int  # 32 or 64: the type in which they are joined
    terms: tuple[str, ...]
    value: str  # over ``{bits}``

    @property
    def whole(self) -> str:
        """The raw value in one expression."""
        return self.value.format(bits=joined(self.terms))


def read(field: FieldDescription, frame: str = "buffer") -> Read:
    """The raw value of an integer, enum or bool field (the bits of a float) over the bytes that ``frame`` points to."""
    bits = field.model.bits
    if field.is_word:
        return Read(32, (_load(field, frame),), f"icdgen_i{bits}({BITS})" if field.storage.signed else BITS)
    pieces = field.pieces
    if field.model.type == "bool":
        return Read(32, (f"{_byte(pieces[0], frame)} & {mask(pieces[0].mask, 8)}",), f"({BITS}) != 0u")
    wide = 64 if bits > 32 else 32
    if len(pieces) == 1:
        return Read(wide, (_low_bits(pieces[0], frame),), _from_bits(field, wide, joined=False))
    terms = tuple(_shifted(piece, wide, frame) for piece in sorted(pieces, key=lambda p: p.at))
    return Read(wide, terms, _from_bits(field, wide, joined=True))


def _from_bits(field: FieldDescription, wide: int, joined: bool) -> str:
    storage = field.storage
    if not storage.signed:
        return cast(BITS, storage.bits) if joined and storage.bits != wide else BITS
    if not field.is_narrow:
        return f"icdgen_i{storage.bits}({cast(BITS, storage.bits) if storage.bits != wide else BITS})"
    sign = mask(1 << (field.model.bits - 1), min(wide, storage.bits))
    extended = f"icdgen_extend{wide}({BITS}, {sign})"
    return extended if storage.bits == wide else cast(extended, storage.bits, True)


def _load(field: FieldDescription, frame: str) -> str:
    byte, bits = field.model.at // 8, field.model.bits
    return f"{frame}[{byte}]" if bits == 8 else f"icdgen_load_u{bits}{field.order}(&{frame}[{byte}])"


def _byte(piece: Piece, frame: str) -> str:
    return f"{frame}[{piece.byte}]"


def _low_bits(piece: Piece, frame: str) -> str:
    """The run of bits, moved down to bit 0."""
    if piece.shift == 0:
        return _byte(piece, frame) if piece.is_byte else f"{_byte(piece, frame)} & {mask(piece.mask, 8)}"
    return f"({_byte(piece, frame)} >> {piece.shift}) & {mask(piece.low_mask, 8)}"


def _shifted(piece: Piece, wide: int, frame: str) -> str:
    """The run of bits, moved to its place in the value."""
    low = cast(_low_bits(piece, frame), wide)
    return f"{low} << {piece.at}" if piece.at else low


def put(field: FieldDescription, piece: Piece) -> str:
    """What the field contributes to the byte of ``piece``: an `int`; what goes beyond the byte is cut off by the caller."""
    storage, value = field.storage, _raw(field)
    if piece.at:
        value = f"{cast(value, storage.bits) if storage.signed else value} >> {piece.at}"
    if storage.bits > 8 or storage.signed:
        value = cast(value, 8)
    top = piece.at + piece.bits == field.model.bits and not storage.signed
    if not top and not piece.reaches_top:
        value = f"{grouped(value)} & 0x{piece.low_mask:02X}"
    return f"{grouped(value)} << {piece.shift}" if piece.shift else value


def store(field: FieldDescription, frame: str = "buffer") -> str:
    """The statement that stores a field that is a word in the bytes that ``frame`` points to."""
    byte, bits, value = field.model.at // 8, field.model.bits, _raw(field)
    if field.storage.signed or field.storage.bits > bits:
        value = cast(value, bits)
    if bits == 8:
        return f"{frame}[{byte}] = {value};"
    return f"icdgen_store_u{bits}{field.order}(&{frame}[{byte}], {value});"


def _raw(field: FieldDescription) -> str:
    """The raw value, or the bits of a float."""
    member = f"message->{field.member}"
    return f"icdgen_bits_f{field.model.bits}(&{member})" if field.model.type == "float" else member


def excess(field: FieldDescription, member: str) -> str:
    """An expression that is 0 if and only if the raw value of a narrow field, which is in ``member``, fits."""
    storage, one = field.storage, field.model
    wide = 64 if storage.bits == 64 else 32
    if storage.signed:
        beyond = ((1 << wide) - 1) ^ ((1 << one.bits) - 1)
        found = f"({cast(f'message->{member}', wide)} + {mask(1 << (one.bits - 1), wide)}) & {mask(beyond, wide)}"
    else:
        beyond = ((1 << storage.bits) - 1) ^ one.raw_max
        found = f"message->{member} & {mask(beyond, storage.bits)}"
    return f"{has(field)}(message) ? ({found}) : 0u" if one.when else found


def excess_type(message: MessageDescription) -> str:
    """The type that holds what does not fit of any field."""
    return "uint64_t" if message.range_check_bits == 64 else "uint32_t"
