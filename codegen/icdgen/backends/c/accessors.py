"""Rows of the accessors of physical values."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import about, physical
from icdgen.backends.c.names import accessor_unit
from icdgen.backends.c.plan import Member, Plan
from icdgen.backends.c.prefixes import part_of_unit
from icdgen.backends.c.statement import call, head
from icdgen.backends.c.text import comment, plain


class Accessor(NamedTuple):
    """A getter and a setter of a physical value; ``test`` holds for values that the setter refuses by itself."""

    get_comment: str
    get_head: str
    set_comment: str
    set_head: str
    expression: str
    assignment: str
    test: str = ""


def accessors(plan: Plan) -> list[Accessor]:
    """In double precision."""
    return [_double(plan, member) for member in plan.members if member.field.scale is not None]


def _double(plan: Plan, member: Member) -> Accessor:
    field, name, storage = member
    scaled = physical.scaled(field, storage)
    unit = accessor_unit(field)
    what = plain(field.name) + (f" in {plain(field.unit.symbol)}" if field.unit else "")
    function, *arguments = scaled.setter
    return _accessor(
        plan,
        (f"{name}_{unit}", "double"),
        (f"{what}: {about.formula(field)}, {about.physical_range(field)}.", what),
        scaled.getter.format(raw=f"message->{name}"),
        call(f"return {function}", (f"&message->{name}", *arguments)),
    )


def whole_accessors(plan: Plan) -> list[Accessor]:
    """In whole thousandths or millionths of the unit."""
    scaled = (m for m in plan.members if m.field.scale is not None)
    wholes = ((m, physical.scaled(m.field, m.storage).whole) for m in scaled)
    return [_whole(plan, member, whole) for member, whole in wholes if whole is not None]


def _whole(plan: Plan, member: Member, whole: physical.Whole) -> Accessor:
    field, name, _ = member
    suffix, words = part_of_unit(field, whole.prefix)
    what = f"{plain(field.name)} in {plain(words)}"
    tests = [f"value < {whole.least}"] if whole.least is not None else []
    tests += [f"value > {whole.most}"] if whole.most is not None else []
    return _accessor(
        plan,
        (f"{name}_{suffix}", whole.type),
        (f"{what}, exact: {whole.low} to {whole.high}.", what),
        whole.getter.format(raw=f"message->{name}"),
        f"message->{name} = {whole.setter};",
        " || ".join(tests),
    )


def _accessor(
    plan: Plan, ends: tuple[str, str], texts: tuple[str, str], expression: str, assignment: str, test: str = ""
) -> Accessor:
    (end, type_name), (get_text, what) = ends, texts
    return Accessor(
        get_comment=comment([get_text]),
        get_head=head(f"{type_name} ", f"{plan.stem}_{end}", f"const {plan.type} *message"),
        set_comment=comment([f"Sets {what} to the nearest raw value; ICD_ERROR_RANGE if there is none."]),
        set_head=head("icd_status_t ", f"{plan.stem}_set_{end}", f"{plan.type} *message, {type_name} value"),
        expression=expression,
        assignment=assignment,
        test=test,
    )
