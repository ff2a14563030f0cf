"""Identifiers of generated code: reserved words, clashes and invalid names, in all
languages at once.

`declarations` lists the identifiers of the languages that the context has. ICD070
reports reserved words, ICD071 clashes in one scope, ICD072 names that are no
identifiers. A line of the ICD has many identifiers in each language, so `_Clashes`
joins their faults to one finding. Files that a backend writes are identifiers, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, filterfalse

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.identifiers import Identifier
from icdgen.icd.located import Map
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.declarations import DUPLICATE_NAMES, declared_identifiers
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.wording import listing, quote


def _place(ctx: Context, identifier: Identifier) -> Place:
    """Return the place of the name that an identifier is made from."""
    source = identifier.source
    if source is None:
        return ctx.icd.nodes[0].source.place
    # The source of a node is its complete file.
    if isinstance(source.get("node"), Map):
        source = source["node"]
    return source.at(
        next((key for key in ("identifier", "name", "symbol") if key in source), "")
    )


def _help(identifier: Identifier) -> str:
    """Return the help for a name that gives no usable identifier."""
    if identifier.source is not None and "node" in identifier.source:
        return "give the node another name"
    another = (
        "another" if identifier.source and "identifier" in identifier.source else "an"
    )
    return f"give it {another} `identifier:`, other words from which its names in all languages are built"


class _Clashes:
    """Faults of identifiers, joined so that each line of the ICD has one finding for
    all languages.
    """

    def __init__(self) -> None:
        # Each value has an identifier, the other identifier of a clash, and the
        # languages by the text of the identifier.
        self.entries: dict[
            tuple[int, ...], tuple[Identifier, Identifier | None, dict[str, list[str]]]
        ] = {}

    def add(
        self, language: str, identifier: Identifier, other: Identifier | None = None
    ) -> None:
        """Add a fault in a language; ``other`` is the identifier of a clash.

        Only the first text per language is stored.
        """
        identifiers = (identifier, other) if other else (identifier,)
        # Sorted, because two languages can list the same two lines in different order.
        # Names that come from no line, such as those of the runtime, are identified by
        # their owner.
        key = tuple(
            sorted(
                id(each.source) if each.source is not None else hash(each.owner)
                for each in identifiers
            )
        )
        texts = self.entries.setdefault(key, (identifier, other, {}))[2]
        # One line gives many identifiers per language, such as getter, setter and
        # constant. If one clashes, usually all of them do.
        if not any(language in languages for languages in texts.values()):
            texts.setdefault(identifier.text, []).append(language)

    def __iter__(
        self,
    ) -> Iterator[tuple[Identifier, Identifier | None, dict[str, list[str]]]]:
        yield from self.entries.values()


@rule("ICD070")
def names_are_not_reserved(ctx: Context) -> Iterator[Fault]:
    clashes = _Clashes()
    for names in declared_identifiers(ctx):
        for identifier in names.spelled(names.reserved.intersection(names.texts)):
            clashes.add(names.language, identifier)
    for identifier, _, texts in clashes:
        words = " and ".join(
            f"{quote(text)}, a {'header' if _is_file(text) else 'reserved word'} in "
            f"{listing(languages)}"
            for text, languages in texts.items()
        )
        message = f"{identifier.owner} becomes {words}"
        yield Fault(
            identifier.source, _place(ctx, identifier), message, _help(identifier)
        )


@rule("ICD071")
def identifiers_do_not_clash(ctx: Context) -> Iterator[Fault]:
    reported = {
        id(fault.owner) for code, fault in ctx.raised if code in DUPLICATE_NAMES
    }
    clashes = _Clashes()
    for names in declared_identifiers(ctx):
        seen: dict[tuple[str, str], Identifier] = {}
        for identifier in names.spelled(
            {text for text, times in names.texts.items() if times > 1}
        ):
            first = seen.setdefault((identifier.scope, identifier.text), identifier)
            if first is identifier or (
                # Two names of the generator itself, which no change of the ICD can
                # separate.
                first.source is None and identifier.source is None
            ):
                continue
            # Lines with equal names have a finding of their own, which explains the
            # clash.
            if not (reported and reported & {id(first.source), id(identifier.source)}):
                clashes.add(names.language, identifier, first)
    for identifier, other, texts in clashes:
        if other is None:
            continue
        # Report the clash at the later line; generated names without a line have no
        # place.
        is_earlier = other.source is not None and (
            identifier.source is None or _place(ctx, other) > _place(ctx, identifier)
        )
        later, earlier = (other, identifier) if is_earlier else (identifier, other)
        place = _place(ctx, later)
        line = (
            f" ({line_of(_place(ctx, earlier), place)})"
            if earlier.source is not None
            else ""
        )
        words = listing(
            f"{quote(text)} in {listing(languages)}"
            for text, languages in texts.items()
        )
        message = f"{later.owner} and {earlier.owner}{line} both become {words}"
        yield Fault(
            later.source,
            place,
            message,
            "give one of them an `identifier:`, other words from which its names in all languages are built",
        )


def _is_name(text: str) -> bool:
    """Return whether a text is an ASCII identifier or the name of a file."""
    text = text.removeprefix("r#")  # a raw identifier of Rust, such as `r#type`
    return (text.isidentifier() and text.isascii()) or _is_file(text)


def _is_file(text: str) -> bool:
    """Return whether a name is a file: backends also declare the files that they write,
    so that clashes are reported.
    """
    return "." in text or "/" in text


@rule("ICD072")
def names_give_identifiers(ctx: Context) -> Iterator[Fault]:
    clashes = _Clashes()
    for names in declared_identifiers(ctx):
        # Two passes of C functions over hundreds of thousands of texts; the few that
        # remain are checked in Python.
        suspects = chain(
            filterfalse(str.isidentifier, names.texts),
            filterfalse(str.isascii, names.texts),
        )
        for identifier in names.spelled(set(filterfalse(_is_name, suspects))):
            clashes.add(names.language, identifier)
    for identifier, _, texts in clashes:
        quoted = (
            (quote(text) if text else "nothing", listing(languages))
            for text, languages in texts.items()
        )
        becomes = listing(f"{text} in {languages}" for text, languages in quoted)
        message = f"{identifier.owner} becomes {becomes}, which is not a valid name"
        yield Fault(
            identifier.source, _place(ctx, identifier), message, _help(identifier)
        )
