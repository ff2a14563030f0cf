"""Edits of names."""

from __future__ import annotations

from dataclasses import replace

from icdgen.diff.similar import same_sense
from icdgen.naming import words
from tests.diff.edits.edit import (
    STRANGE,
    done,
    edit,
    fields_of,
    is_free,
    members_of,
    messages_of,
    pick,
    with_enum,
    with_field,
    with_member,
    with_message,
)


@edit()
def rename_field(icd, rng):
    choice = pick(
        rng, [(n, m, f) for n, m, f in fields_of(icd) if is_free(m, f"{f.name} Value")]
    )
    if choice is None:
        return None
    node, message, field = choice
    new = replace(
        field,
        name=f"{field.name} Value",
        identifier=f"{field.identifier} Value" if field.identifier else None,
    )
    return done(with_field(icd, node, message, field, new), message.name, "DIF302")


@edit()
def rename_field_to_another_sense(icd, rng):
    choice = pick(rng, [(n, m, f) for n, m, f in fields_of(icd) if is_free(m, STRANGE)])
    if choice is None:
        return None
    node, message, field = choice
    new = replace(field, name=STRANGE, identifier=None)
    return done(
        with_field(icd, node, message, field, new), message.name, "DIF213", "DIF302"
    )


@edit()
def rename_message(icd, rng):
    used = {m.name for _, m in messages_of(icd)}
    choice = pick(rng, messages_of(icd, lambda m: f"{m.name} Frame" not in used))
    if choice is None:
        return None
    node, message = choice
    name = f"{message.name} Frame"
    new = replace(
        message,
        name=name,
        identifier=f"{message.identifier} Frame" if message.identifier else None,
    )
    return done(with_message(icd, node, message, new), name, "DIF301")


@edit()
def rename_enum(icd, rng):
    enum = pick(rng, [e for n in icd.nodes for e in n.enums if len(e.members) > 1])
    if enum is None:
        return None
    name = f"{enum.name}Kind"
    return done(
        with_enum(icd, enum, replace(enum, name=name, identifier=None)), name, "DIF303"
    )


@edit()
def mend_member(icd, rng):
    """Double a letter of a member's name, like a typing error."""
    candidates = []
    for enum, index in members_of(icd):
        member = enum.members[index]
        name = member.name[:4] + member.name[3:]
        if (
            member.identifier is None
            and same_sense(name, member.name)
            and words(name) != words(member.name)
        ):
            if all(m.name != name for m in enum.members):
                candidates.append((enum, index, name))
    choice = pick(rng, candidates)
    if choice is None:
        return None
    enum, index, name = choice
    return done(with_member(icd, enum, index, name=name), enum.name, "DIF304")
