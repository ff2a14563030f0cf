"""Expressions that read a field from the bytes of a frame, and that write it there.

A field is a word at a byte, or runs of bits in several bytes (`Piece`). `read_field`
returns terms to combine by ``|``; `field_term` returns the term of a field in one byte.
`decoding` and `encoding` make statements of them.
"""

from __future__ import annotations

from icdgen.backends.c.names import has
from icdgen.backends.c.statement import grouped, joined
from icdgen.backends.c.types import cast, mask
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.pieces import Piece

BITS = "{bits}"
"""Placeholder of the bits of the field in expressions."""


class ReadExpression(NamedTuple):
    """Expression that reads a field: terms to combine by ``|``, and the raw value over
    the result.
    """

    bits: int  # 32 or 64: width in which the terms are combined
    terms: tuple[str, ...]
    value: str  # expression over ``{bits}``

    @property
    def whole(self) -> str:
        """Raw value in one expression."""
        return self.value.format(bits=joined(self.terms))


def read_field(field: FieldDescription, frame: str = "buffer") -> ReadExpression:
    """Return the expression of the raw value, for a float its bits, over the bytes at
    ``frame``.
    """
    bits = field.model.bits
    if field.is_word:
        return ReadExpression(
            32,
            (_load_word(field, frame),),
            f"icdgen_i{bits}({BITS})" if field.storage.signed else BITS,
        )
    pieces = field.pieces
    if field.model.type == "bool":
        return ReadExpression(
            32,
            (f"{_byte_of_piece(pieces[0], frame)} & {mask(pieces[0].mask, 8)}",),
            f"({BITS}) != 0u",
        )
    wide = 64 if bits > 32 else 32
    if len(pieces) == 1:
        return ReadExpression(
            wide, (_low_bits(pieces[0], frame),), _from_bits(field, wide, joined=False)
        )
    terms = tuple(
        _shifted(piece, wide, frame) for piece in sorted(pieces, key=lambda p: p.at)
    )
    return ReadExpression(wide, terms, _from_bits(field, wide, joined=True))


def _from_bits(field: FieldDescription, wide: int, joined: bool) -> str:
    storage = field.storage
    # Converting an unsigned value beyond INT_MAX to a signed type is
    # implementation-defined (C99, 6.3.1.3), so functions of the support header do it.
    if not storage.signed:
        return cast(BITS, storage.bits) if joined and storage.bits != wide else BITS
    if not field.is_narrow:
        return f"icdgen_i{storage.bits}({cast(BITS, storage.bits) if storage.bits != wide else BITS})"
    sign = mask(1 << (field.model.bits - 1), min(wide, storage.bits))
    extended = f"icdgen_extend{wide}({BITS}, {sign})"
    return extended if storage.bits == wide else cast(extended, storage.bits, True)


def _load_word(field: FieldDescription, frame: str) -> str:
    byte, bits = field.model.at // 8, field.model.bits
    return (
        f"{frame}[{byte}]"
        if bits == 8
        else f"icdgen_load_u{bits}{field.order}(&{frame}[{byte}])"
    )


def _byte_of_piece(piece: Piece, frame: str) -> str:
    return f"{frame}[{piece.byte}]"


def _low_bits(piece: Piece, frame: str) -> str:
    """Return a run of bits, shifted down to bit 0."""
    if piece.shift == 0:
        return (
            _byte_of_piece(piece, frame)
            if piece.is_byte
            else f"{_byte_of_piece(piece, frame)} & {mask(piece.mask, 8)}"
        )
    return (
        f"({_byte_of_piece(piece, frame)} >> {piece.shift}) & {mask(piece.low_mask, 8)}"
    )


def _shifted(piece: Piece, wide: int, frame: str) -> str:
    """Return a run of bits, shifted to its place in the value."""
    # The byte is widened before the shift: it is promoted to `int`, and a shift into or
    # beyond the sign bit is undefined (C99, 6.5.7).
    low = cast(_low_bits(piece, frame), wide)
    return f"{low} << {piece.at}" if piece.at else low


def field_term(field: FieldDescription, piece: Piece) -> str:
    """Return the term of a field for the byte of ``piece``, an `int`.

    The caller removes bits beyond the byte.
    """
    storage, value = field.storage, _raw_value(field)
    if piece.at:
        # `>>` of a negative value is implementation-defined (C99, 6.5.7).
        value = (
            f"{cast(value, storage.bits) if storage.signed else value} >> {piece.at}"
        )
    if storage.bits > 8 or storage.signed:
        # A `uint8_t` is promoted to `int`, so all terms of a byte have the same type.
        value = cast(value, 8)
    # Above the top bits of an unsigned value there are only zeros: encode has tested
    # that it fits.
    top = piece.at + piece.bits == field.model.bits and not storage.signed
    if not top and not piece.reaches_top:
        value = f"{grouped(value)} & 0x{piece.low_mask:02X}"
    return f"{grouped(value)} << {piece.shift}" if piece.shift else value


def store_word(field: FieldDescription, frame: str = "buffer") -> str:
    """Return the statement that stores a word in the bytes at ``frame``."""
    byte, bits, value = field.model.at // 8, field.model.bits, _raw_value(field)
    if field.storage.signed or field.storage.bits > bits:
        value = cast(value, bits)
    if bits == 8:
        return f"{frame}[{byte}] = {value};"
    return f"icdgen_store_u{bits}{field.order}(&{frame}[{byte}], {value});"


def _raw_value(field: FieldDescription) -> str:
    """Return the raw value; for a float its bits."""
    member = f"message->{field.member}"
    return (
        f"icdgen_bits_f{field.model.bits}(&{member})"
        if field.model.type == "float"
        else member
    )


def bits_beyond_field(field: FieldDescription, member: str) -> str:
    """Return an expression that is 0 if and only if the raw value in ``member`` fits
    its field.
    """
    storage, place = field.storage, field.model
    wide = 64 if storage.bits == 64 else 32
    if storage.signed:
        # The sum maps the valid values to 0 .. 2**bits - 1, so that one mask tests both
        # ends.
        beyond = ((1 << wide) - 1) ^ ((1 << place.bits) - 1)
        excess_bits = f"({cast(f'message->{member}', wide)} + {mask(1 << (place.bits - 1), wide)}) & {mask(beyond, wide)}"
    else:
        # `raw_max` of an unsigned field is all ones, so its complement has the bits
        # that must be 0.
        beyond = ((1 << storage.bits) - 1) ^ place.raw_max
        excess_bits = f"message->{member} & {mask(beyond, storage.bits)}"
    return (
        f"{has(field.message, field.name)}(message) ? ({excess_bits}) : 0u"
        if place.conditions
        else excess_bits
    )


def excess_type(message: MessageDescription) -> str:
    """Return the type for the bits that do not fit, of any field."""
    return "uint64_t" if message.range_check_bits == 64 else "uint32_t"
