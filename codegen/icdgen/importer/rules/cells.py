"""Roles of the rows of a table: what columns, lines of a cell and melted columns say.

Rows under their headings go in (`rows`). `RoleReader.read` returns `Roles` for each
row or line: the texts that patterns of the rule take, by role.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from icdgen.importer.document import SourceTable
from icdgen.importer.rules.language import (
    TEXT_ROLES,
    VALUE_ROLES,
    Pattern,
    normalised,
    take,
    whole_number,
)
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import DataRow, one_line
from icdgen.importer.rules.rule import ColumnRule, TableRule


@dataclass
class Roles:
    """Roles of a field or of a row, with their row.

    ``members``: values and names as printed.
    """

    given: dict[str, str]
    row: DataRow
    members: list[tuple[str, str]] = field(default_factory=list)
    byte_shift: int = 0  # bytes to add: the byte of a row whose bits are melted columns

    def get(self, role: str) -> str:
        """Return the text of a role, or an empty text."""
        return self.given.get(role, "")


class RoleReader:
    """Reader of the roles of the rows of one table.

    ``words`` are all words of the document. ``empty`` are texts that mean no value.
    """

    def __init__(
        self,
        rule: TableRule,
        table: SourceTable,
        titles: list[str],
        words: frozenset[str],
        empty: frozenset[str],
        notes: Notes,
    ) -> None:
        self.rule, self.table, self.titles, self.words = rule, table, titles, words
        self.empty, self.notes = empty, notes

    def read(self, rows: list[DataRow]) -> list[Roles]:
        """Return the roles of every field of the table, in order, corrections included."""
        rule = self.rule
        columns = self.columns(rows)
        fields: list[Roles] = []
        for row in rows:
            given = self.translated(row.roles)
            self.read_columns(row, given, columns)
            if rule.melt is not None:
                fields += self.melted(row, given, rule.melt)
            elif rule.lines:
                fields += self.from_lines(row, given)
            else:
                fields.append(Roles(given, row))
        # Roles of the rule have the lowest precedence, corrections (`set`) the highest.
        for roles in fields:
            roles.given = {**rule.each, **roles.given}
            for correction in rule.corrections:
                if all(
                    pattern.search(roles.get(role))
                    for role, pattern in correction.where.items()
                ):
                    roles.given.update(correction.roles)
                    self.notes.used_corrections.add(correction.place)
        return fields

    def translated(self, given: dict[str, str]) -> dict[str, str]:
        """Return the roles, with words in `map` replaced by their meanings."""
        return {
            role: self.rule.map.get(role, {}).get(text.casefold(), text)
            for role, text in given.items()
        }

    def read_columns(
        self,
        row: DataRow,
        given: dict[str, str],
        columns: list[tuple[ColumnRule, list[str]]],
    ) -> None:
        """Add the roles of the columns to ``given``; report columns that give one role
        different texts.
        """
        # The column that gave each role.
        sources: dict[str, str] = {}
        for column, names in columns:
            text = "".join(one_line(row, name, self.words) for name in names)
            taken = self.taken(row, names[0], column.patterns, text)
            for role in taken:
                if role in sources and given[role] != taken[role] and role != "text":
                    self.notes.error(
                        "IMP102",
                        f"{self.table.title}: the columns `{sources[role]}` and `{column.key}` both give the role "
                        f"`{role}`: `{given[role][:40]}` and `{taken[role][:40]}`",
                        self.table.spot_of(row.source),
                        f"join them by `{sources[role]} + {column.key}`, give one another role, or put it under `ignore:`",
                        column.place,
                        example=f"{given[role][:40]} | {taken[role][:40]}",
                    )
                sources[role] = column.key
            _add(given, taken)

    def columns(self, rows: list[DataRow]) -> list[tuple[ColumnRule, list[str]]]:
        """Return the entries of `columns` with their headings; report missing columns
        and columns without a role.
        """
        rule, table, titles = self.rule, self.table, self.titles
        entries: list[tuple[ColumnRule, list[str]]] = []
        used: set[str] = set()
        shown = ", ".join(f"`{title}`" for title in titles if title)
        for column in (*rule.columns, *rule.lines):
            # `*` stands for the melted columns.
            if column.key == "*":
                continue
            names = find_columns(column, titles)
            used |= set(names)
            if not names and not column.is_optional:
                self.notes.error(
                    "IMP102",
                    f"{table.title}: it has no column `{column.key}` of rule `{rule.name}`",
                    table.spot,
                    f"its columns are {shown}; `{column.key}?` makes it optional",
                    column.place,
                )
            elif names and column in rule.columns:
                entries.append((column, names))
        for key in (*rule.keep, *rule.join, *rule.fill, *rule.glue):
            if key not in titles:
                self.notes.error(
                    "IMP102",
                    f"{table.title}: it has no column `{key}` of rule `{rule.name}`",
                    table.spot,
                    f"its columns are {shown}",
                    rule.place,
                )
        used |= {*rule.keep, *rule.ignore}
        ignored = [key[1:] for key in rule.ignore if key.startswith("~")]
        for title in dict.fromkeys(title for row in rows for title in row.values):
            is_melted = (
                rule.melt is not None
                and title in titles
                and take([rule.melt], title) is not None
            )
            if (
                title in used
                or is_melted
                or any(re.search(pattern, title, re.I) for pattern in ignored)
            ):
                continue
            filled = [
                normalised(row.values.get(title, ""))
                for row in rows
                if row.values.get(title, "").strip()
            ]
            if filled:
                more = f" and {len(filled) - 1} more" if len(filled) > 1 else ""
                self.notes.error(
                    "IMP102",
                    f"{table.title}: rule `{rule.name}` gives the column `{title}` no role: `{filled[0][:40]}`{more}",
                    table.spot,
                    "give it a role under `columns:`, or name it under `ignore:`",
                    rule.place,
                )
        return entries

    def taken(
        self, row: DataRow, name: str, patterns: tuple[Pattern, ...], text: str
    ) -> dict[str, str]:
        """Return the translated roles of one text.

        Report a text that matches no pattern, and text that a pattern does not cover.
        """
        is_name = any("name" in pattern.roles for pattern in patterns)
        # A dash may be the name of reserved bits.
        if not text or (text.casefold() in self.empty and not is_name):
            return {}
        where = f"{self.table.title}, column `{name}`"
        spot, place = self.table.spot_of(row.source), patterns[0].place
        taken = take(patterns, text)
        if taken is None:
            self.notes.error(
                "IMP103",
                f"{where}: no pattern of rule `{self.rule.name}` takes `{text[:80]}`",
                spot,
                "add a pattern for it, or drop the row with `skip`",
                place,
                example=text,
            )
            return {}
        if taken.left:
            self.notes.warn(
                "IMP104",
                f"{where}: a pattern of rule `{self.rule.name}` leaves `{taken.left[:60]}` of `{text[:80]}`",
                spot,
                "let the pattern take it, for instance as `{text}`",
                place,
                example=text,
            )
        if taken.listed:
            self.notes.error(
                "IMP105",
                f"{where}: `{taken.listed}` lists two places that are not consecutive, and a pattern of rule "
                f"`{self.rule.name}` takes it for a range",
                spot,
                "write a row for each place in the table file (--tables), or take the whole list as one role: "
                "`{bit:[0-9, ]+}`",
                place,
                example=text,
            )
            return {}
        return self.translated(taken.roles)

    def melted(
        self, row: DataRow, given: dict[str, str], melt: Pattern
    ) -> Iterator[Roles]:
        """A field for each cell below headings that number bits or bytes; a cell over
        several of them has their range.
        """
        titles = self.titles
        if row.is_short:
            self.notes.error(
                "IMP103",
                f"{self.table.title}: the row `{row.text[:80]}` has fewer cells than there are columns, and the file does "
                "not state which columns they cover",
                self.table.spot_of(row.source),
                "give the cells their spans in the table file (--tables)",
                melt.place,
            )
            return
        star = next(column for column in self.rule.columns if column.key == "*")
        shift = whole_number(given.get("byte", "0"), self.rule.base) or 0
        # The byte of the row is added to the bytes of the headings (`byte_shift`).
        shared = {role: text for role, text in given.items() if role != "byte"}
        for title in titles:
            text = one_line(row, title, self.words)
            if take([melt], title) is None or not text or title not in row.ranges:
                continue
            first, last = row.ranges[title]
            covered = titles[first : last + 1]
            ends = [
                numbers.roles
                for t in covered
                if (numbers := take([melt], t)) is not None
            ]
            if len(ends) < len(covered):
                other = next(t for t in covered if take([melt], t) is None)
                self.notes.error(
                    "IMP103",
                    f"{self.table.title}: the cell `{text[:60]}` covers the column `{other}`, whose heading `melt` does "
                    "not take",
                    self.table.spot_of(row.source),
                    "correct the heading in the table file, or the pattern",
                    melt.place,
                )
                continue
            position = {}
            for role in ("byte", "bit"):
                texts = [
                    end.get(key, "") for end in ends for key in (role, f"last_{role}")
                ]
                positions = [
                    n for printed in texts if (n := whole_number(printed)) is not None
                ]
                if positions:
                    position[role], position[f"last_{role}"] = (
                        str(min(positions)),
                        str(max(positions)),
                    )
            roles = {**shared, **self.translated(position)}
            _add(roles, self.taken(row, title, star.patterns, text))
            yield Roles(roles, row, byte_shift=shift)

    def from_lines(self, row: DataRow, given: dict[str, str]) -> list[Roles]:
        """A field for each line of a cell that names one.

        A line with a position only is the position of the lines below it; one with a
        value and a member belongs to the field above; one with a text only is prose.
        """
        row_roles = Roles(dict(given), row)
        fields: list[Roles] = []
        position: dict[str, str] = {}
        for column in self.rule.lines:
            for name in find_columns(column, list(row.values)):
                for line in map(normalised, row.values[name].split("\n")):
                    roles = self.taken(row, name, column.patterns, line)
                    if not roles or set(roles) == {"text"}:
                        continue
                    if "member" in roles:
                        owner = fields[-1] if fields else row_roles
                        owner.members.append((roles.get("value", ""), roles["member"]))
                    elif "name" not in roles:
                        position = roles
                    else:
                        # A line with a byte of its own ends the position of the lines
                        # above.
                        position = {} if "byte" in roles else position
                        self.check_line(row, column, name, line, roles, given)
                        outer = {
                            role: text
                            for role, text in given.items()
                            if role not in ("bytes", "bits")
                        }
                        field_roles = {**outer, **position}
                        _add(field_roles, roles)
                        fields.append(Roles(field_roles, row))
        return fields or [row_roles]

    def check_line(
        self,
        row: DataRow,
        column: ColumnRule,
        name: str,
        line: str,
        roles: dict[str, str],
        given: dict[str, str],
    ) -> None:
        """Report roles that a line and another column of its row give; positions of
        lines lie within that of the row.
        """
        for role in (
            role
            for role in roles
            if role in VALUE_ROLES | TEXT_ROLES and role != "text"
        ):
            if given.get(role, roles[role]) != roles[role]:
                self.notes.error(
                    "IMP102",
                    f"{self.table.title}, column `{name}`: the line `{line[:60]}` gives the role `{role}`, and so does "
                    f"another column of the row: `{given[role][:40]}`",
                    self.table.spot_of(row.source),
                    "give the other column another role, or put it under `ignore:`",
                    column.place,
                    example=line,
                )


def _add(given: dict[str, str], further: dict[str, str]) -> None:
    """Add the roles of a further cell of the row; descriptions from several cells are
    joined.
    """
    texts = [text for roles in (given, further) if (text := roles.get("text"))]
    given.update(further)
    if texts:
        given["text"] = "; ".join(texts)


def find_columns(column: ColumnRule, titles: list[str]) -> list[str]:
    """Return the headings of the columns of an entry of `columns`, or none if one is
    missing.
    """
    names = []
    for key in column.titles:
        if key.startswith("~"):
            name = next(
                (
                    title
                    for title in titles
                    if title and re.search(key[1:], title, re.I)
                ),
                None,
            )
        else:
            wanted = normalised(key).casefold()
            name = next((title for title in titles if title.casefold() == wanted), None)
            # After the headings: a heading can be a number itself, such as that of a
            # bit.
            if name is None and key.isdigit() and 0 < int(key) <= len(titles):
                name = titles[int(key) - 1] or f"column {key}"
        if name is None:
            return []
        names.append(name)
    return names
