"""Names and types that generated code has for structs. What their bytes mean is said of the messages in which they stand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

from icdgen.backends.c.types import declaration
from icdgen.describe import describe
from icdgen.diff.changes.names import lines
from icdgen.diff.context import Context
from icdgen.diff.generated import LANGUAGES, Name, SourceMarks
from icdgen.diff.pairs import MessagePair, NodePair
from icdgen.diff.rule import Found, rule
from icdgen.diff.wording import bits
from icdgen.icd.layout import Layout
from icdgen.icd.layout_copies import with_attributes, with_node, with_struct_layout
from icdgen.icd.lines import Line
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import places_in
from icdgen.icd.rules.wording import count, quote


class _Declared(NamedTuple):
    """What generated code declares for a struct."""

    names: dict[int, list[Name]]  # of the member that begins at the bit; of the struct itself at -1
    members: dict[str, str]  # name -> declaration in C


_NOTHING = _Declared({}, {})


@rule("DIF127", "message")
def structs_repeated_otherwise(pair: MessagePair, ctx: Context) -> Iterator[Found]:
    reported = set()
    for part in pair.common:
        was, now = (_repeated(line, part.is_open) for line in (part.old, part.new))
        name = ".".join(level.node.name for level in part.new.levels[:-1])
        if was is None or now is None or was == now or name in reported:
            continue
        reported.add(name)
        before, after = _in_words(was), _in_words(now)
        places = [line.levels[-2].node.source.at("struct") for line in (part.old, part.new)]
        text = f"{quote(name)} is {after}, was {before}"
        yield Found(text, (), before, after, where=part.where(), places=(places[0], places[1]))


def _repeated(line: Line, is_open: bool) -> tuple[tuple[int, int], ...] | None:
    """How often the structs stand in which a field is (0 of an open end: see DIF119), and how far apart; None if it is in none."""
    if not line.is_of_struct:
        return None
    levels = [(level.count, level.stride) for level in line.levels[:-1]]
    return ((0, levels[0][1]), *levels[1:]) if is_open else tuple(levels)


def _in_words(repeated: tuple[tuple[int, int], ...]) -> str:
    """``4 structs, one every 3 bytes``"""
    texts = [
        f"{count(times, 'struct') if times else 'structs'}, one every {bits(stride)}" if stride else "a struct"
        for times, stride in repeated
    ]
    return ", in each of them ".join(texts)


@rule("DIF313", "node")
def struct_declared_otherwise(pair: NodePair, ctx: Context) -> Iterator[Found]:
    if not pair.old.structs and not pair.new.structs:
        return
    old, new = ({struct.name: struct for struct in node.structs} for node in (pair.old, pair.new))
    was, now = _declared(ctx.match.old, pair.old), _declared(ctx.match.new, pair.new)
    for name in dict.fromkeys((*new, *old)):
        before, after = was.get(name, _NOTHING), now.get(name, _NOTHING)
        renamed = list(_renamed(before.names, after.names))
        both = before.members.keys() & after.members.keys()
        retyped = [(before.members[member], after.members[member]) for member in before.members if member in both]
        retyped = [(before, after) for before, after in retyped if before != after]
        if not renamed and not retyped:
            continue
        what = "is gone" if name not in new else "is new" if name not in old else "has other generated names or types"
        breaks = retyped or any(old_name for old_name, _ in renamed)
        places = [structs[name].source.at("name") if name in structs else None for structs in (old, new)]
        yield Found(
            f"the struct {quote(name)} {what}",
            ("name", "identifier"),
            name if name in old else "",
            name if name in new else "",
            (*lines(renamed), *(f"C: `{one}` -> `{other}`" for one, other in retyped)),
            severity=None if breaks else "note",
            addition=None if breaks else True,
            places=(places[0], places[1]),
        )


def _renamed(before: dict[int, list[Name]], after: dict[int, list[Name]]) -> Iterator[tuple[Name | None, Name | None]]:
    """Names that are gone, each with the one that has come in its place, and new ones."""
    kept = set(chain(*before.values())) & set(chain(*after.values()))
    for at in sorted(before.keys() | after.keys()):
        gone, come = ([name for name in names.get(at, ()) if name not in kept] for names in (before, after))
        if len(gone) == len(come):
            yield from zip(gone, come, strict=True)
        else:
            yield from ((name, None) for name in gone)
            yield from ((None, name) for name in come)


def _declared(icd: Icd, node: Node) -> dict[str, _Declared]:
    """By the name of each struct of a node."""
    marks = SourceMarks[tuple[str, int]]()  # name of the struct, and bit of the member
    layouts: list[tuple[Layout, Layout]] = (
        []
    )  # each with its copy that has sources of its own: an ICD from elsewhere has none
    structs = []
    for struct in node.structs:  # each stands after those that it has in it
        layout = struct.layout
        for line in layout.fixed:
            marked = with_attributes(line, source=marks.of((struct.name, line.at)))
            layout = with_node(layout, line, marked)
        for other, changed in layouts:
            layout = with_struct_layout(layout, other, changed)
        layouts.append((struct.layout, layout))
        structs.append(replace(struct, layout=layout, source=marks.of((struct.name, -1))))
    alone = replace(node, structs=tuple(structs), messages=())
    around = Icd((*(replace(included, messages=()) for included in icd.included(node)), alone))
    declared = {struct.name: _Declared({}, {}) for struct in alone.structs}
    for language in LANGUAGES:
        for (name, at), identifier in marks.names(around, language):
            if identifier.text.isidentifier() and not identifier.text.endswith("_H"):
                declared[name].names.setdefault(at, []).append(Name(language, identifier.text))
    for struct in around.nodes[-1].structs:
        described = describe(around).struct(struct).members
        declared[struct.name].members.update((member.name, declaration(member)) for member in described)
    return declared


@rule("DIF314", "message")
def struct_stands_otherwise(pair: MessagePair, ctx: Context) -> Iterator[Found]:
    was, now = (list(_standing(side)) for side in (pair.old, pair.new))
    gone, come = [text for text in was if text not in now], [text for text in now if text not in was]
    if not gone and not come:
        return
    number, what = len(gone or come), "declared otherwise" if gone else "new"
    text = f"{count(number, 'struct')} in {quote(pair.new.name)} {'is' if number == 1 else 'are'} {what}"
    details = [f"`{text}` is gone" for text in gone] + [f"`{text}` is new" for text in come]
    severity, addition = (None, None) if gone else ("note", True)
    yield Found(text, ("fields",), ", ".join(gone), ", ".join(come), tuple(details), severity, addition)


def _standing(message: Message) -> Iterator[str]:
    """``Satellites: 4 x Satellite``, for each struct in a message."""
    for place in places_in(message.layout):
        if place.struct is not None:
            times = f"{place.count} x " if place.count else ""
            yield f"{place.identifier or place.name}: {times}{place.struct.name}"
