"""Edits of texts, and edits that change nothing."""

from __future__ import annotations

from dataclasses import replace

from icdgen.icd.erratum import Erratum
from icdgen.naming import words
from tests.diff.edits.edit import (
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


@on_field(text=True)
def change_field_summary(icd, rng, node, message, field):
    new = replace(field, summary=f"{field.summary} More.".strip())
    return done(with_field(icd, node, message, field, new), message.name, "DIF401")


@on_message(text=True)
def change_message_words(icd, rng, node, message):
    key, value, code = rng.choice(
        [
            ("summary", f"{message.summary} More.", "DIF401"),
            ("table", (message.table or 0) + 1, "DIF402"),
            ("page", (message.page or 0) + 1, "DIF402"),
            ("group", f"{message.group} and more", "DIF407"),
            ("hazard", f"{message.hazard} More.".strip(), "DIF401"),
        ]
    )
    return done(
        with_message(icd, node, message, replace(message, **{key: value})),
        message.name,
        code,
    )


@edit(text=True)
def respell_field(icd, rng):
    candidates = []
    for node, message, field in fields_of(icd):
        name = field.name.replace(" ", " - ")
        if name != field.name and words(name, node.vocabulary) == words(
            field.name, node.vocabulary
        ):
            candidates.append((node, message, field, name))
    choice = pick(rng, candidates)
    if choice is None:
        return None
    node, message, field, name = choice
    return done(
        with_field(icd, node, message, field, replace(field, name=name)),
        message.name,
        "DIF406",
    )


@edit(text=True)
def change_enum_words(icd, rng):
    choice = pick(rng, members_of(icd))
    if choice is None:
        return None
    enum, index = choice
    if rng.random() < 0.5:
        new = replace(enum, table=(enum.table or 0) + 1)
        return done(with_enum(icd, enum, new), enum.name, "DIF402")
    summary = f"{enum.members[index].summary} More.".strip()
    return done(with_member(icd, enum, index, summary=summary), enum.name, "DIF401")


@on_field(text=True)
def note_an_erratum(icd, rng, node, message, field):
    number = sum(e.id.startswith("NEW-") for e in node.errata)
    erratum = Erratum(f"NEW-{number:03}", "A note", "Why.", "Evidence.", "open")
    edited = with_field(
        icd, node, message, field, replace(field, errata=(*field.errata, erratum))
    )
    home = next(n for n in edited.nodes if n.name == node.name)
    return done(
        with_node(edited, home, replace(home, errata=(*home.errata, erratum))),
        "",
        "DIF403",
    )


@edit(text=True)
def shuffle(icd, rng):
    """Change the order of declarations, which is no change."""
    node = rng.choice(icd.nodes)
    layouts = [
        replace(m.layout, fixed=tuple(rng.sample(m.layout.fixed, len(m.layout.fixed))))
        for m in node.messages
    ]
    messages = [
        replace(m, layout=layout)
        for m, layout in zip(node.messages, layouts, strict=True)
    ]
    enums = rng.sample(node.enums, len(node.enums))
    rng.shuffle(messages)
    return done(
        with_node(
            icd, node, replace(node, messages=tuple(messages), enums=tuple(enums))
        ),
        "",
    )


@on_field(lambda f: f.scale is not None, text=True)
def respell_formula(icd, rng, node, message, field):
    """Write the same formula differently, which is no change."""
    return done(
        with_field(
            icd, node, message, field, replace(field, formula=f"({field.formula})")
        ),
        "",
    )
