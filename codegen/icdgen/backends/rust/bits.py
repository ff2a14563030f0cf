"""Expressions and statements that read and write fields.

`read_expression` returns the value of a field over ``bytes``, `write_field` the
statements that write it, `check_range` those that return an error for a raw value that
does not fit. Lints of rustc and clippy (pedantic) explain most of the forms.
"""

from __future__ import annotations

from icdgen.backends.lines import STEP, bracketed
from icdgen.backends.rust.names import (
    field_name,
    own_name,
    reader,
    scale_name,
    writer,
)
from icdgen.backends.rust.text import WIDTH, mask
from icdgen.backends.rust.types import integer_type, struct_path
from icdgen.describe import FieldDescription, StructDescription
from icdgen.describe.arrays import loop_of
from icdgen.describe.storage import storage_bits
from icdgen.icd.pieces import Piece

_ARRAY_WIDTH = 60
"""Width up to which rustfmt leaves an array on one line."""
RAW = "raw"
"""Variable with the value of an optional field."""
FLAGS_FROM = 4
"""Number of flags of a byte from which on code reads them from the table of the support
module.
"""


def read_expression(
    field: FieldDescription, tables: set[int], depth: int = 3, within: str = ""
) -> str:
    """Return the expression of the raw value, over ``bytes``, in a line with an
    indentation of ``depth`` steps.

    ``tables`` are the bytes with variables ``flags_N``. ``within`` is the prefix of
    functions for elements.
    """
    helper = _loop_helper(field)
    if helper:
        return _called(field, helper, within, depth)
    if field.struct is not None:
        return _struct_expression(field, field.struct, tables, depth, within)
    if field.model.is_count:
        # A count has no bits in the frame. The template sets it from the length of the
        # frame after it has read the fields.
        return "0"
    if field.count:
        return (
            _word_array(field, depth)
            if field.is_copied
            else _element_list(field, tables, depth)
        )
    place, row = field.model, field.pieces
    if place.is_bytes:
        return f"array(bytes, {place.at // 8})"
    if place.type == "bool":
        byte, shift = row[0].byte, row[0].shift
        return (
            # `&` binds tighter than `!=` in Rust, unlike in C, so the test of a bit
            # needs no parentheses.
            f"flags_{byte}[{shift}]"
            if byte in tables
            else f"bytes[{byte}] & {mask(1 << shift)} != 0"
        )
    size = storage_bits(place.bits)
    if field.is_word:
        return _whole_word(field, size)
    if len(row) == 1:
        return _from_unsigned(field, _one_byte(row[0]), size)
    lines = [f"let mut value = {_placed(row[0], size)};"]
    lines += [f"value |= {_placed(piece, size)};" for piece in row[1:]]
    lines.append(_from_unsigned(field, "value", size))
    body = "".join(f"\n{STEP * (depth + 1)}{line}" for line in lines)
    return f"{{{body}\n{STEP * depth}}}"


def _loop_helper(field: FieldDescription) -> str:
    """Return the helper of the support module that calls a function for each element or
    iteration of an array; empty without such a function.
    """
    loop = loop_of(field)
    if loop is None:
        return ""
    return "rounds" if loop.per_iteration > 1 else "each"


def _called(field: FieldDescription, helper: str, within: str, depth: int) -> str:
    # The call follows the name of its field on the line. The name counts for the width,
    # but the caller writes it.
    target = f"{own_name(field)}: "
    arguments = (
        "bytes",
        str(field.model.at // 8),
        f"Self::{reader(within + field.name)}",
    )
    return bracketed(
        f"{target}{helper}(", arguments, ")", WIDTH - 1, STEP * depth
    ).removeprefix(target)


def _struct_expression(
    field: FieldDescription,
    struct: StructDescription,
    tables: set[int],
    depth: int,
    within: str,
) -> str:
    pad, (row,) = STEP * depth, field.instances
    lines = (
        f"{pad}{STEP}{own_name(member)}: {read_expression(member, tables, depth + 1, within)},\n"
        for member in row
    )
    return (
        f"{struct_path(struct, field.message.using_node)} {{\n{''.join(lines)}{pad}}}"
    )


def _word_array(field: FieldDescription, depth: int) -> str:
    """Return the expression of an array of words."""
    place, first = field.model, field.model.at // 8
    if place.is_bytes:
        return f"arrays(bytes, {first})"
    if place.type == "uint" and place.bits == 8:
        return f"array(bytes, {first})"
    word = f"{_word_type(field)}::from_{field.order}_bytes"
    if place.type != "enum":
        return f"words(bytes, {first}, {word})"
    value = f"Coded::from_raw({word}(word))"
    line = f"words(bytes, {first}, |word| {value})"
    if len(f"{STEP * depth}{own_name(field)}: {line},") <= WIDTH:
        return line
    return f"words(bytes, {first}, |word| {{\n{STEP * (depth + 1)}{value}\n{STEP * depth}}})"


def _element_list(field: FieldDescription, tables: set[int], depth: int) -> str:
    """Return the expression of an array whose elements are read one by one."""
    values = [read_expression(element, tables, depth + 1) for element in field.elements]
    line = f"[{', '.join(values)}]"
    if len(line) <= _ARRAY_WIDTH and "\n" not in line:
        return line
    rows = "".join(f"\n{STEP * (depth + 1)}{value}," for value in values)
    return f"[{rows}\n{STEP * depth}]"


def _whole_word(field: FieldDescription, size: int) -> str:
    first = field.model.at // 8
    if size > 8:
        # `take!` is a macro and no function, so that every index is a constant at any
        # level of optimisation.
        value = f"{_word_type(field)}::from_{field.order}_bytes(take!(bytes[{first}; {size // 8}]))"
    else:
        value = (
            f"i8::from_le_bytes([bytes[{first}]])"
            if field.model.is_signed
            else f"bytes[{first}]"
        )
    return _as_field_type(field, value, size)


def _word_type(field: FieldDescription) -> str:
    """Return the type of a word: ``u16``, ``f32``."""
    if field.model.type == "float":
        return f"f{field.model.bits}"
    return f"{'i' if field.model.is_signed else 'u'}{field.model.bits}"


def _as_field_type(field: FieldDescription, value: str, size: int) -> str:
    """Return an integer of ``size`` bits as the type of the field."""
    if field.model.type != "enum":
        return value
    wider = (
        value if size == field.storage.bits else f"{integer_type(field)}::from({value})"
    )
    return f"Coded::from_raw({wider})"


def _from_unsigned(field: FieldDescription, value: str, size: int) -> str:
    """Return an unsigned integer of ``size`` bits as the type of the field."""
    if field.model.type == "float":
        return f"f{size}::from_bits({value})"
    return _as_field_type(
        field,
        _sign_extended(field, value, size) if field.model.is_signed else value,
        size,
    )


def _sign_extended(field: FieldDescription, value: str, size: int) -> str:
    """Return an unsigned integer of ``size`` bits as a signed one, with the sign of the
    field extended.
    """
    # Shifting the sign bit to the top and back extends it: `>>` of a signed integer is
    # arithmetic in Rust.
    unused = size - field.model.bits
    if size == 8:
        shifted = value if not unused else f"{_parenthesised(value)} << {unused}"
        # The conversion to a signed type goes through bytes, because clippy
        # (`cast_possible_wrap`, pedantic) refuses `as`. Bits that `<<` moves out are no
        # overflow in Rust, which checks only the distance of a shift.
        signed = f"i8::from_le_bytes([{shifted}])"
    else:
        shifted = value if not unused else f"({value} << {unused})"
        signed = f"i{size}::from_le_bytes({shifted}.to_le_bytes())"
    return f"{signed} >> {unused}" if unused else signed


def _one_byte(piece: Piece) -> str:
    byte = f"bytes[{piece.byte}]"
    if piece.shift == 0:
        return byte if piece.is_byte else f"{byte} & {mask(piece.mask)}"
    if piece.reaches_top:
        # `>>` of a `u8` fills with zeros, so a run at the top of its byte needs no
        # mask.
        return f"{byte} >> {piece.shift}"
    return f"({byte} >> {piece.shift}) & {mask(piece.low_mask)}"


def _parenthesised(text: str) -> str:
    return f"({text})" if " " in text else text


def _placed(piece: Piece, size: int) -> str:
    """Return a run of bits at its place in a value of ``size`` bits."""
    value = _one_byte(piece) if size == 8 else f"u{size}::from({_one_byte(piece)})"
    return (
        f"{_parenthesised(value) if size == 8 else value} << {piece.at}"
        if piece.at
        else value
    )


def check_range(field: FieldDescription) -> list[str]:
    """Return the statements that return an error if the raw value does not fit the
    field.
    """
    member = f"self.{field_name(field)}"
    if field.struct is not None and not field.count:
        return [f"{member}.fit()?;"]
    if field.struct is not None:
        return [
            f"for part in {f'{member}()' if field.is_in_last_part else f'&{member}'} {{",
            f"{STEP}part.fit()?;",
            "}",
        ]
    raw = ".raw()" if field.enum is not None else ""
    if not field.count:
        return [f"{scale_name(field)}.fit({_source_expression(field)}{raw})?;"]
    values = f"{member}().iter().copied()" if field.is_in_last_part else member
    return [
        f"for value in {values} {{",
        f"{STEP}{scale_name(field)}.fit(value{raw})?;",
        "}",
    ]


def _source_expression(field: FieldDescription, owner: str = "self") -> str:
    """Return the expression to write: the member, or the variable with the value of an
    optional field.
    """
    if field.model.conditions:
        return RAW
    name = field_name(field)
    return f"{owner}.{name}" if owner else name


def write_field(
    field: FieldDescription, owner: str = "self", within: str = ""
) -> list[str]:
    """Return the statements that write the raw value into ``bytes``, without bits that
    do not fit the field.
    """
    if field.model.is_count:
        return []
    helper = _loop_helper(field)
    if helper:
        values = f"&{owner}.{field_name(field)}"
        function = f"Self::{writer(within + field.name)}"
        arguments = ("&mut bytes", str(field.model.at // 8), values, function)
        return [bracketed(f"put_{helper}(", arguments, ");", WIDTH, STEP * 2)]
    if field.count:
        if field.is_copied:
            return _put_run(field, f"{owner}.{field_name(field)}")
        return [
            line for element in field.elements for line in write_field(element, owner)
        ]
    place, row, source = field.model, field.pieces, _source_expression(field, owner)
    if place.is_bytes:
        return [f"put_array(&mut bytes, {place.at // 8}, &{source});"]
    if place.type == "bool":
        # The array of bytes starts with zeros, so `|=` writes flags of both values and
        # keeps other fields in the byte.
        shift = f" << {row[0].shift}" if row[0].shift else ""
        return [f"bytes[{row[0].byte}] |= u8::from({source}){shift};"]
    if field.is_plain_word:
        return _put_whole(field, source)
    lines, size = [], field.storage.bits
    if place.type == "enum":
        source = f"{source}.raw()"
    elif place.type == "float":
        source = f"{source}.to_bits()"
    if len(row) > 1:
        # A later field of the function can declare `value` as well: in Rust a `let`
        # shadows the earlier variable.
        lines.append(f"let value = {source};")
        source = "value"
    if place.is_signed:
        lines.append(f"let value = u{size}::from_le_bytes({source}.to_le_bytes());")
        source = "value"
    return lines + _put_pieces(row, source, size)


def _put_run(field: FieldDescription, source: str) -> list[str]:
    """Return the statement that writes an array of words."""
    place, first = field.model, field.model.at // 8
    if place.type == "uint" and place.bits == 8:
        return [f"put_array(&mut bytes, {first}, &{source});"]
    to_bytes = f"to_{field.order}_bytes"
    word = (
        f"|value| value.raw().{to_bytes}()"
        if place.type == "enum"
        else f"{_word_type(field)}::{to_bytes}"
    )
    word = "|octets| octets" if place.is_bytes else word
    return [
        bracketed(
            "put_words(",
            ("&mut bytes", str(first), f"&{source}", word),
            ");",
            WIDTH,
            STEP * 2,
        )
    ]


def _put_whole(field: FieldDescription, source: str) -> list[str]:
    first = field.model.at // 8
    size = field.storage.bits
    is_enum = field.model.type == "enum"
    if size == 8 and not field.model.is_signed:
        return [f"bytes[{first}] = {source}{'.raw()' if is_enum else ''};"]
    # A byte in memory has no order, but an `i8` needs a conversion, so it takes this
    # way, too.
    copied = f"put!({'value' if is_enum else source}.to_{field.order}_bytes() => bytes[{first}; {size // 8}]);"
    return [f"let value = {source}.raw();", copied] if is_enum else [copied]


def _put_pieces(row: tuple[Piece, ...], source: str, size: int) -> list[str]:
    # If all runs start at whole bytes of the value, its bytes in memory are the parts,
    # without shifts.
    if size > 8 and all(piece.at % 8 == 0 for piece in row):
        return [
            f"let value = {source}.to_le_bytes();",
            *(_put_piece(piece, f"value[{piece.at // 8}]") for piece in row),
        ]
    lines = []
    for piece in row:
        part = f"{source} >> {piece.at}" if piece.at else source
        if size > 8:
            # This is the low byte without `as u8`, which clippy
            # (`cast_possible_truncation`, pedantic) refuses.
            part = f"{_parenthesised(part)}.to_le_bytes()[0]"
        lines.append(_put_piece(piece, part))
    return lines


def _put_piece(piece: Piece, part: str) -> str:
    """Return the statement that writes the low bits of ``part`` into their byte."""
    if piece.is_byte:
        return f"bytes[{piece.byte}] = {part};"
    if not piece.reaches_top:
        # A shift to the top of the byte drops the higher bits of a `u8`. Anywhere else
        # they would change a neighbouring field.
        part = f"{_parenthesised(part)} & {mask(piece.low_mask)}"
    if piece.shift:
        part = f"{_parenthesised(part)} << {piece.shift}"
    return f"bytes[{piece.byte}] |= {part};"
