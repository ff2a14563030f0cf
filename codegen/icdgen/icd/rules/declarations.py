"""Identifiers that languages declare for a model, without the parts of the model that have errors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Set
from dataclasses import replace
from operator import attrgetter, is_
from typing import NamedTuple

from icdgen.icd.identifiers import Identifier
from icdgen.icd.layout import LayoutNode, scalar_of, struct_layout_of
from icdgen.icd.layout_copies import without_nodes
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED

# Rules about names that occur twice.
DUPLICATE_NAMES = frozenset({"ICD050", "ICD051", "ICD052", "ICD053", "ICD054", "ICD057", "ICD049"})

_TEXT = attrgetter("text")


class Declared(NamedTuple):
    """Identifiers that one language declares. There can be hundreds of thousands, so rules select some by text."""

    language: str
    reserved: frozenset[str]
    identifiers: list[Identifier]
    texts: Counter[str]  # number of identifiers per text, in all scopes together

    def spelled(self, texts: Set[str]) -> list[Identifier]:
        """Return the identifiers that have one of these texts."""
        return [identifier for identifier in self.identifiers if identifier.text in texts] if texts else []


def declared(ctx: Context) -> list[Declared]:
    """Return the identifiers that each language declares; computed once for all rules."""
    if ctx.declared is None:
        icd = _sound_icd(ctx)
        ctx.declared = []
        for language in ctx.languages if icd.nodes else ():
            identifiers = list(language.identifiers(icd))
            texts = Counter(map(_TEXT, identifiers))
            ctx.declared.append(Declared(language.name, language.reserved, identifiers, texts))
    return ctx.declared


def _sound_icd(ctx: Context) -> Icd:
    """Return the ICDs without fields that have errors, and without the second of two equal names."""
    errors = ((code, fault) for code, fault in ctx.raised if REGISTERED[code].severity == "error")
    bad = {id(fault.owner) for code, fault in errors if not ctx.accepts(code, fault)}
    duplicates = {id(fault.owner) for code, fault in ctx.raised if code in DUPLICATE_NAMES}
    bad_layouts: set[int] = set()  # id() of layouts of structs

    def is_bad(node: LayoutNode) -> bool:
        scalar = scalar_of(node)
        lacks_enum = scalar is not None and scalar.type == "enum" and scalar.enum is None
        return id(node.source) in bad or lacks_enum or id(struct_layout_of(node)) in bad_layouts

    # Each struct comes after the structs that it contains.
    for struct, _ in ctx.structs:
        if id(struct.source) in bad | duplicates or any(map(is_bad, struct.layout.nodes)):
            bad_layouts.add(id(struct.layout))

    def sound_message(message: Message) -> Message:
        layout = without_nodes(message.layout, is_bad)
        return message if layout is message.layout else replace(message, layout=layout)

    def sound_node(node: Node) -> Node:
        messages = tuple(sound_message(message) for message in node.messages if id(message.source) not in duplicates)
        sound_structs = tuple(struct for struct in node.structs if id(struct.layout) not in bad_layouts)
        # Fields refer to the last enumeration of a name.
        enums = tuple({enum.name: enum for enum in node.enums}.values())
        includes = tuple(name for name in node.includes if name != node.name)
        if (messages, sound_structs, enums, includes) == (node.messages, node.structs, node.enums, node.includes):
            return node
        return replace(node, messages=messages, structs=sound_structs, enums=enums, includes=includes)

    first = {node.name: node for node in reversed(ctx.icd.nodes)}
    nodes = tuple(sound_node(node) for node in ctx.icd.nodes if first[node.name] is node)
    # If nothing was removed, return the same object: descriptions are cached per ICD,
    # and the backends reuse them.
    return ctx.icd if all(map(is_, nodes, ctx.icd.nodes)) and len(nodes) == len(ctx.icd.nodes) else Icd(nodes)
