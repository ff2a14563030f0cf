"""What the languages would declare for a model, as far as it is sound."""

from __future__ import annotations

from collections import Counter
from collections.abc import Set
from dataclasses import replace
from operator import attrgetter, is_
from typing import NamedTuple

from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Field, Icd, Message, Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED

# Rules about names that are there twice.
TWINS = frozenset({"ICD050", "ICD051", "ICD052", "ICD053", "ICD054", "ICD057", "ICD049"})

_TEXT = attrgetter("text")


class Declared(NamedTuple):
    """What one language declares: hundreds of thousands of names, so that rules ask for those of some texts only."""

    language: str
    reserved: frozenset[str]
    identifiers: list[Identifier]
    texts: Counter[str]  # in all scopes together

    def spelled(self, texts: Set[str]) -> list[Identifier]:
        """The identifiers that are one of these texts."""
        return [one for one in self.identifiers if one.text in texts] if texts else []


def declared(ctx: Context) -> list[Declared]:
    """What each language declares, worked out once a run."""
    if ctx.declared is None:
        icd = _sound(ctx)
        ctx.declared = []
        for one in ctx.languages if icd.nodes else ():
            identifiers = list(one.identifiers(icd))
            texts = Counter(map(_TEXT, identifiers))
            ctx.declared.append(Declared(one.name, one.reserved, identifiers, texts))
    return ctx.declared


def _sound(ctx: Context) -> Icd:
    """The model without fields that have errors, and without the second of two equal names."""
    errors = ((code, f) for code, f in ctx.raised if REGISTERED[code].severity == "error")
    bad = {id(f.owner) for code, f in errors if not ctx.accepts(code, f)}
    twins = {id(f.owner) for code, f in ctx.raised if code in TWINS}

    def is_bad(field: Field) -> bool:
        return id(field.source) in bad or (field.type == "enum" and not field.enum)

    wrong = {id(s) for s, _ in ctx.structs if id(s.source) in bad | twins or any(map(is_bad, (*s.fields, *s.members)))}

    def sound(message: Message) -> Message:
        members = {id(m.source) for m in message.members if m.struct is not None and id(m.source) in bad}
        kept = tuple(
            f
            for f in message.fields
            if not is_bad(f)
            and not any(id(s.struct) in wrong or (s.member and id(s.member.source) in members) for s in f.path)
        )
        return message if len(kept) == len(message.fields) else message.with_fields(kept)

    def sound_node(node: Node) -> Node:
        messages = tuple(sound(m) for m in node.messages if id(m.source) not in twins)
        structs = tuple(one for one in node.structs if id(one) not in wrong)
        enums = tuple({e.name: e for e in node.enums}.values())  # fields refer to the last of a name
        includes = tuple(name for name in node.includes if name != node.name)
        if (messages, structs, enums, includes) == (node.messages, node.structs, node.enums, node.includes):
            return node
        return replace(node, messages=messages, structs=structs, enums=enums, includes=includes)

    first = {n.name: n for n in reversed(ctx.icd.nodes)}
    nodes = tuple(sound_node(node) for node in ctx.icd.nodes if first[node.name] is node)
    # What is described of a sound model for its names is described for its code too.
    return ctx.icd if all(map(is_, nodes, ctx.icd.nodes)) and len(nodes) == len(ctx.icd.nodes) else Icd(nodes)
