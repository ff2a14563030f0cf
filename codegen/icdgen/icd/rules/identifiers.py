"""Names after mapping: what generated code would declare, in every language at once."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, filterfalse

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.identifiers import Identifier
from icdgen.icd.located import Map
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.declarations import TWINS, declared
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, listing, quote


def _place(ctx: Context, identifier: Identifier) -> Place:
    """The name that the identifier was made from."""
    source = identifier.source
    if source is None:
        return ctx.icd.nodes[0].source.place
    if isinstance(source.get("node"), Map):
        source = source["node"]  # a node is known by its whole file
    return source.at(next((key for key in ("identifier", "name", "symbol") if key in source), ""))


def _help(identifier: Identifier) -> str:
    if identifier.source is not None and "node" in identifier.source:
        return "give the node another name"
    another = "another" if identifier.source and "identifier" in identifier.source else "an"
    return f"give it {another} `identifier:`, words to build the name from"


class _Clashes:
    """Joins what several languages say of the same things into one finding."""

    def __init__(self) -> None:
        self.found: dict[tuple[int, ...], tuple[Identifier, Identifier | None, dict[str, list[str]]]] = {}

    def add(self, language: str, one: Identifier, other: Identifier | None = None) -> None:
        """``other`` is what ``one`` clashes with. The first of several names that a language makes of it is kept."""
        key = tuple(sorted((id(i.source) if i.source is not None else hash(i.owner)) for i in (one, other) if i))
        texts = self.found.setdefault(key, (one, other, {}))[2]
        if not any(language in languages for languages in texts.values()):
            texts.setdefault(one.text, []).append(language)

    def __iter__(self) -> Iterator[tuple[Identifier, Identifier | None, dict[str, list[str]]]]:
        yield from self.found.values()


@rule("ICD070")
def not_reserved(ctx: Context) -> Iterator[Fault]:
    found = _Clashes()
    for names in declared(ctx):
        for one in names.spelled(names.reserved.intersection(names.texts)):
            found.add(names.language, one)
    for one, _, texts in found:
        words = " and ".join(
            f"{quote(text)}, a {'header' if _is_file(text) else 'reserved word'} in {listing(langs)}"
            for text, langs in texts.items()
        )
        yield Fault(one.source, _place(ctx, one), f"{one.owner} becomes {words}", _help(one))


@rule("ICD071")
def no_clash(ctx: Context) -> Iterator[Fault]:
    reported = {id(fault.owner) for code, fault in ctx.raised if code in TWINS}
    found = _Clashes()
    for names in declared(ctx):
        seen: dict[tuple[str, str], Identifier] = {}
        for one in names.spelled({text for text, times in names.texts.items() if times > 1}):
            first = seen.setdefault((one.scope, one.text), one)
            if first is one or (first.source is None and one.source is None):
                continue
            if not (reported and reported & {id(first.source), id(one.source)}):
                found.add(names.language, one, first)
    for one, other, texts in found:
        if other is None:
            continue
        if other.source is not None and (one.source is None or _place(ctx, other) > _place(ctx, one)):
            one, other = other, one
        place = _place(ctx, one)
        there = f" ({line_of(_place(ctx, other), place)})" if other.source is not None else ""
        words = listing(f"{quote(text)} in {listing(langs)}" for text, langs in texts.items())
        message = f"{one.owner} and {other.owner}{there} both become {words}"
        yield Fault(one.source, place, message, "give one of them an `identifier:`, words to build the name from")


def _is_name(text: str) -> bool:
    text = text.removeprefix("r#")  # which makes a name of a keyword of Rust
    return (text.isidentifier() and text.isascii()) or _is_file(text)


def _is_file(text: str) -> bool:
    """Backends also declare the files that they write, so that two of one name are found."""
    return "." in text or "/" in text


@rule("ICD072")
def is_identifier(ctx: Context) -> Iterator[Fault]:
    found = _Clashes()
    for names in declared(ctx):
        odd = chain(filterfalse(str.isidentifier, names.texts), filterfalse(str.isascii, names.texts))
        for one in names.spelled(set(filterfalse(_is_name, odd))):
            found.add(names.language, one)
    for one, _, texts in found:
        each = ((quote(text) if text else "nothing", listing(langs)) for text, langs in texts.items())
        becomes = listing(f"{what} in {languages}" for what, languages in each)
        message = f"{one.owner} becomes {becomes}, which is not a valid name"
        yield Fault(one.source, _place(ctx, one), message, _help(one))
