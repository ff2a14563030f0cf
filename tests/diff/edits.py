"""Single edits of ICD models: what a release may change, and what the diff must say of it.

Each edit takes a set of ICDs and a source of randomness. It returns the edited set with the codes that must be found and those that
may be, or None where there is nothing to which it applies.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from icdgen.diff.similar import same_sense
from icdgen.icd.formula import Scale
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, Enum, Erratum, Field, Icd, Limits, Message, Node, Special
from icdgen.icd.units import STANDARD
from icdgen.layout import gaps
from icdgen.naming import words


@dataclass(frozen=True)
class Edited:
    """``must`` are found, ``may`` possibly, and nothing else. ``at`` names the message or enumeration."""

    icd: Icd
    must: frozenset[str]
    may: frozenset[str]
    at: str = ""


Edit = Callable[[Icd, random.Random], "Edited | None"]
EDITS: dict[str, Edit] = {}
TEXT: list[str] = []  # edits of words only
BEYOND: list[str] = []  # edits of what no message of the generated code shows: protocol facts, the log mask
STRANGE = "Zorkmid flux 7"


def edit(text: bool = False, beyond: bool = False) -> Callable[[Edit], Edit]:
    def register(function: Edit) -> Edit:
        name = function.__name__
        EDITS[name] = function
        if text:
            TEXT.append(name)
        if beyond:
            BEYOND.append(name)
        return function

    return register


def done(icd: Icd, at: str, *must: str, may: tuple[str, ...] = ()) -> Edited:
    return Edited(icd, frozenset(must), frozenset(may), at)


# Putting things in the place of others


def with_node(icd: Icd, old: Node, new: Node) -> Icd:
    return Icd(tuple(new if node is old else node for node in icd.nodes))


def with_message(icd: Icd, node: Node, old: Message, *new: Message) -> Icd:
    messages = [m for one in node.messages for m in (new if one is old else (one,))]
    return with_node(icd, node, replace(node, messages=tuple(messages)))


def with_fields(icd: Icd, node: Node, message: Message, fields: list[Field], **more: object) -> Icd:
    return with_message(icd, node, message, replace(message, fields=tuple(fields), **more))


def with_field(icd: Icd, node: Node, message: Message, old: Field, new: Field) -> Icd:
    return with_fields(icd, node, message, [new if one is old else one for one in message.fields])


def with_enum(icd: Icd, old: Enum, new: Enum) -> Icd:
    def field(one: Field) -> Field:
        return replace(one, enum=new) if one.enum is old else one

    def message(one: Message) -> Message:
        return replace(one, fields=tuple(map(field, one.fields))) if any(f.enum is old for f in one.fields) else one

    return Icd(
        tuple(
            replace(
                node,
                enums=tuple(new if e is old else e for e in node.enums),
                messages=tuple(map(message, node.messages)),
            )
            for node in icd.nodes
        )
    )


# Choosing


def pick(rng: random.Random, items: Iterator | list):
    items = list(items)
    return rng.choice(items) if items else None


def fields_of(icd: Icd, wanted: Callable[[Field], bool] = lambda f: True) -> list[tuple[Node, Message, Field]]:
    return [(n, m, f) for n in icd.nodes for m in n.messages for f in m.fields if wanted(f)]


def messages_of(icd: Icd, wanted: Callable[[Message], bool] = lambda m: True) -> list[tuple[Node, Message]]:
    return [(n, m) for n in icd.nodes for m in n.messages if wanted(m)]


def members_of(icd: Icd) -> list[tuple[Enum, int]]:
    return [(e, i) for n in icd.nodes for e in n.enums for i in range(len(e.members))]


def is_plain(field: Field) -> bool:
    """A number without anything that depends on its range."""
    return (
        field.type in ("uint", "int")
        and field.const is None
        and not field.special
        and not field.limits
        and not field.bitfields
    )


def is_free(message: Message, name: str) -> bool:
    return all(words(f.name) != words(name) and f.name != name for f in message.fields)


def free_id(icd: Icd) -> int | None:
    taken = {number for node in icd.nodes for m in node.messages for number in m.ids}
    return next((number for number in range(250, 0, -1) if number not in taken), None)


# Wire


@edit()
def move_field(icd, rng):
    found = [
        (n, m, f, g) for n, m, f in fields_of(icd, lambda f: f.type != "bytes") for g in gaps(m) if g.bits >= f.bits
    ]  # fmt: skip
    one = pick(rng, found)
    if one is None:
        return None
    node, message, field, gap = one
    return done(with_field(icd, node, message, field, replace(field, at=gap.at)), message.name, "DIF107")


@edit()
def swap_fields(icd, rng):
    found = [
        (n, m, a, b)
        for n, m, a in fields_of(icd)
        for b in m.fields
        if a.at < b.at and a.bits == b.bits and (a.type == "bytes") == (b.type == "bytes")
    ]
    one = pick(rng, found)
    if one is None:
        return None
    node, message, a, b = one
    places = {id(a): b.at, id(b): a.at}
    fields = [replace(f, at=places.get(id(f), f.at)) for f in message.fields]
    return done(with_fields(icd, node, message, fields), message.name, "DIF107")


@edit()
def insert_field(icd, rng):
    found = [
        (n, m, f) for n, m, f in fields_of(icd, lambda f: f.at % 8 == 0) if is_free(m, "Inserted") and _cut_at(m, f.at)
    ]
    one = pick(rng, found)
    if one is None:
        return None
    node, message, field = one
    new = Field("Inserted", field.at, 8, "uint")
    fields = [replace(f, at=f.at + 8) if f.at >= field.at else f for f in message.fields]
    edited = with_fields(icd, node, message, [*fields, new], length=message.length + 1)
    return done(edited, message.name, "DIF106", "DIF108", "DIF311")


def _cut_at(message: Message, bit: int) -> bool:
    """Whether no field lies across the bit."""
    return not any(f.at < bit < f.at + f.bits for f in message.fields)


@edit()
def append_field(icd, rng):
    one = pick(rng, messages_of(icd, lambda m: is_free(m, "Appended")))
    if one is None:
        return None
    node, message = one
    new = Field("Appended", message.length * 8, 16, "int")
    edited = with_fields(icd, node, message, [*message.fields, new], length=message.length + 2)
    return done(edited, message.name, "DIF106", "DIF311")


@edit()
def drop_field(icd, rng):
    one = pick(rng, fields_of(icd))
    if one is None:
        return None
    node, message, field = one
    edited = with_fields(icd, node, message, [f for f in message.fields if f is not field])
    return done(edited, message.name, "DIF113", "DIF306")


@edit()
def take_field_out(icd, rng):
    found = fields_of(icd, lambda f: f.at % 8 == 0 and f.bits % 8 == 0)
    one = pick(rng, found)
    if one is None:
        return None
    node, message, field = one
    rest = [f for f in message.fields if f is not field]
    fields = [replace(f, at=f.at - field.bits) if f.at > field.at else f for f in rest]
    edited = with_fields(icd, node, message, fields, length=message.length - field.bits // 8)
    behind = [f for f in rest if f.at > field.at]
    must = ("DIF106", "DIF306", *(("DIF108",) if behind else ()))
    return done(edited, message.name, *must, may=() if behind else ("DIF113",))


@edit()
def fill_gap(icd, rng):
    found = [(n, m, g) for n, m in messages_of(icd, lambda m: is_free(m, "Filler")) for g in gaps(m)]
    one = pick(rng, found)
    if one is None:
        return None
    node, message, gap = one
    new = Field("Filler", gap.at, min(gap.bits, 8), "uint")
    return done(with_fields(icd, node, message, [*message.fields, new]), message.name, "DIF114", "DIF311")


@edit()
def narrow_field(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: is_plain(f) and f.bits > 1))
    if one is None:
        return None
    node, message, field = one
    edited = with_field(icd, node, message, field, replace(field, bits=field.bits - 1))
    return done(edited, message.name, "DIF110", may=("DIF307", "DIF308"))


@edit()
def change_sign(icd, rng):
    one = pick(rng, fields_of(icd, is_plain))
    if one is None:
        return None
    node, message, field = one
    new = replace(field, type="int" if field.type == "uint" else "uint")
    return done(with_field(icd, node, message, field, new), message.name, "DIF111", "DIF307", may=("DIF308",))


@edit()
def make_bytes(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: is_plain(f) and f.scale is None and f.at % 8 == f.bits % 8 == 0))
    if one is None:
        return None
    node, message, field = one
    new = replace(field, type="bytes", unit=None)
    may = ("DIF202", "DIF308") if field.unit else ()
    return done(with_field(icd, node, message, field, new), message.name, "DIF111", "DIF307", may=may)


@edit()
def change_length(icd, rng):
    one = pick(rng, messages_of(icd))
    if one is None:
        return None
    node, message = one
    return done(with_message(icd, node, message, replace(message, length=message.length + 1)), message.name, "DIF106")


@edit()
def change_id(icd, rng):
    number, one = free_id(icd), pick(rng, messages_of(icd))
    if one is None or number is None:
        return None
    node, message = one
    key = "set_id" if message.kind == CONFIGURATION else "id"
    return done(with_message(icd, node, message, replace(message, **{key: number})), message.name, "DIF103")


@edit()
def swap_ids(icd, rng):
    found = [
        (n, a, b) for n in icd.nodes for a in n.messages for b in n.messages
        if a.kind == b.kind != CONFIGURATION and a.id < b.id
    ]  # fmt: skip
    one = pick(rng, found)
    if one is None:
        return None
    node, a, b = one
    ids = {id(a): b.id, id(b): a.id}
    messages = tuple(replace(m, id=ids[id(m)]) if id(m) in ids else m for m in node.messages)
    return done(with_node(icd, node, replace(node, messages=messages)), "", "DIF103", "DIF104")


@edit()
def remove_message(icd, rng):
    one = pick(rng, messages_of(icd))
    if one is None:
        return None
    node, message = one
    return done(with_message(icd, node, message), message.name, "DIF101", "DIF306")


@edit()
def add_message(icd, rng):
    number, one = free_id(icd), pick(rng, icd.nodes)
    if number is None or any(m.name == "Added" for m in one.messages):
        return None
    new = Message(
        "Added", rng.choice([TELECOMMAND, "telemetry"]), 1, (Field("Level", 0, 8, "uint"),), number, node=one.name
    )
    return done(with_node(icd, one, replace(one, messages=(*one.messages, new))), "Added", "DIF102", "DIF311")


@edit()
def change_kind(icd, rng):
    one = pick(rng, messages_of(icd, lambda m: m.kind == CONFIGURATION))
    if one is None:
        return None
    node, message = one
    new = replace(message, kind=TELECOMMAND, id=message.set_id, set_id=None, get_id=None)
    return done(with_message(icd, node, message, new), message.name, "DIF105")


@edit()
def turn_byte_order(icd, rng):
    found = [n for n in icd.nodes if any(f.type != "bytes" and f.bits > 8 for m in n.messages for f in m.fields)]
    node = pick(rng, found)
    if node is None:
        return None
    other = {"little": "big", "big": "little"}[node.byte_order]
    return done(with_node(icd, node, replace(node, byte_order=other)), "", "DIF112")


@edit(beyond=True)
def change_fact(icd, rng):
    found = [
        (n, key, part, value) for n in icd.nodes for key, section in n.protocol.items() if isinstance(section, dict)
        for part, value in section.items() if isinstance(value, int) and part != "printed_constant"
    ]  # fmt: skip
    one = pick(rng, found)
    if one is None:
        return None
    node, key, part, value = one
    new = {**node.protocol, key: {**node.protocol[key], part: not value if isinstance(value, bool) else value + 1}}
    return done(with_node(icd, node, replace(node, protocol=new)), "", "DIF120")


@edit(beyond=True)
def change_mask_bit(icd, rng):
    found = [(n, row) for n in icd.nodes for row in n.loggable]
    one = pick(rng, found)
    if one is None:
        return None
    node, row = one
    rows = tuple(replace(r, id=r.id + 1) if r is row else r for r in node.loggable)
    return done(with_node(icd, node, replace(node, loggable=rows)), "", "DIF122")


@edit(beyond=True)
def drop_mask_bit(icd, rng):
    one = pick(rng, [(n, row) for n in icd.nodes for row in n.loggable])
    if one is None:
        return None
    node, row = one
    rows = tuple(r for r in node.loggable if r is not row)
    return done(with_node(icd, node, replace(node, loggable=rows)), "", "DIF123")


# Meaning


def _scaled(icd, rng, new: Callable[[Scale], Scale], code: str):
    one = pick(rng, fields_of(icd, lambda f: f.scale is not None and not f.limits))
    if one is None:
        return None
    node, message, field = one
    edited = with_field(icd, node, message, field, replace(field, scale=new(field.scale), formula=""))
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


@edit()
def change_unit(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: f.unit is not None))
    if one is None:
        return None
    node, message, field = one
    unit = STANDARD[rng.choice([s for s in STANDARD if s != field.unit.symbol])]
    may = ("DIF308",) if field.scale is not None or field.limits else ()
    return done(with_field(icd, node, message, field, replace(field, unit=unit)), message.name, "DIF202", may=may)


@edit()
def change_const(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: f.const is not None))
    if one is None:
        return None
    node, message, field = one
    return done(with_field(icd, node, message, field, replace(field, const=field.const ^ 1)), message.name, "DIF209")


@edit()
def change_limits(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: f.type in ("uint", "int")))
    if one is None:
        return None
    node, message, field = one
    old = field.limits or Limits()
    new = replace(field, limits=replace(old, min=(old.min if old.min is not None else Fraction(0)) + 1))
    return done(with_field(icd, node, message, field, new), message.name, "DIF211", may=("DIF308",))


@edit()
def add_special(icd, rng):
    one = pick(rng, fields_of(icd, lambda f: f.type == "uint" and all(s.value != f.raw_max for s in f.special)))
    if one is None:
        return None
    node, message, field = one
    new = replace(field, special=(*field.special, Special(field.raw_max, "quite special")))
    return done(with_field(icd, node, message, field, new), message.name, "DIF210", may=("DIF308",))


@edit()
def change_answer(icd, rng):
    one = pick(rng, messages_of(icd, lambda m: m.kind == TELECOMMAND))
    if one is None:
        return None
    node, message = one
    new = replace(message, acknowledge=not message.acknowledge)
    return done(with_message(icd, node, message, new), message.name, "DIF212")


@edit()
def change_node_type(icd, rng):
    node = rng.choice(icd.nodes)
    return done(with_node(icd, node, replace(node, node_type=(node.node_type or 0) + 1)), "", "DIF215")


def _with_member(icd: Icd, enum: Enum, index: int, **values: object) -> Icd:
    members = list(enum.members)
    members[index] = replace(members[index], **values)
    return with_enum(icd, enum, replace(enum, members=tuple(members)))


@edit()
def change_member_sense(icd, rng):
    one = pick(rng, [(e, i) for e, i in members_of(icd) if all(m.name != STRANGE for m in e.members)])
    if one is None:
        return None
    enum, index = one
    edited = _with_member(icd, enum, index, name=STRANGE, identifier=None)
    return done(edited, enum.name, "DIF205", "DIF304")


@edit()
def renumber_member(icd, rng):
    users = {id(f.enum): f.bits for _, _, f in reversed(fields_of(icd, lambda f: f.enum is not None))}
    found = []
    for enum, index in members_of(icd):
        free = next((v for v in range(1 << users.get(id(enum), 0)) if all(m.value != v for m in enum.members)), None)
        twins = [m.name for m in enum.members].count(enum.members[index].name)
        if free is not None and twins == 1:
            found.append((enum, index, free))
    one = pick(rng, found)
    if one is None:
        return None
    enum, index, value = one
    return done(_with_member(icd, enum, index, value=value), enum.name, "DIF206")


@edit()
def remove_member(icd, rng):
    one = pick(rng, [(e, i) for e, i in members_of(icd) if len(e.members) > 1])
    if one is None:
        return None
    enum, index = one
    members = tuple(m for i, m in enumerate(enum.members) if i != index)
    return done(with_enum(icd, enum, replace(enum, members=members)), enum.name, "DIF207", "DIF306")


# Source


@edit()
def rename_field(icd, rng):
    one = pick(rng, [(n, m, f) for n, m, f in fields_of(icd) if is_free(m, f"{f.name} Value")])
    if one is None:
        return None
    node, message, field = one
    new = replace(
        field, name=f"{field.name} Value", identifier=f"{field.identifier} Value" if field.identifier else None
    )
    return done(with_field(icd, node, message, field, new), message.name, "DIF302")


@edit()
def rename_field_to_another_sense(icd, rng):
    one = pick(rng, [(n, m, f) for n, m, f in fields_of(icd) if is_free(m, STRANGE)])
    if one is None:
        return None
    node, message, field = one
    new = replace(field, name=STRANGE, identifier=None)
    return done(with_field(icd, node, message, field, new), message.name, "DIF213", "DIF302")


@edit()
def rename_message(icd, rng):
    taken = {m.name for _, m in messages_of(icd)}
    one = pick(rng, messages_of(icd, lambda m: f"{m.name} Frame" not in taken))
    if one is None:
        return None
    node, message = one
    name = f"{message.name} Frame"
    new = replace(message, name=name, identifier=f"{message.identifier} Frame" if message.identifier else None)
    return done(with_message(icd, node, message, new), name, "DIF301")


@edit()
def rename_enum(icd, rng):
    enum = pick(rng, [e for n in icd.nodes for e in n.enums if len(e.members) > 1])
    if enum is None:
        return None
    name = f"{enum.name}Kind"
    return done(with_enum(icd, enum, replace(enum, name=name, identifier=None)), name, "DIF303")


@edit()
def mend_member(icd, rng):
    """A slip of the pen: one letter twice."""
    found = []
    for enum, index in members_of(icd):
        member = enum.members[index]
        name = member.name[:4] + member.name[3:]
        if member.identifier is None and same_sense(name, member.name) and words(name) != words(member.name):
            if all(m.name != name for m in enum.members):
                found.append((enum, index, name))
    one = pick(rng, found)
    if one is None:
        return None
    enum, index, name = one
    return done(_with_member(icd, enum, index, name=name), enum.name, "DIF304")


# Words


@edit(text=True)
def change_field_summary(icd, rng):
    one = pick(rng, fields_of(icd))
    if one is None:
        return None
    node, message, field = one
    new = replace(field, summary=f"{field.summary} More.".strip())
    return done(with_field(icd, node, message, field, new), message.name, "DIF401")


@edit(text=True)
def change_message_words(icd, rng):
    one = pick(rng, messages_of(icd))
    if one is None:
        return None
    node, message = one
    key, value, code = rng.choice(
        [
            ("summary", f"{message.summary} More.", "DIF401"),
            ("table", (message.table or 0) + 1, "DIF402"),
            ("page", (message.page or 0) + 1, "DIF402"),
            ("group", f"{message.group} and more", "DIF407"),
        ]
    )
    return done(with_message(icd, node, message, replace(message, **{key: value})), message.name, code)


@edit(text=True)
def respell_field(icd, rng):
    found = []
    for node, message, field in fields_of(icd):
        name = field.name.replace(" ", " - ")
        if name != field.name and words(name, node.vocabulary) == words(field.name, node.vocabulary):
            found.append((node, message, field, name))
    one = pick(rng, found)
    if one is None:
        return None
    node, message, field, name = one
    return done(with_field(icd, node, message, field, replace(field, name=name)), message.name, "DIF406")


@edit(text=True)
def change_enum_words(icd, rng):
    one = pick(rng, members_of(icd))
    if one is None:
        return None
    enum, index = one
    if rng.random() < 0.5:
        new = replace(enum, table=(enum.table or 0) + 1)
        return done(with_enum(icd, enum, new), enum.name, "DIF402")
    summary = f"{enum.members[index].summary} More.".strip()
    return done(_with_member(icd, enum, index, summary=summary), enum.name, "DIF401")


@edit(text=True)
def note_an_erratum(icd, rng):
    one = pick(rng, fields_of(icd))
    if one is None:
        return None
    node, message, field = one
    number = sum(e.id.startswith("NEW-") for e in node.errata)
    erratum = Erratum(f"NEW-{number:03}", "A note", "Why.", "Evidence.", "open")
    edited = with_field(icd, node, message, field, replace(field, errata=(*field.errata, erratum)))
    home = next(n for n in edited.nodes if n.name == node.name)
    return done(with_node(edited, home, replace(home, errata=(*home.errata, erratum))), "", "DIF403")


@edit(text=True)
def shuffle(icd, rng):
    """Order is no change at all."""
    node = rng.choice(icd.nodes)
    messages = [replace(m, fields=tuple(rng.sample(m.fields, len(m.fields)))) for m in node.messages]
    enums = rng.sample(node.enums, len(node.enums))
    rng.shuffle(messages)
    return done(with_node(icd, node, replace(node, messages=tuple(messages), enums=tuple(enums))), "")


@edit(text=True)
def respell_formula(icd, rng):
    """Nor is another spelling of the same formula."""
    one = pick(rng, fields_of(icd, lambda f: f.scale is not None))
    if one is None:
        return None
    node, message, field = one
    return done(with_field(icd, node, message, field, replace(field, formula=f"({field.formula})")), "")
