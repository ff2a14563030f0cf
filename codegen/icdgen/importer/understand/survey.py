"""A document -> everything that its tables say, each table classified."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

from icdgen.icd.model import CONFIGURATION
from icdgen.importer.document import Document, Heading, Spot, Table, Text, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import around, grids, lists, messages
from icdgen.importer.understand.around import Around, Said, kind_of
from icdgen.importer.understand.model import ReadEnum, ReadList, ReadLog, ReadMessage, Thing
from icdgen.importer.words import BY_HAND, grows

BACKGROUND, UNKNOWN = "background", "not understood"
T = TypeVar("T", ReadEnum, ReadList, ReadLog, ReadMessage)
NEAR = 4  # lines of prose above a table that may speak of it


@dataclass(slots=True)
class Found:
    """What a table is and says, and where in the document's order it stands."""

    table: Table
    what: str  # "message" | "enumeration" | "list" | "loggable frames" | BACKGROUND | UNKNOWN
    thing: Thing | None


@dataclass(slots=True)
class Survey:
    """All tables of a document in order."""

    found: list[Found] = field(default_factory=list)
    troubles: list[Trouble] = field(default_factory=list)

    def of(self, kind: type[T]) -> list[tuple[Found, T]]:
        """The tables that gave a thing of this class, each with it."""
        return [(one, one.thing) for one in self.found if isinstance(one.thing, kind)]


def survey(document: Document, profile: Profile) -> Survey:
    """Reads every table of the document."""
    made = Survey(troubles=list(document.troubles))
    run, last = 1, -1
    sections: list[Heading] = []
    prose: list[str] = []
    used: set[str] = set()  # headings whose id a table has
    bare: list[Heading] = []  # those of the sections in which no table has come yet
    for block in document.blocks:
        if isinstance(block, Heading):
            _without_table(made, sections, [one for one in bare if not one.contains(block)], profile)
            bare = [one for one in bare if one.contains(block)] + [block]
            sections = [s for s in sections if s.contains(block)] + [block]
            prose = []
        elif isinstance(block, Text):
            prose = [block.text, *prose][:NEAR]
        if not isinstance(block, Table):
            continue
        bare = []
        if block.number is not None:
            run += block.number <= last
            last = block.number
        block.run = run
        titles = tuple(s.text for s in sections)
        block.section = titles[-1] if titles else next((text for text in prose if len(text) < 60), "")
        inner = [title for title in reversed(titles) if title not in used]
        about = Around(block.caption, prose, inner if inner and inner[0] == titles[-1] else [])
        what, thing = classify(block, profile, made.troubles, titles, about)
        if what == UNKNOWN and (grid := grids.find(block, profile)):
            registers = grids.read(*grid, block, profile, about, made.troubles)
            for register in registers:
                register.kind = register.kind or _by_section(titles, profile) or str(profile.data["defaults"]["kind"])
            made.found += [Found(block, "message", one) for one in registers[:-1]]
            what, thing = ("message", registers[-1]) if registers else (what, thing)
        prose = []
        if isinstance(thing, ReadMessage) and titles:
            used.add(titles[-1])
        if what == UNKNOWN and block.number is None and not _is_grid(block):
            continue  # a figure, a listing, a box: nobody called it a table
        made.found.append(Found(block, what, thing))
        if what == UNKNOWN and not _is_repeated(block, made):
            made.troubles.append(_not_understood(block, around.read(about, profile)))
    _without_table(made, sections, bare, profile)
    return made


def classify(
    table: Table, profile: Profile, troubles: list[Trouble], sections: tuple[str, ...], about: Around | None = None
) -> tuple[str, Thing | None]:
    """What the table is, and what it says."""
    if any(pattern.search(table.caption) for pattern in profile.background):
        return BACKGROUND, None
    kind = table.header.kind if table.header else ""
    if kind in ("", "fields"):
        message = messages.read(table, profile, troubles, about)
        if message is None:
            return UNKNOWN, None
        if not message.kind:
            message.kind = _by_section(sections, profile) or str(profile.data["defaults"]["kind"])
        return "message", message
    if kind == "enumeration":
        read = lists.enumeration(table, profile, troubles)
        return ("enumeration", read) if read else (UNKNOWN, None)
    if kind == "list":
        return "list", lists.listing(table, profile, troubles)
    return "loggable frames", lists.log(table, troubles)


def _is_repeated(table: Table, made: Survey) -> bool:
    """Whether rows without headings are the repeated block of the message before, which then cannot be held."""
    messages = made.of(ReadMessage)
    cells = [cell for row in table.all_rows[:1] for cell in row.cells]
    figure = next((cell for cell in cells if grows(cell)), "")
    if not figure or not messages:
        return False
    messages[-1][1].lacks = f"its rows from `{figure}` on depend on a count, which import does not read: {BY_HAND}"
    return True


def _is_grid(table: Table) -> bool:
    """Whether something without a caption is a table for all that: two rows or more of two cells or more."""
    rows = [row for row in table.all_rows if sum(map(bool, row.cells)) > 1]
    return len(rows) + (table.header is not None) > 1


def _by_section(sections: tuple[str, ...], profile: Profile) -> str:
    return next((kind for title in reversed(sections) if (kind := kind_of(title, profile))), "")


def _without_table(made: Survey, sections: list[Heading], bare: list[Heading], profile: Profile) -> None:
    """Says of headings of sections without a table that they give a message's name and id, if they do."""
    for heading in bare:
        said = around.read(Around(headings=[heading.text]), profile)
        titles = tuple(s.text for s in sections[: sections.index(heading) + 1])
        kind = said.kind or _by_section(titles, profile) or profile.data["defaults"]["kind"]
        if not (said.ids and said.name and kind):
            continue
        ids = f"set_id: {said.id}, get_id: {said.id}" if kind == CONFIGURATION else f"id: {said.id}"
        made.troubles.append(Trouble(
            "IMP039", f"the heading `{heading.text[:80]}` names a message, and no table follows; it was left out",
            Spot(heading.page, heading.line),
            f"if it is one without fields, add it to the ICD: `{{name: {said.name}, {ids}, kind: {kind}, length: 0}}`",
        ))  # fmt: skip


def _not_understood(table: Table, said: Said) -> Trouble:
    """That nobody knows what a table is; where an id stands above it, a message is missing."""
    shown = next((row.shown for row in table.all_rows if any(row.cells)), "")
    begins = f"; it begins with `{shown[:100]}`" if shown else ""
    id = f", though what stands above it gives the id {' '.join(said.ids)}" if said.ids else ""
    return Trouble(
        "IMP030", f"{table.title}: none of the tables that icdgen knows{id}{begins}", table.spot,
        "if it describes a message or an enumeration add its headings to the profile, else name it under `background:`",
        "error" if id else "note" if table.number is None else "warning",
    )  # fmt: skip
