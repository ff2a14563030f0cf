"""Rules about names and types in generated code of structs.

Changes of their bytes are reported for the messages that contain them.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from icdgen.backends.c.types import declaration
from icdgen.diff.changes.names import renamed_lines
from icdgen.diff.context import ComparisonContext
from icdgen.diff.generated import Name, NamesOfIcd, symbols_in
from icdgen.diff.pairs import MessagePair, NodePair
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.wording import bits
from icdgen.frozen import NamedTuple
from icdgen.icd.lines import Line
from icdgen.icd.model import Message, Node
from icdgen.icd.places import places_in
from icdgen.wording import count, quote


class _Declared(NamedTuple):
    """Declarations in generated code of a struct."""

    # Bit position of a member -> its names; -1: names of the struct
    names: dict[int, list[Name]]
    members: dict[str, str]  # name -> declaration in C


_NOTHING = _Declared({}, {})


@rule("DIF127", "message")
def structs_repeated_otherwise(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    reported = set()
    for part in pair.common:
        was, now = (_repeated(line, part.is_open) for line in (part.old, part.new))
        name = ".".join(level.node.name for level in part.new.levels[:-1])
        if was is None or now is None or was == now or name in reported:
            continue
        reported.add(name)
        before, after = _in_words(was), _in_words(now)
        places = [
            line.levels[-2].node.source.at("struct") for line in (part.old, part.new)
        ]
        text = f"{quote(name)} is {after}, was {before}"
        yield CheckResult(
            text, (), before, after, where=part.where(), places=(places[0], places[1])
        )


def _repeated(line: Line, is_open: bool) -> tuple[tuple[int, int], ...] | None:
    """Return count and stride of each level of structs around a field; None outside of
    structs.

    The count of a variable-length part is 0; rule DIF119 reports its changes.
    """
    if not line.is_of_struct:
        return None
    levels = [(level.count, level.stride) for level in line.levels[:-1]]
    return ((0, levels[0][1]), *levels[1:]) if is_open else tuple(levels)


def _in_words(repeated: tuple[tuple[int, int], ...]) -> str:
    """Return the repetition as text: ``4 structs, one every 3 bytes``."""
    return ", in each of them ".join(_level_text(*level) for level in repeated)


def _level_text(times: int, stride: int) -> str:
    """Return the repetition of one level of structs as text."""
    if not stride:
        return "a struct"
    structs = count(times, "struct") if times else "structs"
    return f"{structs}, one every {bits(stride)}"


@rule("DIF313", "node")
def struct_declared_otherwise(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    # Computing all names takes long, and most ICDs have no structs.
    if not pair.old.structs and not pair.new.structs:
        return
    old, new = (
        {struct.name: struct for struct in node.structs}
        for node in (pair.old, pair.new)
    )
    was = _declared(ctx.generated.before, pair.old)
    now = _declared(ctx.generated.after, pair.new)
    for name in dict.fromkeys((*new, *old)):
        before, after = was.get(name, _NOTHING), now.get(name, _NOTHING)
        renamed = list(_renamed(before.names, after.names))
        retyped = [
            (declaration_before, after.members[member])
            for member, declaration_before in before.members.items()
            if after.members.get(member, declaration_before) != declaration_before
        ]
        if not renamed and not retyped:
            continue
        if name not in new:
            what = "is gone"
        elif name not in old:
            what = "is new"
        else:
            what = "has other generated names or types"
        breaks = retyped or any(old_name for old_name, _ in renamed)
        places = [
            structs[name].source.at("name") if name in structs else None
            for structs in (old, new)
        ]
        yield CheckResult(
            f"the struct {quote(name)} {what}",
            ("name", "identifier"),
            name if name in old else "",
            name if name in new else "",
            (
                *renamed_lines(renamed),
                *(
                    f"C: `{old_declaration}` -> `{new_declaration}`"
                    for old_declaration, new_declaration in retyped
                ),
            ),
            severity=None if breaks else "note",
            addition=None if breaks else True,
            places=(places[0], places[1]),
        )


def _renamed(
    before: dict[int, list[Name]], after: dict[int, list[Name]]
) -> Iterator[tuple[Name | None, Name | None]]:
    """Yield removed names, each with the added name of the same member, and the
    remaining added names.
    """
    unchanged = set(chain(*before.values())) & set(chain(*after.values()))
    for at in sorted(before.keys() | after.keys()):
        removed, added = (
            [name for name in names.get(at, ()) if name not in unchanged]
            for names in (before, after)
        )
        if len(removed) == len(added):
            yield from zip(removed, added, strict=True)
        else:
            yield from ((name, None) for name in removed)
            yield from ((None, name) for name in added)


def _declared(names: NamesOfIcd, node: Node) -> dict[str, _Declared]:
    """Return the declarations of the structs of a node by name."""
    declared: dict[str, _Declared] = {}
    for struct in map(names.description.struct, node.structs):
        fields = struct.model.layout.fixed
        symbols = [
            (-1, names.symbols(struct)),
            *((field.at, symbols_in(struct, struct, field)) for field in fields),
        ]
        rows: dict[int, dict[Name, None]] = {}
        for at, symbols_of_part in symbols:
            for language, identifier in symbols_of_part:
                if identifier.text.isidentifier() and not identifier.text.endswith(
                    "_H"
                ):
                    rows.setdefault(at, {})[Name(language, identifier.text)] = None
        members = {member.name: declaration(member) for member in struct.members}
        declared[struct.model.name] = _Declared(
            {at: list(row) for at, row in rows.items()}, members
        )
    return declared


@rule("DIF314", "message")
def struct_stands_otherwise(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    was, now = (list(_uses_of_structs(side)) for side in (pair.old, pair.new))
    removed = [text for text in was if text not in now]
    added = [text for text in now if text not in was]
    if not removed and not added:
        return
    number, what = len(removed or added), "declared otherwise" if removed else "new"
    text = f"{count(number, 'struct')} in {quote(pair.new.name)} {'is' if number == 1 else 'are'} {what}"
    details = [f"`{text}` is gone" for text in removed] + [
        f"`{text}` is new" for text in added
    ]
    severity, addition = (None, None) if removed else ("note", True)
    yield CheckResult(
        text,
        ("fields",),
        ", ".join(removed),
        ", ".join(added),
        tuple(details),
        severity,
        addition,
    )


def _uses_of_structs(message: Message) -> Iterator[str]:
    """Yield a line for each struct in a message: ``Satellites: 4 x Satellite``."""
    for place in places_in(message.layout):
        if place.struct is not None:
            times = f"{place.count} x " if place.count else ""
            yield f"{place.identifier or place.name}: {times}{place.struct.name}"
