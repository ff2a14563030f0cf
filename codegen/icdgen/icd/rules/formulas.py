"""Formulas, lookup tables and units: whether they are valid, can be computed in all
languages, and can be inverted for telecommands.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import curve, exact, formula
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Scalar, struct_layout_of
from icdgen.icd.layout_nodes import walk
from icdgen.icd.lines import lines
from icdgen.icd.located import Map
from icdgen.icd.model import Message, Node
from icdgen.icd.rules.context import Context, is_overlay
from icdgen.icd.rules.rule import rule
from icdgen.wording import count, quote

SCALED = ("uint", "int", "float")
_POINTS = "a table goes from one raw value to the next: `points: [[0, -40], [512, 20.5], [1023, 125]]`"
_BEYOND = (
    "add `outside: clamp` (the value of the last point), `outside: extrapolate` (the last line goes on) "
    "or `outside: refuse` (there is no number)"
)
_ONLY_RAW = "nothing to do if setting the raw value is enough; else correct the formula or the points"


@rule("ICD060")
def formulas_are_valid(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["formula"]:
        if (
            not field.has_formula
            and field.type in SCALED
            and "points" not in field.source
        ):
            text = field.source["formula"]
            try:
                curve.parse(text)
            except formula.FormulaError as error:
                message = f"the formula {quote(text)} cannot be used: {error}"
                help = "a formula is a line or a polynomial: `raw*0.01`, `raw/10 - 40`, `raw = value*1000`, `3e-6*raw^2 + raw*2^-9`"
                yield Fault.at(field.source, "formula", message, help)


@rule("ICD061")
def only_numbers_have_formulas(ctx: Context) -> Iterator[Fault]:
    for key, what in (("formula", "formula"), ("points", "lookup table")):
        for field, _ in ctx.fields_with[key]:
            if field.type not in SCALED:
                message = (
                    f"{quote(field.name)} is `{field.type}`, which takes no {what}"
                )
                yield Fault.at(
                    field.source,
                    key,
                    message,
                    "only numbers have one: uint, int and float",
                )


@rule("ICD067")
def points_form_a_table(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["points"]:
        source = field.source
        if "formula" in source:
            message = f"{quote(field.name)} has a formula and a lookup table"
            yield Fault.at(source, "points", message, "remove one of them")
        elif field.type in SCALED and field.curve is None:
            try:
                curve.table(curve.doubles(source["points"]), "")
            except formula.FormulaError as error:
                message = f"the points of {quote(field.name)} cannot be used: {error}"
                yield Fault.at(source, "points", message, _POINTS)


@rule("ICD068")
def tables_declare_outside(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["points"]:
        table, source = field.curve, field.source
        if table is None or not table.points or "outside" in source:
            continue
        if field.type == "float" or not table.covers(field.raw_min, field.raw_max):
            ends = (
                "any number"
                if field.type == "float"
                else f"{field.raw_min:,} to {field.raw_max:,}"
            )
            extent = " to ".join(
                f"{raw:g}" for raw in (table.points[0][0], table.points[-1][0])
            )
            message = f"raw values of {quote(field.name)} are {ends}, its points go from {extent}, and `outside` is missing"
            yield Fault.at(source, "points", message, _BEYOND)
    for field, _ in ctx.fields_with["outside"]:
        if "points" not in field.source:
            message = f"{quote(field.name)} has `outside` and no points"
            yield Fault.at(
                field.source, "outside", message, "add `points`, or remove it"
            )


@rule("ICD069", severity="warning")
def raw_values_reach_the_table(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["points"]:
        table, source = field.curve, field.source
        if (
            table is None
            or table.outside not in (curve.CLAMP, curve.REFUSE)
            or field.type == "float"
        ):
            continue
        first, last = table.points[0][0], table.points[-1][0]
        # No raw value lies between two points. Usually the table is for another width
        # or sign.
        if last < field.raw_min or field.raw_max < first:
            what = (
                "the same physical value"
                if table.outside == curve.CLAMP
                else "no physical value"
            )
            values = f"its raw values from {field.raw_min:,} to {field.raw_max:,}"
            message = f"the points of {quote(field.name)} go from {first:g} to {last:g}, {values}: each of them has {what}"
            yield Fault.at(
                source, "points", message, "correct the points, or `bits` or `type`"
            )


@rule("ICD062")
def formulas_have_the_stated_direction(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["formula_for"]:
        source, stated = field.source, field.source["formula_for"]
        if "formula" not in source or "points" in source:
            message = f"{quote(field.name)} has `formula_for` and no formula"
            help = "add `formula` or remove it"
        elif stated != (gives := _gives(field)):
            expected = f"should give the {stated} value according to the manual"
            message = f"the formula of {quote(field.name)} {expected}, but gives the {gives} one"
            help = "decide in an erratum: `held` has `formula_for: null` if the formula is right, else the right formula"
        else:
            message = f"the formula of {quote(field.name)} gives the {stated} value, as the manual says, so the key is not needed"
            help = "remove `formula_for`"
        yield Fault.at(source, "formula_for", message, help)
    for node in ctx.icd.nodes:
        for_kinds = node.source.get("formula_for")
        if isinstance(for_kinds, Map):
            yield from _stated(for_kinds, node)


def _stated(stated: Map, node: Node) -> Iterator[Fault]:
    """Yield the faults of `formula_for` of the ICD, which applies to all messages of a
    kind.
    """
    # A field with `formula_for` of its own has its own finding.
    for kind, stated_for in stated.items():
        contrary = []
        for each in node.messages:
            for field in lines(each.layout) if each.kind == kind else ():
                source = field.scalar.source
                is_affected = "formula" in source and "formula_for" not in source
                if is_affected and _gives(field.scalar) != stated_for:
                    contrary.append(field)
        if contrary:
            fields = count(len(contrary), "field")
            other = f"that of {quote(contrary[0].name)} gives the other one, as in {fields} altogether"
            message = f"the formulas of {kind} messages should give the {stated_for} value according to the manual, but {other}"
            help = f"decide in an erratum: `held` has `{kind}: null` if the formulas are right"
        else:
            message = f"no formula of a {kind} message gives anything but the {stated_for} value, so the key is not needed"
            help = f"remove `{kind}`"
        yield Fault.at(stated, kind, message, help)


def _gives(field: Scalar) -> str:
    """Return which value the formula of a field computes: ``raw`` or ``physical``."""
    return "raw" if formula.is_inverse(field.source["formula"]) else "physical"


@rule("ICD063")
def only_numbers_have_units(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields_with["unit"]:
        if field.type in ("bool", "enum") or field.is_bytes:
            message = f"{quote(field.name)} is `{field.type}`, which has no unit"
            yield Fault.at(
                field.source, "unit", message, "remove `unit`, or correct `type`"
            )


@rule("ICD064")
def formulas_are_computable(ctx: Context) -> Iterator[Fault]:
    checked: dict[str, bool] = {}
    for field, _ in (*ctx.fields_with["formula"], *ctx.fields_with["points"]):
        scale, own = field.scale, field.curve
        if (
            # A table or polynomial is computed in binary64 (IEEE 754), whose largest
            # finite number is about 1.8e308.
            own is not None
            and field.type != "float"
            and not curve.is_finite(own, field.raw_min, field.raw_max)
        ):
            key, what = _calibration(field)
            message = f"the {what} of {quote(field.name)} exceeds the range of a double"
            yield Fault.at(field.source, key, message, "correct an exponent, or `bits`")
        if scale is None:
            continue
        # Large ICDs have few different formulas.
        if field.formula not in checked:
            checked[field.formula] = exact.is_too_large(scale)
        if checked[field.formula]:
            p, c, q = map(_shown, exact.terms(scale))
            message = f"the formula of {quote(field.name)} needs numbers that are too large: (raw*{p} + {c}) / {q}"
            help = "factor and divisor go up to 2^180, the offset up to 2^240, over their common denominator"
            yield Fault.at(field.source, "formula", message, help)


@rule("ICD066", severity="warning")
def sent_formulas_are_invertible(ctx: Context) -> Iterator[Fault]:
    fields = [
        (field, line)
        for field, line in (*ctx.fields_with["formula"], *ctx.fields_with["points"])
        if field.has_formula and not field.is_invertible and not is_overlay(line.node)
    ]
    senders = _senders(ctx) if fields else {}
    for field, line in fields:
        telecommand = senders.get(id(line.owner.layout))
        if telecommand is None:
            continue
        if field.type == "float":
            why = "for a float, only a linear formula can be inverted"
        # Only a test of all raw values shows whether these curves have an inverse.
        elif field.bits > curve.MOST_BITS:
            what = (
                "table"
                if field.curve is not None and field.curve.points
                else "polynomial"
            )
            why = f"for a {what}, this is only computed for fields of up to {curve.MOST_BITS} bits"
        elif field.settable_raws[0] >= field.settable_raws[1]:
            why = "no two raw values lie between its points"
        else:
            why = "its values are not strictly increasing or decreasing"
        key, what = _calibration(field)
        text = f"the {what} of {quote(field.name)} cannot be inverted, but {quote(telecommand.name)} is sent: {why}"
        yield Fault.at(field.source, key, text, _ONLY_RAW)


def _senders(ctx: Context) -> dict[int, Message]:
    """Return the first sent message that contains each layout, by the id() of the
    layout.
    """
    senders: dict[int, Message] = {}
    for message, node in ctx.messages:
        if message.telecommand_id is not None:
            senders.setdefault(id(message.layout), message)
            for visit in walk(message.layout, node.orders):
                struct = struct_layout_of(visit.node)
                if struct is not None:
                    senders.setdefault(id(struct), message)
    return senders


def _calibration(field: Scalar) -> tuple[str, str]:
    """Return the key for the calibration of a field, and a word for messages."""
    return (
        ("points", "table")
        if field.curve is not None and field.curve.points
        else ("formula", "formula")
    )


def _shown(number: int) -> str:
    """Return a number in words that do not grow with its size."""
    if abs(number) < 1 << 64:
        return f"{number:,}"
    return (
        f"{number:.2e}"
        if abs(number) < 1 << 1000
        else f"(a number of {number.bit_length():,} bits)"
    )
