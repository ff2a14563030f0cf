"""Rows -> roles: what the columns, the lines of a cell, or melted columns of a row say."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from icdgen.importer.document import SourceTable
from icdgen.importer.rules.language import Pattern, normalised, take, whole_number
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import DataRow, one_line
from icdgen.importer.rules.rule import Column, Rule


@dataclass
class Roles:
    """The roles of a field, or of a row that is none, with the row they come from. ``members``: value and name as printed."""

    given: dict[str, str]
    row: DataRow
    members: list[tuple[str, str]] = field(default_factory=list)
    byte_shift: int = 0  # bytes to add: the byte of a row whose bits are melted columns

    def get(self, role: str) -> str:
        """The text of a role; empty if nothing gives it."""
        return self.given.get(role, "")


def read_roles(
    rule: Rule, table: SourceTable, titles: list[str], rows: list[DataRow], known: frozenset[str], notes: Notes
) -> list[Roles]:
    """Return the roles of every field of the table, in order, corrections included."""
    columns = _columns(rule, table, titles, rows, notes)
    made: list[Roles] = []
    for row in rows:
        given = _translated(rule, row.roles)
        for column, names in columns:
            text = " ".join(filter(None, (one_line(row, name, known) for name in names)))
            if len(names) > 1:
                text = "".join(one_line(row, name, known) for name in names)
            _add(given, _taken(rule, table, row, names[0], column.patterns, text, notes))
        if rule.melt is not None:
            made += _melted(rule, table, titles, row, given, known, notes)
        elif rule.lines:
            made += _from_lines(rule, table, row, given, notes)
        else:
            made.append(Roles(given, row))
    for roles in made:
        roles.given = {**rule.each, **roles.given}
        for correction in rule.corrections:
            if all(pattern.search(roles.get(role)) for role, pattern in correction.where.items()):
                roles.given.update(correction.roles)
                notes.used_corrections.add(correction.place)
    return made


def _translated(rule: Rule, given: dict[str, str]) -> dict[str, str]:
    """The roles, the words that `map` names replaced by their meanings."""
    return {role: rule.map.get(role, {}).get(text.casefold(), text) for role, text in given.items()}


def _add(given: dict[str, str], further: dict[str, str]) -> None:
    """Add the roles of a further cell of the row; descriptions from several cells are joined."""
    texts = [text for roles in (given, further) if (text := roles.get("text"))]
    given.update(further)
    if texts:
        given["text"] = "; ".join(texts)


def find_columns(column: Column, titles: list[str]) -> list[str]:
    """The headings of the table that an entry of `columns` is about; empty if one of them is missing."""
    made = []
    for key in column.titles:
        if key.startswith("~"):
            name = next((title for title in titles if title and re.search(key[1:], title, re.I)), None)
        else:
            wanted = normalised(key).casefold()
            name = next((title for title in titles if title.casefold() == wanted), None)
            if name is None and key.isdigit() and 0 < int(key) <= len(titles):
                name = titles[int(key) - 1] or f"column {key}"
        if name is None:
            return []
        made.append(name)
    return made


def _columns(
    rule: Rule, table: SourceTable, titles: list[str], rows: list[DataRow], notes: Notes
) -> list[tuple[Column, list[str]]]:
    """The entries of `columns` with the headings of the table; reports those it lacks and those that no entry names."""
    made: list[tuple[Column, list[str]]] = []
    used: set[str] = set()
    shown = ", ".join(f"`{title}`" for title in titles if title)
    for column in (*rule.columns, *rule.lines):
        if column.key == "*":
            continue
        names = find_columns(column, titles)
        used |= set(names)
        if not names and not column.is_optional:
            notes.error(
                "IMP102",
                f"{table.title}: it has no column `{column.key}` of rule `{rule.name}`",
                table.spot,
                f"its columns are {shown}; `{column.key}?` makes it optional",
                column.place,
            )
        elif names and column in rule.columns:
            made.append((column, names))
    for key in (*rule.keep, *rule.join, *rule.fill, *rule.glue):
        if key not in titles:
            notes.error(
                "IMP102",
                f"{table.title}: it has no column `{key}` of rule `{rule.name}`",
                table.spot,
                f"its columns are {shown}",
                rule.place,
            )
    used |= {*rule.keep, *rule.ignore}
    ignored = [key[1:] for key in rule.ignore if key.startswith("~")]
    for title in dict.fromkeys(title for row in rows for title in row.values):
        is_melted = rule.melt is not None and title in titles and take([rule.melt], title) is not None
        if title in used or is_melted or any(re.search(pattern, title, re.I) for pattern in ignored):
            continue
        filled = [normalised(row.values.get(title, "")) for row in rows if row.values.get(title, "").strip()]
        if filled:
            more = f" and {len(filled) - 1} more" if len(filled) > 1 else ""
            notes.error(
                "IMP102",
                f"{table.title}: rule `{rule.name}` gives the column `{title}` no role: `{filled[0][:40]}`{more}",
                table.spot,
                "give it a role under `columns:`, or name it under `ignore:`",
                rule.place,
            )
    return made


def _taken(
    rule: Rule, table: SourceTable, row: DataRow, name: str, patterns: tuple[Pattern, ...], text: str, notes: Notes
) -> dict[str, str]:
    """The translated roles of one text; reports a text that no pattern takes, and what a pattern leaves of it."""
    if not text:
        return {}
    taken = take(patterns, text)
    if taken is None:
        notes.error(
            "IMP103",
            f"{table.title}, column `{name}`: no pattern of rule `{rule.name}` takes `{text[:80]}`",
            table.spot_of(row.source),
            "add a pattern for it, or drop the row with `skip`",
            patterns[0].place,
        )
        return {}
    if taken.left:
        notes.warn(
            "IMP104",
            f"{table.title}, column `{name}`: a pattern of rule `{rule.name}` leaves `{taken.left[:60]}` of "
            f"`{text[:80]}`",
            table.spot_of(row.source),
            "let the pattern take it, for instance as `{text}`",
            patterns[0].place,
        )
    return _translated(rule, taken.roles)


def _melted(
    rule: Rule,
    table: SourceTable,
    titles: list[str],
    row: DataRow,
    given: dict[str, str],
    known: frozenset[str],
    notes: Notes,
) -> Iterator[Roles]:
    """A field for each cell below headings that number bits or bytes; a cell over several of them has their range."""
    assert rule.melt is not None
    if row.is_short:
        notes.error(
            "IMP103",
            f"{table.title}: the row `{row.text[:80]}` has fewer cells than there are columns, and the file does not state "
            "which columns they cover",
            table.spot_of(row.source),
            "give the cells their spans in the table file (--tables)",
            rule.melt.place,
        )
        return
    star = next(column for column in rule.columns if column.key == "*")
    shift = whole_number(given.get("byte", "0"), rule.base) or 0
    shared = {role: text for role, text in given.items() if role != "byte"}
    for title in titles:
        numbers = take([rule.melt], title)
        text = one_line(row, title, known)
        if numbers is None or not text or title not in row.ranges:
            continue
        first, last = row.ranges[title]
        covered = titles[first : last + 1]
        ends = [numbers.roles for t in covered if (numbers := take([rule.melt], t)) is not None]
        if len(ends) < len(covered):
            other = next(t for t in covered if take([rule.melt], t) is None)
            notes.error(
                "IMP103",
                f"{table.title}: the cell `{text[:60]}` covers the column `{other}`, whose heading `melt` does not take",
                table.spot_of(row.source),
                "correct the heading in the table file, or the pattern",
                rule.melt.place,
            )
            continue
        position = {}
        for role in ("byte", "bit"):
            found = [
                n for end in ends for key in (role, f"last_{role}") if (n := whole_number(end.get(key, ""))) is not None
            ]
            if found:
                position[role], position[f"last_{role}"] = str(min(found)), str(max(found))
        roles = {**shared, **_translated(rule, position)}
        _add(roles, _taken(rule, table, row, title, star.patterns, text, notes))
        yield Roles(roles, row, byte_shift=shift)


def _from_lines(rule: Rule, table: SourceTable, row: DataRow, given: dict[str, str], notes: Notes) -> list[Roles]:
    """A field for each line of a cell that names one.

    A line with a position only is the position of the lines below it; one with a value and a member belongs to the field
    above; one with a text only is prose.
    """
    whole = Roles(dict(given), row)
    made: list[Roles] = []
    position: dict[str, str] = {}
    for column in rule.lines:
        for name in find_columns(column, list(row.values)):
            for line in map(normalised, row.values[name].split("\n")):
                roles = _taken(rule, table, row, name, column.patterns, line, notes)
                if not roles or set(roles) == {"text"}:
                    continue
                if "member" in roles:
                    (made[-1] if made else whole).members.append((roles.get("value", ""), roles["member"]))
                elif "name" not in roles:
                    position = roles
                else:
                    position = {} if "byte" in roles else position
                    outer = {role: text for role, text in given.items() if role not in ("bytes", "bits")}
                    field_roles = {**outer, **position}
                    _add(field_roles, roles)
                    made.append(Roles(field_roles, row))
    return made or [whole]
