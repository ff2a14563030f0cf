"""Values of a field: enumeration members, constants and special values must be in its
range.

The rules take the keys `enum`, `const` and `special` of fields (ICD030 to ICD032). They
compare raw values with the range that type and width give. ICD035 reports ranges with
fewer than two values, ICD036 a `display` that does not suit the type. `limits` has the
rules of physical values.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import floats
from icdgen.icd.display import OF_BITS
from icdgen.icd.enumeration import Member
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Derived, LayoutNode, Scalar
from icdgen.icd.meanings import float_bits
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings
from icdgen.wording import count, quote

NUMBERS = ("uint", "int", "enum")


@rule("ICD030")
def members_fit_their_fields(ctx: Context) -> Iterator[Fault]:
    # Large enumerations are used by many fields: compare the member that needs the most
    # bits, and look at the others only if it does not fit.
    widest = {id(enum): enum.widest for enum in ctx.enums}
    for field, _ in ctx.fields_with["enum"]:
        top = widest.get(id(field.enum)) if field.enum else None
        if field.enum and top is not None and not _can_represent(field, top):
            misfits = sum(
                not _can_represent(field, member) for member in field.enum.members
            )
            also = ""
            if misfits == 2:
                also = " (nor does another)"
            elif misfits > 2:
                also = f" (nor do {misfits - 1} others)"
            member = f"{quote(top.name)} = {top.values} of the enumeration {quote(field.enum.name)}"
            text = f"{member} does not fit the {count(field.bits, 'bit')} of the field {quote(field.name)}{also}"
            help = f"it takes {count(max(map(field.enum.bits_for, (top.value, top.last))), 'bit')}"
            help += (
                ", because the enumeration also has negative values"
                if field.is_signed and top.value >= 0
                else ""
            )
            yield Fault.at(field.source, "bits", text, help)


def _can_represent(field: Scalar, member: Member) -> bool:
    """Return whether all values of a member are in the range of a field."""
    return field.raw_min <= member.value and member.last <= field.raw_max


@rule("ICD035")
def ranges_have_several_values(ctx: Context) -> Iterator[Fault]:
    for enum in ctx.enums:
        for member in enum.members:
            if member.to is None or member.to > member.value:
                continue
            what = (
                "is not a range"
                if member.to == member.value
                else "ends before it begins"
            )
            message = f"{quote(member.name)}, {member.values}, {what}"
            help = (
                "leave `to` out"
                if member.to == member.value
                else f"`value: {member.to}, to: {member.value}`?"
            )
            yield Fault.at(member.source, "to", message, help)


@rule("ICD031")
def constants_fit(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["const"]:
        problem = _misfit(field, field.const)
        if problem:
            yield Fault.at(field.source, "const", f"`const` {problem[0]}", problem[1])


@rule("ICD032")
def special_values_fit(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["special"]:
        seen = set()
        for item in mappings(field.source["special"]):
            given = item.get("value")
            if not isinstance(given, (int, float, str)) or isinstance(given, bool):
                continue
            problem = _not_special(field, given)
            # Two different numbers can be the same 32-bit float.
            value = (
                given
                if problem or field.type != "float"
                else float_bits(given, field.bits)
            )
            if problem:
                yield Fault(
                    field.source,
                    item.at("value"),
                    f"the special value {problem[0]}",
                    problem[1],
                )
            elif value is not None and value in seen:
                message = f"{given} has two entries in {quote(field.name)}"
                yield Fault(
                    field.source, item.at("value"), message, "join the two entries"
                )
            seen.add(value)


def _not_special(field: Scalar, given: int | float | str) -> tuple[str, str] | None:
    """Return message and help if a value cannot be a special value of a field; None if
    it can.
    """
    if field.type == "float":
        if isinstance(given, str) and given not in floats.NAMED:
            return f"{quote(given)} is not a number", "write a number, nan, inf or -inf"
        if field.bits in floats.WIDTHS and float_bits(given, field.bits) is None:
            return (
                f"{given} does not fit {quote(field.name)}",
                f"it is beyond what a {field.bits}-bit float holds",
            )
        return None
    if field.type not in NUMBERS:
        what = f"of {quote(field.name)} has no meaning for type `{field.type}`"
        return what, "only uint, int, enum and float fields have it"
    if isinstance(given, int):
        return _misfit(field, given)
    return (
        f"{quote(given)} of {quote(field.name)} is not an integer",
        f"`{field.type}` has whole raw values",
    )


def _misfit(field: Scalar, value: int | None) -> tuple[str, str] | None:
    """Return message and help if a raw value is out of range for a field; None if it is
    in range.
    """
    if field.type not in NUMBERS:
        what = f"of {quote(field.name)} has no meaning for type `{field.type}`"
        return what, "only uint, int and enum fields have it"
    if value is None or field.raw_min <= value <= field.raw_max:
        return None
    # Integers of YAML have no limit, and nobody reads a number of hundreds of digits.
    shown = str(value) if abs(value) < 1 << 64 else f"of {value.bit_length()} bits"
    what = f"{shown} does not fit {quote(field.name)}"
    limits = f"{count(field.bits, 'bit')} of `{field.type}` hold {field.raw_min} to {field.raw_max}"
    return what, limits + (
        ", because the enumeration has negative values"
        if field.enum and field.is_signed
        else ""
    )


@rule("ICD036")
def display_suits(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields_with["display"]:
        format_, name = field.display, quote(field.name)
        if format_ is None:
            continue
        has_bits = field.type in ("uint", "enum") and not field.is_signed
        is_scaled = field.type in (
            "uint",
            "int",
        ) and not field.source.keys().isdisjoint(("formula", "points"))
        if format_.kind in OF_BITS and is_scaled:
            message = f"{name} has a scale, so that its value is a physical one, which `{format_.kind}` does not display"
            yield Fault.at(
                field.source, "display", message, "use `{decimals: N}` or `{digits: N}`"
            )
        elif format_.kind in OF_BITS and not has_bits:
            message = f"{name} is {_in_words(field, line.node)}, which `{format_.kind}` does not display"
            help = {
                "float": "use `{decimals: N}` or `{digits: N}`",
                "int": "use `type: uint` for a bit pattern, or remove `display`",
            }.get(field.type, "remove `display`")
            yield Fault.at(field.source, "display", message, help)
        elif format_.kind not in OF_BITS and field.type != "float" and not is_scaled:
            without = " without a scale" if field.type in ("uint", "int") else ""
            message = f"{name} is {_in_words(field, line.node)}{without}: its value has no {format_.kind}"
            help = (
                "remove `display`, or use `hex` or `binary`"
                if has_bits
                else "remove `display`"
            )
            yield Fault.at(field.source, "display", message, help)


def _in_words(field: Scalar, node: LayoutNode) -> str:
    """Return the type of a field in words: ``a float``, ``an enumeration with negative
    values``.
    """
    if isinstance(node, Derived):
        return "a derived value"
    if field.type == "enum":
        return (
            "an enumeration with negative values"
            if field.is_signed
            else "an enumeration"
        )
    words = {
        "uint": "an unsigned integer",
        "int": "a signed integer",
        "bool": "a flag",
        "float": "a float",
    }
    return words.get(field.type, f"`{field.type}`")
