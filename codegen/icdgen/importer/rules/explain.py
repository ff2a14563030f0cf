"""Report of how a table was read (`icdgen import FILE --explain TABLE`).

It lists the conditions of each rule, the roles of the columns, the parts that were
read, and the findings.
"""

from __future__ import annotations

from icdgen.import_results.findings import ImportFinding
from icdgen.importer.document import SourceTable
from icdgen.importer.rules.cells import find_columns
from icdgen.importer.rules.interpret import Interpretation
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart
from icdgen.importer.rules.rows import read_rows
from icdgen.importer.rules.rule import TableRule
from icdgen.wording import count

SHOWN = 60  # characters of a cell


def explain(interpretation: Interpretation, number: int) -> str:
    """Return the explanation of a table: every rule that was tried, texts and columns
    with their roles, fields, findings.
    """
    choice = next(
        choice for choice in interpretation.choices if choice.table.number == number
    )
    table = choice.table
    place = f", {table.spot.place}" if table.spot.place else ""
    lines = [
        f"{table.title}{place}: {count(len(table.rows), 'row')}, {count(table.width, 'column')}"
    ]
    lines += [f"  caption: {table.caption}"] if table.caption else []
    lines += [f"  heading: {heading}" for heading in table.headings]
    lines += [f"  before:  {text[: 2 * SHOWN]}" for text in table.before[-5:]]
    lines.append(f"  headings of columns: {' | '.join(table.titles)}")
    lines += [
        f"  rule `{rule.name}` ({rule.place.line}) does not apply: {reason}"
        for rule, reason in choice.reasons
    ]
    for rule in choice.rules:
        lines.append(f"  rule `{rule.name}` ({rule.place.line}) applies: {rule.what}")
        if rule.what != "ignore":
            parts = [
                part
                for part in interpretation.parts
                if part.table is table and part.rule is rule
            ]
            lines += _columns(rule, table) + [
                line for part in parts for line in _part(part)
            ]
    if not choice.rules:
        lines.append("  no rule applies: the table is not imported")
    about = [
        t for t in interpretation.survey.import_findings if t.is_about_table(number - 1)
    ]
    lines += [_finding(import_finding) for import_finding in about]
    return "\n".join(line.rstrip() for line in lines)


def _columns(rule: TableRule, table: SourceTable) -> list[str]:
    # Read again with notes of its own, which are discarded: they are among the findings
    # already.
    titles, rows = read_rows(rule, table, Notes())
    roles: dict[str, str] = {}
    for column in (*rule.columns, *rule.lines):
        for title in find_columns(column, titles):
            roles[title] = " or ".join(
                f"`{pattern.text}`" for pattern in column.patterns
            )
    lines = [f"    {count(len(rows), 'row')} below the headings"]
    for title in filter(None, titles):
        use = roles.get(title)
        if not use and title in rule.ignore:
            use = "ignored"
        elif not use:
            use = "melted" if rule.melt else "no role"
        lines.append(f"    column `{title}`: {use}")
    return lines


def _part(part: TablePart) -> list[str]:
    given = ", ".join(f"{role} = `{text[:SHOWN]}`" for role, text in part.given.items())
    lines = [f"    {part.rule.what}: {given}" if given else f"    {part.rule.what}"]
    lines += [f"      value {value}: {name[:SHOWN]}" for value, name in part.pairs]
    for draft in part.drafts:
        elements = f" x {draft.count}" if draft.count else ""
        formula = f", {draft.described.formula}" if draft.described.formula else ""
        unit = f" {draft.described.unit}" if draft.described.unit else ""
        lines.append(
            f"      bit {draft.at:>4} +{draft.bits}{elements}  {draft.kind}  {draft.name[:SHOWN]}{unit}{formula}"
        )
        lines += [
            f"        value {value}: {name[:SHOWN]}" for value, name in draft.members
        ]
    return lines


def _finding(import_finding: ImportFinding) -> str:
    place = ""
    if import_finding.spot.line:
        place = f" (line {import_finding.spot.line})"
    elif import_finding.spot.page:
        place = f" (page {import_finding.spot.page})"
    return f"  {import_finding.severity}[{import_finding.code}]{place}: {import_finding.message}"
