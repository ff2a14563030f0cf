"""Identifiers that languages declare for a model, without identifiers that originate
from ICD lines with errors.

`declared_identifiers` returns a `LanguageIdentifiers` for each language of the context.
It leaves out fields for which an earlier rule reported an error, and nodes, messages
and structs with a duplicate name: the user will change these lines anyway. The module
has no rules; `identifiers` has them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Set
from operator import attrgetter

from icdgen.frozen import NamedTuple
from icdgen.icd.identifiers import Identifier
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED

# Rules about names that occur twice.
DUPLICATE_NAMES = frozenset(
    {"ICD050", "ICD051", "ICD052", "ICD053", "ICD054", "ICD057", "ICD049"}
)

_TEXT = attrgetter("text")


class LanguageIdentifiers(NamedTuple):
    """Identifiers that one language declares.

    There can be hundreds of thousands, so rules select some by text.
    """

    language: str  # title
    reserved: frozenset[str]
    identifiers: list[Identifier]
    texts: Counter[str]  # number of identifiers per text, in all scopes together

    def spelled(self, texts: Set[str]) -> list[Identifier]:
        """Return the identifiers that have one of these texts."""
        return (
            [identifier for identifier in self.identifiers if identifier.text in texts]
            if texts
            else []
        )


def declared_identifiers(ctx: Context) -> list[LanguageIdentifiers]:
    """Return the identifiers that each language declares; computed once for all rules."""
    if ctx.declared is None:
        left_out = _left_out(ctx)
        ctx.declared = []
        for language in ctx.languages if ctx.icd.nodes else ():
            identifiers = [
                symbol
                for symbol in language.identifiers(ctx.icd)
                if id(symbol.source) not in left_out
            ]
            texts = Counter(map(_TEXT, identifiers))
            ctx.declared.append(
                LanguageIdentifiers(
                    language.title, language.reserved, identifiers, texts
                )
            )
    return ctx.declared


def _left_out(ctx: Context) -> set[int]:
    """Return the id() of the mappings whose names are not compared.

    These are fields with an error of their own, and nodes, messages and structs that
    have the name of an earlier one, with all that they declare: the user will change
    these lines anyway.
    """
    errors = (
        (code, fault)
        for code, fault in ctx.raised
        if REGISTERED[code].severity == "error"
    )
    faulty = {id(fault.owner) for code, fault in errors if not ctx.accepts(code, fault)}
    duplicates = {
        id(fault.owner) for code, fault in ctx.raised if code in DUPLICATE_NAMES
    }
    # Reversed, so that the first node of a name remains.
    first = {node.name: node for node in reversed(ctx.icd.nodes)}
    left_out = {
        id(node.source) for node in ctx.icd.nodes if first[node.name] is not node
    }
    for owner, icd_node in ctx.owners:
        # Derived values are among the nodes, because accessors are named after them.
        fields = {id(node.source) for node in owner.layout.nodes}
        if id(owner.source) in duplicates or first[icd_node.name] is not icd_node:
            left_out |= {id(owner.source), *fields}
        else:
            left_out |= fields & faulty
    return left_out
