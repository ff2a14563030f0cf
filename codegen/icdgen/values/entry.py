"""Conversion of the text that a user types for a field to the raw value.

`parse_value` accepts a physical value with or without its unit, the name of a member,
the meaning of a special value, or a raw value. Errors are `BadValue`. It does not check
limits: `icdgen.values.encode` does, which calls it for each field of a message.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from icdgen import codec, naming
from icdgen.describe.bounds import bounds_of_limits, range_text
from icdgen.icd.frames import FrameField
from icdgen.icd.model import Enum, Member
from icdgen.icd.places import AnyScalar
from icdgen.values import numbers
from icdgen.values.errors import BadHex, BadValue
from icdgen.values.find import items_by_name
from icdgen.values.hexadecimal import parse_hex

_TRUTH = {"true": 1, "yes": 1, "on": 1, "1": 1, "false": 0, "no": 0, "off": 0, "0": 0}


def members_text(field: AnyScalar) -> str:
    """Return the members of the enumeration of a field, for the end of a message; empty
    without an enumeration.
    """
    if not field.enum:
        return ""
    return "; members: " + ", ".join(
        f"{member.values} {member.name}" for member in field.enum.members
    )


def out_of_range_text(field: AnyScalar, text: str) -> str:
    """Return the message for a physical value that is out of range."""
    return f"takes {range_text(field) or f'{field.raw_min} to {field.raw_max}'}, not {text}"


def parse_raw(field: FrameField, text: str) -> int | bytes:
    """Return the raw value that a text gives directly; the bits of a float are
    ``0x...``.

    Raises `BadValue`. Does not check the range.
    """
    _settable(field)
    if field.is_bytes:
        return _bytes(field, text)
    if field.type == "float":
        return _float(field, text, raw=True)
    if field.type == "bool" and text.lower() in _TRUTH:
        return _TRUTH[text.lower()]
    value = numbers.integer(text)
    if value is None and field.enum:
        return _member(field, field.enum, text)
    if value is None:
        raise BadValue(f"`{text}` is not a whole number")
    return value


def parse_physical(field: FrameField, text: str) -> int | bytes:
    """Return the raw value that is nearest to a physical value.

    Raises `BadValue`. Does not check the range.
    """
    _settable(field)
    return _READERS.get(field.type, _integer)(field, text)


def parse_value(field: FrameField, text: str, raw: bool = False) -> int | bytes:
    """Return the raw value of a physical value, or of a raw value with ``raw``.

    Raises `BadValue`.

    Bytes and text of variable length are not padded.
    """
    has_variable_length = field.scalar.length is not None
    if has_variable_length and (raw or field.type == "bytes"):
        return _bytes(field, text)
    value = (parse_raw if raw else parse_physical)(field, text)
    return (
        # The codec pads texts with NUL, but here the number of bytes sets the counter.
        value[: len(text)]
        if has_variable_length and isinstance(value, bytes)
        else value
    )


def _settable(field: FrameField) -> None:
    """Raise `BadValue` for a derived value or an overlay field, which cannot be set."""
    if field.derived is not None:
        of = ", ".join(f"`{name}`" for name in field.derived.fields)
        raise BadValue(
            f"it is derived from {of or 'numbers'}",
            "set the fields that it is derived from",
        )
    if field.role == "overlay":
        raise BadValue(
            "an overlay field has no bits of its own", "set the fields that have them"
        )


def _bool(field: FrameField, text: str) -> int:
    """Return the raw value of a flag."""
    if text.lower() not in _TRUTH:
        raise BadValue(
            f"`{text}` is neither true nor false (nor yes, no, on, off, 1, 0)"
        )
    return _TRUTH[text.lower()]


def _bytes(field: FrameField, text: str) -> bytes:
    """Return bytes of hexadecimal text; a field of variable length can have fewer than
    the most.
    """
    try:
        value = parse_hex(text)
    except BadHex as error:
        raise BadValue(str(error)) from None
    room, has_variable_length = field.bits // 8, field.scalar.length is not None
    if len(value) > room or (len(value) < room and not has_variable_length):
        wanted = (
            f"up to {room} bytes are taken"
            if has_variable_length
            else f"{room} bytes are needed"
        )
        raise BadValue(f"{wanted}, {len(value)} given")
    return value


def _text(field: FrameField, text: str) -> bytes:
    """Return the bytes of a text field, padded with NUL."""
    try:
        return codec.raw_from_text(field, text)
    except codec.CodecError:
        raise BadValue(
            f"`{text}` is not of up to {field.bits // 8} ASCII characters"
        ) from None


def _special(field: FrameField, text: str) -> int | None:
    """Return the special value with this meaning (in any case) or None."""
    meaning = text.casefold()
    return next(
        (
            special.value
            for special in field.special
            if special.meaning.casefold() == meaning
        ),
        None,
    )


def _float(field: FrameField, text: str, raw: bool = False) -> int:
    """Return the bits of a float field."""
    # Hexadecimal digits are the bits of a float, which would be confused with a
    # physical value.
    if text[:2] in ("0x", "0X"):
        value = numbers.integer(text)
        if raw and value is not None:
            return value
        raise BadValue(
            f"`{text}` is not a number; the bits of a float can be given with --raw"
        )
    if not raw and (special := _special(field, text)) is not None:
        return special
    if field.curve is not None and not raw:
        return _on_curve(field, text)
    try:
        value = numbers.float_bits(without_unit(field, text), field.bits)
    except OverflowError:
        # If the limits exclude the value, too, they explain more than the width of the
        # float.
        if not raw and not all(
            bound.holds(_exact(field, text)) for bound in bounds_of_limits(field.limits)
        ):
            raise BadValue(out_of_range_text(field, text)) from None
        raise BadValue(
            f"{text} is beyond what a {field.bits}-bit float can represent"
        ) from None
    if value is None:
        raise BadValue(f"`{text}` is not a number")
    return value


def _integer(field: FrameField, text: str) -> int:
    """Return the raw value of an integer field."""
    if (special := _special(field, text)) is not None:
        return special
    if field.curve is not None:
        return _on_curve(field, text)
    if (
        field.scale is None
        and (value := numbers.integer(without_unit(field, text))) is not None
    ):
        return value
    exact = _exact(field, text)
    if field.scale:
        # Ties to even, as `codec.raw_from_physical`.
        return round(field.scale.raw(exact))
    if exact.denominator != 1:
        raise BadValue(f"{text} is not a whole number")
    return exact.numerator


def _on_curve(field: FrameField, text: str) -> int:
    """Return the raw value of a field with a polynomial or a lookup table."""
    try:
        return codec.raw_from_physical(field, _exact(field, text))
    except codec.CodecError as error:
        if field.is_invertible and range_text(field):
            raise BadValue(out_of_range_text(field, text)) from None
        help = "" if field.is_invertible else "--raw takes the raw value"
        raise BadValue(str(error).removeprefix(f"{field.name!r} "), help) from None


def _exact(field: FrameField, text: str) -> Fraction:
    """Return the exact number of a text, with or without the unit of the field."""
    exact = numbers.rational(without_unit(field, text))
    if exact is None:
        raise BadValue(
            f"`{text}` is not a number"
            + (f" (in {field.unit.symbol})" if field.unit else "")
        )
    return exact


def without_unit(field: AnyScalar, text: str) -> str:
    """Return ``12.5 deg`` or ``12.5deg`` without the unit of the field."""
    symbol = field.unit_symbol
    if not symbol or not text.endswith(symbol):
        return text
    # The symbol can also be the end of a word, such as `m` in `Alarm`.
    number = text[: -len(symbol)].rstrip()
    return number if number[-1:].isdigit() else text


def _enum(field: FrameField, text: str) -> int:
    """Return the raw value of an enumeration field."""
    return (
        _integer(field, text)
        if field.enum is None
        else _member(field, field.enum, text)
    )


def _member(field: FrameField, enum: Enum, text: str) -> int:
    """Return the value of a member, by name, by words that only one member has, or by
    number.
    """
    number = numbers.integer(text)
    matches = {
        member.values: member.value for member in items_by_name(enum.members, text, ())
    }
    if not matches and number is None:
        matches = {
            member.values: member.value
            for member in enum.members
            if _has_words(member, text)
        }
    # A member can be called like the number of another one, which is ambiguous.
    if number is not None:
        matches[str(number)] = number
    if len(matches) == 1:
        ((values, value),) = matches.items()
        if values == str(value):
            return value
        problem = f"is {values}: give the number"
    else:
        problem = "fits several members" if matches else f"is no member of {enum.name}"
    raise BadValue(f"`{text}` {problem}{members_text(field)}")


def _has_words(member: Member, text: str) -> bool:
    """Return whether the name of a member has all words of a text."""
    wanted = naming.words(text)
    return bool(wanted) and set(wanted) <= set(naming.words(member.name))


_READERS: dict[str, Callable[[FrameField, str], int | bytes]] = {
    "bool": _bool, "bytes": _bytes, "text": _text, "float": _float, "enum": _enum
}  # fmt: skip
