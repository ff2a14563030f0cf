"""Edits of bytes on the wire."""

from __future__ import annotations

from dataclasses import replace

from icdgen.frame_bits import reserved_bits
from icdgen.icd.layout import Layout, Scalar
from icdgen.icd.layout_nodes import overlay_of
from icdgen.icd.lines import lines
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, Message
from tests.diff.edits.edit import (
    done,
    edit,
    fields_of,
    free_id,
    is_free,
    is_plain,
    messages_of,
    on_field,
    on_message,
    pick,
    scalars,
    with_field,
    with_fields,
    with_layout,
    with_message,
    with_node,
)


@edit()
def move_field(icd, rng):
    candidates = [
        (n, m, f, g) for n, m, f in fields_of(icd, lambda f: not f.is_bytes) for g in reserved_bits(m, n) if g.bits >= f.bits
    ]  # fmt: skip
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, field, gap = choice
    return done(
        with_field(icd, node, message, field, replace(field, at=gap.at)),
        message.name,
        "DIF107",
    )


@edit()
def swap_fields(icd, rng):
    candidates = [
        (n, m, a, b)
        for n, m, a in fields_of(icd)
        for b in scalars(m)
        if a.at < b.at and a.bits == b.bits and (a.is_bytes) == (b.is_bytes)
    ]
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, a, b = choice
    places = {id(a): b.at, id(b): a.at}
    fields = [replace(f, at=places.get(id(f), f.at)) for f in scalars(message)]
    return done(with_fields(icd, node, message, fields), message.name, "DIF107")


@edit()
def insert_field(icd, rng):
    candidates = [
        (n, m, f)
        for n, m, f in fields_of(icd, lambda f: f.at % 8 == 0)
        if is_free(m, "Inserted") and _cut_at(m, f.at)
    ]
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, field = choice
    new = Scalar(name="Inserted", at=field.at, bits=8, type="uint")
    fields = [
        replace(f, at=f.at + 8) if f.at >= field.at else f for f in scalars(message)
    ]
    edited = with_fields(
        icd, node, message, [*fields, new], length=message.layout.length + 1
    )
    return done(edited, message.name, "DIF106", "DIF108", "DIF311")


def _cut_at(message: Message, bit: int) -> bool:
    """Return whether no field crosses the bit."""
    return not any(f.at < bit < f.at + f.width for f in lines(message.layout))


@on_message(lambda m: is_free(m, "Appended"))
def append_field(icd, rng, node, message):
    new = Scalar(name="Appended", at=message.layout.length * 8, bits=16, type="int")
    edited = with_fields(
        icd, node, message, [*scalars(message), new], length=message.layout.length + 2
    )
    return done(edited, message.name, "DIF106", "DIF311")


@on_field()
def drop_field(icd, rng, node, message, field):
    edited = with_fields(
        icd, node, message, [f for f in scalars(message) if f is not field]
    )
    return done(edited, message.name, "DIF113", "DIF306")


@edit()
def take_field_out(icd, rng):
    candidates = fields_of(icd, lambda f: f.at % 8 == 0 and f.bits % 8 == 0)
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, field = choice
    remaining = [f for f in scalars(message) if f is not field]
    fields = [
        replace(f, at=f.at - field.bits) if f.at > field.at else f for f in remaining
    ]
    edited = with_fields(
        icd, node, message, fields, length=message.layout.length - field.bits // 8
    )
    behind = [f for f in remaining if f.at > field.at]
    must = ("DIF106", "DIF306", *(("DIF108",) if behind else ()))
    return done(edited, message.name, *must, may=() if behind else ("DIF113",))


@edit()
def fill_gap(icd, rng):
    candidates = [
        (n, m, g)
        for n, m in messages_of(icd, lambda m: is_free(m, "Filler"))
        for g in reserved_bits(m, n)
    ]
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, gap = choice
    new = Scalar(name="Filler", at=gap.at, bits=min(gap.bits, 8), type="uint")
    return done(
        with_fields(icd, node, message, [*scalars(message), new]),
        message.name,
        "DIF114",
        "DIF311",
    )


@on_field(lambda f: is_plain(f) and f.bits > 1)
def add_view(icd, rng, node, message, field):
    if not is_free(message, "Seen"):
        return None
    new = replace(
        field,
        name="Seen",
        identifier=None,
        bits=field.bits - 1,
        type="int",
        unit=None,
        scale=None,
        formula="",
    )
    new = replace(new, const=None, special=(), limits=None, enum=None, errata=())
    layout = replace(message.layout, fixed=(*message.layout.fixed, overlay_of(new)))
    edited = with_layout(icd, node, message, layout)
    return done(edited, message.name, "DIF311")


@on_field(lambda f: is_plain(f) and f.bits > 1)
def narrow_field(icd, rng, node, message, field):
    edited = with_field(icd, node, message, field, replace(field, bits=field.bits - 1))
    return done(edited, message.name, "DIF110", may=("DIF307", "DIF308"))


@on_field(is_plain)
def change_sign(icd, rng, node, message, field):
    new = replace(field, type="int" if field.type == "uint" else "uint")
    return done(
        with_field(icd, node, message, field, new),
        message.name,
        "DIF111",
        "DIF307",
        may=("DIF308",),
    )


@on_field(lambda f: is_plain(f) and f.scale is None and f.at % 8 == f.bits % 8 == 0)
def make_bytes(icd, rng, node, message, field):
    new = replace(field, type="bytes", unit=None)
    may = ("DIF202", "DIF308") if field.unit else ()
    return done(
        with_field(icd, node, message, field, new),
        message.name,
        "DIF111",
        "DIF307",
        may=may,
    )


@on_message()
def change_length(icd, rng, node, message):
    longer = replace(message.layout, length=message.layout.length + 1)
    return done(with_layout(icd, node, message, longer), message.name, "DIF106")


@edit()
def change_id(icd, rng):
    number, choice = free_id(icd), pick(rng, messages_of(icd))
    if choice is None or number is None:
        return None
    node, message = choice
    key = "set_id" if message.kind == CONFIGURATION else "id"
    return done(
        with_message(icd, node, message, replace(message, **{key: number})),
        message.name,
        "DIF103",
    )


@edit()
def swap_ids(icd, rng):
    candidates = [
        (n, a, b) for n in icd.nodes for a in n.messages for b in n.messages
        if a.kind == b.kind != CONFIGURATION and a.id < b.id
    ]  # fmt: skip
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, a, b = choice
    ids = {id(a): b.id, id(b): a.id}
    messages = tuple(
        replace(m, id=ids[id(m)]) if id(m) in ids else m for m in node.messages
    )
    return done(
        with_node(icd, node, replace(node, messages=messages)), "", "DIF103", "DIF104"
    )


@on_message()
def remove_message(icd, rng, node, message):
    return done(with_message(icd, node, message), message.name, "DIF101", "DIF306")


@edit()
def add_message(icd, rng):
    number, choice = free_id(icd), pick(rng, icd.nodes)
    if number is None or any(m.name == "Added" for m in choice.messages):
        return None
    layout = Layout("Added", 1, (Scalar(name="Level", bits=8, type="uint"),))
    kind = rng.choice([TELECOMMAND, "telemetry"])
    new = Message("Added", kind, layout, number, node=choice.name)
    return done(
        with_node(icd, choice, replace(choice, messages=(*choice.messages, new))),
        "Added",
        "DIF102",
        "DIF311",
    )


@on_message(lambda m: m.kind == CONFIGURATION)
def change_kind(icd, rng, node, message):
    new = replace(
        message, kind=TELECOMMAND, id=message.set_id, set_id=None, get_id=None
    )
    return done(with_message(icd, node, message, new), message.name, "DIF105")


@edit()
def turn_byte_order(icd, rng):
    candidates = [
        n
        for n in icd.nodes
        if any(not f.is_bytes and f.bits > 8 for m in n.messages for f in scalars(m))
    ]
    node = pick(rng, candidates)
    if node is None:
        return None
    other = {"little": "big", "big": "little"}[node.byte_order]
    return done(with_node(icd, node, replace(node, byte_order=other)), "", "DIF112")


@edit()
def turn_field(icd, rng):
    candidates = fields_of(
        icd, lambda f: f.type in ("uint", "int", "float") and f.bits > 8
    )
    choice = pick(
        rng,
        [
            (n, m, f)
            for n, m, f in candidates
            if not f.orders.within(m.layout.orders).byte
        ],
    )
    if choice is None:
        return None
    node, message, field = choice
    other = {"little": "big", "big": "little"}[node.byte_order]
    turned = replace(field, orders=replace(field.orders, byte=other))
    return done(with_field(icd, node, message, field, turned), message.name, "DIF117")


@edit(beyond=True)
def change_fact(icd, rng):
    candidates = [
        (n, key, part, value) for n in icd.nodes for key, section in n.protocol.items() if isinstance(section, dict)
        for part, value in section.items() if isinstance(value, int) and part != "printed_constant"
    ]  # fmt: skip
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, key, part, value = choice
    new = {
        **node.protocol,
        key: {
            **node.protocol[key],
            part: not value if isinstance(value, bool) else value + 1,
        },
    }
    return done(with_node(icd, node, replace(node, protocol=new)), "", "DIF120")


@edit(beyond=True)
def change_mask_bit(icd, rng):
    candidates = [(n, row) for n in icd.nodes for row in n.loggable]
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, row = choice
    rows = tuple(replace(r, id=r.id + 1) if r is row else r for r in node.loggable)
    return done(with_node(icd, node, replace(node, loggable=rows)), "", "DIF122")


@edit(beyond=True)
def drop_mask_bit(icd, rng):
    choice = pick(rng, [(n, row) for n in icd.nodes for row in n.loggable])
    if choice is None:
        return None
    node, row = choice
    rows = tuple(r for r in node.loggable if r is not row)
    return done(with_node(icd, node, replace(node, loggable=rows)), "", "DIF123")
