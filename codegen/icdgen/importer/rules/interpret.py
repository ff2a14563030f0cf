"""Application of the rules of a profile to the tables of a document.

Tables and a profile go in, messages, enumerations, lists and findings come out. Nothing
here guesses: a table without a rule gives nothing. The steps for one table, in order:
`selection` chooses its rules, `rows` arranges its cells under their headings, `cells`
gives them roles, and `fields` makes fields of the roles. When all tables are read,
`build` makes messages of their parts.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import SourceTable
from icdgen.importer.model import (
    BACKGROUND,
    UNKNOWN,
    ReadField,
    ReadMessage,
    Survey,
    TableResult,
)
from icdgen.importer.profile import Profile
from icdgen.importer.rules import attach, build, lists
from icdgen.importer.rules.bit_order import Order
from icdgen.importer.rules.cells import RoleReader, Roles
from icdgen.importer.rules.fields import FieldReader
from icdgen.importer.rules.language import (
    MESSAGE_ROLES,
    Pattern,
    cell_text,
    normalised,
    take,
    whole_number,
)
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart
from icdgen.importer.rules.rows import read_rows
from icdgen.importer.rules.rule import TableRule
from icdgen.importer.rules.selection import (
    Choice,
    choose,
    heading_rows,
    texts_of_rows,
    why_not,
)
from icdgen.importer.source_tables import (
    count_runs,
    group_by_headings,
    texts_in_and_around,
)
from icdgen.wording import count

_IDS = ("id", "set_id", "get_id")
_HEX = re.compile(r"\b(?:0[xX][0-9A-Fa-f]+|[0-9A-Fa-f]*[0-9][0-9A-Fa-f]*[hH])\b")


@dataclass
class Interpretation:
    """Result of applying the rules of a profile to the tables of a document."""

    choices: list[Choice]
    parts: list[TablePart]
    survey: Survey
    # Number of the table -> roles that texts around it give.
    attributes: dict[int, dict[str, str]]
    rules: list[TableRule]


def interpret(
    tables: list[SourceTable],
    profile: Profile,
    extra: list[ImportFinding] | None = None,
) -> Interpretation:
    """Apply the rules of ``profile`` to the tables; ``extra`` are findings of the
    reader of the source.
    """
    return _Interpreter(tables, profile).interpret(extra or [])


class _Interpreter:
    def __init__(self, tables: list[SourceTable], profile: Profile) -> None:
        self.tables, self.profile = tables, profile
        self.notes = Notes()
        self.parts: list[TablePart] = []
        self.attributes: dict[int, dict[str, str]] = {}
        self.list_results: list[TableResult] = []
        # A word that a cell breaks at a hyphen is joined if it stands elsewhere in the
        # document.
        document_words: set[str] = set()
        for table in tables:
            for text in texts_in_and_around(table):
                document_words.update(word.strip(".,;:()[]") for word in text.split())
        self.document_words = frozenset(document_words)
        self.order = Order(*profile.orders)

    def interpret(self, extra: list[ImportFinding]) -> Interpretation:
        count_runs(self.tables)
        choices = choose(self.profile.rules, self.tables)
        for choice in choices:
            for rule in choice.rules:
                if rule.what != "ignore":
                    self.read_table(rule, choice.table)
        self.check_use(choices)
        results = build.MessageBuilder(
            self.profile, self.order, self.notes
        ).build_results(self.parts)
        attach.check_index(
            [part for part in self.parts if part.rule.what == "index"],
            results,
            self.notes,
        )
        self.check_orders(results)
        self.notes.finish(self.profile.rules)
        survey = Survey(import_findings=[*extra, *self.notes.import_findings])
        results_by_table: dict[int, list[TableResult]] = {}
        for result in [*self.list_results, *results]:
            results_by_table.setdefault(result.table.number, []).append(result)
        for choice in choices:
            table = choice.table
            if table.number in results_by_table:
                survey.results += results_by_table[table.number]
                continue
            what = choice.rules[-1].what if choice.rules else UNKNOWN
            if what == "ignore":
                what = BACKGROUND
            survey.results.append(TableResult(table, what, None))
        self.report_unread(choices, survey)
        self.report_without_table(choices, survey)
        return Interpretation(
            choices, self.parts, survey, self.attributes, self.profile.rules
        )

    # One table.

    def read_table(self, rule: TableRule, table: SourceTable) -> None:
        """Add the parts that a rule reads from a table."""
        titles, rows = read_rows(rule, table, self.notes)
        if not rule.columns and not rule.lines:
            rows = []  # the table describes a message without parameters
        given = self.roles_around(rule, table)
        self.attributes[table.number] = given
        role_reader = RoleReader(
            rule, table, titles, self.document_words, self.profile.empty, self.notes
        )
        if rule.what in ("list", "loggable"):
            listed = role_reader.read(rows)
            is_list = rule.what == "list"
            self.list_results.append(
                lists.list_of(rule, table, given, listed, self.notes)
                if is_list
                else lists.log_of(rule, table, listed, self.notes)
            )
            return
        message = {role: text for role, text in given.items() if role in MESSAGE_ROLES}
        shared = {
            role: text for role, text in given.items() if role not in MESSAGE_ROLES
        }
        reader = FieldReader(rule, table, self.profile, self.order, self.notes)
        parts: dict[tuple[str, ...], TablePart] = {}
        of_message = set(MESSAGE_ROLES)
        if rule.what in ("message", "registers", "bits"):
            of_message.remove("enumeration")  # the name of the enumeration of a field
        for roles in role_reader.read(rows):
            # Tables of messages have rows that name a message only: it has no fields.
            is_field = not set(roles.given) <= of_message | set(rule.each)
            roles.given = {**shared, **roles.given}
            own = {
                role: roles.given.pop(role)
                for role in list(roles.given)
                if role in of_message
            }
            key = tuple(
                own.get(role, "")
                for role in ("message", "id", "set_id", "get_id", "of", "enumeration")
            )
            part = parts.setdefault(key, TablePart(rule, table, dict(message)))
            self.check_rows_agree(part, own)
            part.given.update(own)
            part.stated_in_rows.update(own)
            if is_field or not own or rule.what not in ("message", "registers"):
                # Otherwise the row is a message without fields.
                self.add_row(part, roles, reader)
        if (
            not parts
            and {"message", "id", "set_id"} & set(message)
            and rule.what in ("message", "registers")
        ):
            parts[()] = TablePart(rule, table, message)  # without parameters
        self.parts += parts.values()

    def check_rows_agree(self, part: TablePart, own: dict[str, str]) -> None:
        """Report a row that gives a message another kind or length than an earlier row
        of the table.
        """
        for role in ("kind", "length"):
            earlier = part.stated_in_rows.get(role, "")
            if (
                earlier
                and own.get(role)
                and not _is_equal(part.rule, role, earlier, own[role])
            ):
                self.report_disagreement(
                    part.rule,
                    part.where,
                    part.table.spot,
                    role,
                    f"`{earlier}` and `{own[role]}` in its rows",
                )

    def report_disagreement(
        self, rule: TableRule, where: str, spot: SourcePlace, role: str, values: str
    ) -> None:
        """Report two values of a role of one message."""
        self.notes.error(
            "IMP110",
            f"{where}: rule `{rule.name}` reads two values of `{role}`: {values}",
            spot,
            "correct the pattern that reads something else, or, if the document contradicts itself, correct the table "
            "with `--tables`",
            rule.place,
        )

    def add_row(self, part: TablePart, roles: Roles, reader: FieldReader) -> None:
        """Add what one row gives."""
        what = part.rule.what
        if what == "index":
            return
        if what in ("enumeration", "lookup"):
            name = roles.get("member") if what == "enumeration" else roles.get("points")
            spot = part.table.spot_of(roles.row.source)
            value = whole_number(roles.get("value").replace(" ", ""), part.rule.base)
            if value is None or not name:
                self.notes.error(
                    "IMP023",
                    f"{part.table.title}: the row `{roles.row.text[:80]}` gives no value and "
                    f"{'name' if what == 'enumeration' else 'point'}",
                    spot,
                    "give columns the roles `value` and "
                    + ("`member`" if what == "enumeration" else "`points`"),
                    part.rule.place,
                )
            else:
                part.pairs.append((value, name))
                part.texts.append(roles.get("text"))
            return
        if not part.rule.has_fields and what in ("message", "registers"):
            return
        part.drafts += reader.read(roles)

    def roles_around(self, rule: TableRule, table: SourceTable) -> dict[str, str]:
        """Return the roles that the rule states, or that texts around the table and its
        rows contain.

        The nearest text has precedence.
        """
        # What the rule states itself has precedence.
        given = dict(rule.literals)
        sources: dict[str, str] = {}  # role -> source that gave it; literals have none
        missing: list[tuple[str, Pattern]] = []
        for source, patterns in rule.sources.items():
            for pattern in patterns:
                taken = next(
                    (
                        t
                        for text in self.texts_of_source(rule, table, source)
                        if (t := take([pattern], text))
                    ),
                    None,
                )
                if taken is None:
                    missing.append((source, pattern))
                    continue
                self.check_sources_agree(
                    rule, table, source, taken.roles, given, sources
                )
                new = {
                    role: value
                    for role, value in taken.roles.items()
                    if role not in given
                }
                if new:
                    self.check_notation_of_id(rule, table, taken.roles, taken.left)
                given.update(new)
                sources.update(dict.fromkeys(new, source))
        for source, pattern in missing:
            if source not in rule.optional and not pattern.roles <= set(given):
                self.notes.error(
                    "IMP103",
                    f"{table.title}: no text of `{source}` matches `{pattern.text[:60]}` of rule `{rule.name}`",
                    table.spot,
                    f"correct the pattern; `{source}?` makes it optional",
                    pattern.place,
                )
        for role, words in rule.map.items():
            if (meaning := words.get(given.get(role, "").casefold())) is not None:
                given[role] = meaning
        return given

    def check_sources_agree(
        self,
        rule: TableRule,
        table: SourceTable,
        source: str,
        roles: dict[str, str],
        given: dict[str, str],
        sources: dict[str, str],
    ) -> None:
        """Report a source that gives a message another id, kind or length than the
        source that is used.

        Patterns of one source are alternatives. Names are not compared: a caption and a
        heading often have two names.
        """
        for role, value in roles.items():
            used = sources.get(role, source)
            if (
                role in (*_IDS, "kind", "length")
                and used != source
                and not _is_equal(rule, role, given[role], value)
            ):
                values = f"`{given[role]}` in its {used}, `{value}` in its {source}"
                self.report_disagreement(rule, table.title, table.spot, role, values)

    def texts_of_source(
        self, rule: TableRule, table: SourceTable, source: str
    ) -> list[str]:
        """Return the texts of a source, the nearest first.

        For rows, these are each row, then the rows above the headings as one text.
        """
        if source == "row":
            words = self.document_words
            cells = (
                [cell_text(c.text, words) for c in row.cells] for row in table.rows
            )
            texts = [" | ".join(filter(None, row)) for row in cells]
            head = heading_rows(rule, texts_of_rows(table, rule.transpose))
            texts.append(
                " | ".join(filter(None, texts[: head.start] if head else texts))
            )
        else:
            texts = {
                "caption": [table.caption],
                "heading": table.headings[::-1],
                # In the order of the page, so the last text is the nearest.
                "before": table.before[::-1],
                "sheet": [table.sheet],
            }[source]
        return [normalised(text) for text in texts]

    def check_notation_of_id(
        self, rule: TableRule, table: SourceTable, roles: dict[str, str], left: str
    ) -> None:
        """Report an id that is a plain number where the same text has a hexadecimal
        one.
        """
        # `6.1 Motor state (0x21)`: a pattern that is not anchored takes the number of
        # the chapter for the id.
        other = _HEX.search(left)
        if "id" in roles and other and not _HEX.fullmatch(roles["id"]):
            self.notes.warn(
                "IMP104",
                f"{table.title}: rule `{rule.name}` takes the id `{roles['id']}`, and the same text has "
                f"`{other.group()}`",
                table.spot,
                "write the words before the id into the pattern",
                rule.place,
            )

    # All tables.

    def check_use(self, choices: list[Choice]) -> None:
        """Report rules and corrections that have no effect."""
        used = {rule.name for choice in choices for rule in choice.rules}
        for rule in self.profile.rules:
            if rule.name in used:
                continue
            taken = [c for c in choices if c.rules and not why_not(rule, c.table)]
            why = f"; {len(taken)} tables go to rules before it" if taken else ""
            self.notes.error(
                "IMP101",
                f"rule `{rule.name}` applies to no table{why}",
                SourcePlace(),
                "`--explain TABLE` shows which condition fails, `--explore` lists the kinds of tables",
                rule.place,
            )
        for rule in self.profile.rules:
            for correction in rule.corrections:
                if (
                    rule.name in used
                    and correction.place not in self.notes.used_corrections
                ):
                    where = ", ".join(
                        f"{role}: {pattern.pattern}"
                        for role, pattern in correction.where.items()
                    )
                    self.notes.error(
                        "IMP101",
                        f"`set` of rule `{rule.name}` matches no row: {where}",
                        SourcePlace(),
                        "correct `where:`, or remove the entry",
                        correction.place,
                    )

    def check_orders(self, results: list[TableResult]) -> None:
        """Report fields whose bits depend on a byte or bit order that the profile does
        not state.
        """
        numbers: list[ReadField] = []
        for result in results:
            if isinstance(result.content, ReadMessage):
                numbers += [
                    field
                    for field in result.content.all_fields
                    if field.type in ("uint", "int", "enum", "float", "bool")
                ]
        dependent = {
            "byte_order": (
                "several bytes",
                [f for f in numbers if f.at % 8 + f.bits > 8],
                "`big` or `little`",
            ),
            "bit_order": (
                "a part of a byte",
                [f for f in numbers if f.at % 8 or f.bits % 8],
                "`lsb0` if bit 0 is the least significant bit of a byte, else `msb0`",
            ),
        }
        for key, (size, affected, values) in dependent.items():
            if affected and not self.profile.states_order(key):
                further = (
                    f" and {count(len(affected) - 1, 'more field')}"
                    if affected[1:]
                    else ""
                )
                self.notes.error(
                    "IMP109",
                    f"the profile does not state `{key}`, on which `{affected[0].name}`{further} of {size} depend"
                    f"{'' if further else 's'}; read with `{key}: {getattr(self.order, key)}`",
                    # The finding is about the profile and not about one table.
                    affected[0].spot._replace(order=None, table=None),
                    f"look for it in the document and state it under `node:` of the profile: {values}",
                )

    def report_unread(self, choices: list[Choice], survey: Survey) -> None:
        """List the tables without a rule by kind, and what rules ignore."""
        unread = {c.table.number for c in choices if not c.rules}
        for group in group_by_headings(self.tables):
            tables = [table for table in group if table.number in unread]
            if not tables:
                continue
            numbers = ", ".join(str(table.number) for table in tables[:8]) + (
                " ..." if len(tables) > 8 else ""
            )
            titles = " | ".join(tables[0].titles)[:80]
            survey.import_findings.append(
                ImportFinding(
                    "IMP100",
                    f"no rule applies to {'table' if len(tables) == 1 else 'tables'} {numbers} with the headings "
                    f"`{titles}`",
                    tables[0].spot,
                    "write a rule, or let one with `what: ignore` name them",
                )
            )
        for rule in self.profile.rules:
            tables = [c.table for c in choices if rule in c.rules]
            if rule.what == "ignore" and tables:
                shown = ", ".join(
                    dict.fromkeys(
                        f"`{' | '.join(table.titles)[:40]}`" for table in tables[:30]
                    )
                )
                survey.import_findings.append(
                    ImportFinding(
                        "IMP108",
                        f"rule `{rule.name}` ignores {count(len(tables), 'table')}: {shown[:300]}",
                        SourcePlace(),
                        "make sure that none describes a message",
                        "note",
                        place=rule.place,
                    )
                )

    def report_without_table(self, choices: list[Choice], survey: Survey) -> None:
        """Report texts that give the id of a message by the pattern of a rule, if no
        table gives a message with this id.
        """
        ids_with_table = {part.number(role) for part in self.parts for role in _IDS}
        used = {rule.name for choice in choices for rule in choice.rules}
        rules = [
            rule
            for rule in self.profile.rules
            if rule.name in used and rule.what in ("message", "registers")
        ]
        patterns = []
        for rule in rules:
            for source in ("heading", "before"):
                for pattern in rule.sources.get(source, ()):
                    if pattern.roles & set(_IDS):
                        patterns.append((rule, pattern))
        for table in self.tables:
            for text in map(normalised, (*table.before, *table.after)):
                for rule, pattern in patterns:
                    taken = take([pattern], text)
                    if taken is None:
                        continue
                    ids = {
                        whole_number(taken.roles[role], rule.base)
                        for role in _IDS
                        if role in taken.roles
                    }
                    if not ids - {None} or ids & ids_with_table:
                        continue
                    survey.import_findings.append(
                        ImportFinding(
                            "IMP039",
                            f"`{text[:80]}` gives the id of a message, and no table below it was read as one",
                            table.spot,
                            "add a message without fields to the ICD by hand; if it has a table, `--tables` shows what was found",
                            place=pattern.place,
                        )
                    )
                    # One finding per id, although several texts can name it.
                    ids_with_table |= ids


def _is_equal(rule: TableRule, role: str, first: str, second: str) -> bool:
    """Return whether two texts give a role the same value: the same number, or words
    with one meaning.
    """
    if role == "kind":
        words = rule.map.get(role, {})
        return words.get(first.casefold(), first) == words.get(
            second.casefold(), second
        )
    numbers = whole_number(first, rule.base), whole_number(second, rule.base)
    return numbers[0] == numbers[1] if None not in numbers else first == second
