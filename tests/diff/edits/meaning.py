"""Edits of the meaning of bytes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from icdgen.icd.formula import Scale
from icdgen.icd.model import TELECOMMAND, Limits, Special
from icdgen.icd.units import STANDARD
from tests.diff.edits.edit import (
    STRANGE,
    done,
    edit,
    fields_of,
    members_of,
    on_field,
    on_message,
    pick,
    with_enum,
    with_field,
    with_member,
    with_message,
    with_node,
)


def _scaled(icd, rng, new: Callable[[Scale], Scale], code: str):
    choice = pick(rng, fields_of(icd, lambda f: f.scale is not None and not f.limits))
    if choice is None:
        return None
    node, message, field = choice
    edited = with_field(
        icd, node, message, field, replace(field, scale=new(field.scale), formula="")
    )
    return done(edited, message.name, code, may=("DIF308",))


@edit()
def change_factor(icd, rng):
    return _scaled(icd, rng, lambda s: Scale(s.factor * 10, s.offset), "DIF201")


@edit()
def change_offset(icd, rng):
    return _scaled(icd, rng, lambda s: Scale(s.factor, s.offset + 1), "DIF201")


@edit()
def turn_factor(icd, rng):
    return _scaled(icd, rng, lambda s: Scale(-s.factor, s.offset), "DIF203")


@on_field(lambda f: f.unit is not None)
def change_unit(icd, rng, node, message, field):
    unit = STANDARD[rng.choice([s for s in STANDARD if s != field.unit.symbol])]
    may = ("DIF308",) if field.scale is not None or field.limits else ()
    return done(
        with_field(icd, node, message, field, replace(field, unit=unit)),
        message.name,
        "DIF202",
        may=may,
    )


@on_field(lambda f: f.const is not None)
def change_const(icd, rng, node, message, field):
    return done(
        with_field(icd, node, message, field, replace(field, const=field.const ^ 1)),
        message.name,
        "DIF209",
    )


@on_field(lambda f: f.type in ("uint", "int"))
def change_limits(icd, rng, node, message, field):
    old = field.limits or Limits()
    new = replace(
        field,
        limits=replace(old, min=(old.min if old.min is not None else Fraction(0)) + 1),
    )
    return done(
        with_field(icd, node, message, field, new),
        message.name,
        "DIF211",
        may=("DIF308",),
    )


@on_field(lambda f: f.type == "uint" and all(s.value != f.raw_max for s in f.special))
def add_special(icd, rng, node, message, field):
    new = replace(
        field, special=(*field.special, Special(field.raw_max, "quite special"))
    )
    return done(
        with_field(icd, node, message, field, new),
        message.name,
        "DIF210",
        may=("DIF308",),
    )


@on_message(lambda m: m.kind == TELECOMMAND)
def change_answer(icd, rng, node, message):
    new = replace(message, acknowledge=not message.acknowledge)
    return done(with_message(icd, node, message, new), message.name, "DIF212")


@edit()
def change_node_type(icd, rng):
    node = rng.choice(icd.nodes)
    return done(
        with_node(icd, node, replace(node, node_type=(node.node_type or 0) + 1)),
        "",
        "DIF215",
    )


@edit()
def change_member_sense(icd, rng):
    choice = pick(
        rng,
        [
            (e, i)
            for e, i in members_of(icd)
            if all(m.name != STRANGE for m in e.members)
        ],
    )
    if choice is None:
        return None
    enum, index = choice
    edited = with_member(icd, enum, index, name=STRANGE, identifier=None)
    return done(edited, enum.name, "DIF205", "DIF304")


@edit()
def renumber_member(icd, rng):
    users = {
        id(f.enum): f.bits
        for _, _, f in reversed(fields_of(icd, lambda f: f.enum is not None))
    }
    candidates = []
    for enum, index in members_of(icd):
        free = next(
            (
                v
                for v in range(1 << users.get(id(enum), 0))
                if all(m.value != v for m in enum.members)
            ),
            None,
        )
        twins = [m.name for m in enum.members].count(enum.members[index].name)
        if free is not None and twins == 1:
            candidates.append((enum, index, free))
    choice = pick(rng, candidates)
    if choice is None:
        return None
    enum, index, value = choice
    return done(with_member(icd, enum, index, value=value), enum.name, "DIF206")


@edit()
def remove_member(icd, rng):
    choice = pick(rng, [(e, i) for e, i in members_of(icd) if len(e.members) > 1])
    if choice is None:
        return None
    enum, index = choice
    members = tuple(m for i, m in enumerate(enum.members) if i != index)
    return done(
        with_enum(icd, enum, replace(enum, members=members)),
        enum.name,
        "DIF207",
        "DIF306",
    )
