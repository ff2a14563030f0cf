"""Findings of rules, with the places in the source and in the profile, and counts of
dropped rows.

Rows with the same cause become one finding.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from icdgen.diagnostics import Place
from icdgen.import_results.findings import DOUBTFUL, LIKELY, ImportFinding, SourcePlace
from icdgen.importer.rules.rule import TableRule
from icdgen.wording import count

MOST_EXAMPLES = 4


@dataclass
class FindingGroup:
    """Findings with the same cause: the first one, and the places and examples of the
    others.
    """

    first: ImportFinding
    spots: list[SourcePlace] = field(default_factory=list)
    examples: list[str] = field(default_factory=list)

    def add(self, spot: SourcePlace, example: str) -> None:
        """Count one more row."""
        self.spots.append(spot)
        self.examples.append(example)

    def as_import_finding(self) -> ImportFinding:
        """One finding at the place of the first row; `also` has the places of the
        others.
        """
        more = len(self.spots) - 1
        if not more:
            return self.first
        tables = len({spot.order for spot in self.spots})
        further_examples = list(
            dict.fromkeys(
                text for text in self.examples[1:] if text != self.examples[0]
            )
        )
        shown = ", ".join(f"`{text[:40]}`" for text in further_examples[:MOST_EXAMPLES])
        shown += ", ..." if len(further_examples) > MOST_EXAMPLES else ""
        rows = (
            f"{count(more, 'more row')}{f' of {tables} tables' if tables > 1 else ''}"
        )
        message = (
            f"{self.first.message}; the same in {rows}{f': {shown}' if shown else ''}"
        )
        return self.first._replace(message=message, also=tuple(self.spots[1:]))


@dataclass
class Notes:
    """Findings so far.

    ``dropped`` are the texts of rows that a rule drops on purpose, by rule and
    operation.
    """

    single: list[ImportFinding] = field(default_factory=list)
    groups: dict[tuple[object, ...], FindingGroup] = field(default_factory=dict)
    dropped: dict[tuple[str, str], list[str]] = field(
        default_factory=lambda: defaultdict(list)
    )
    used_corrections: set[Place] = field(default_factory=set)

    def error(
        self,
        code: str,
        message: str,
        spot: SourcePlace,
        help: str,
        place: Place | None = None,
        example: str = "",
    ) -> None:
        """Report that something is missing from the result, or wrong in it.

        Findings with an ``example`` (a text or the name of a field) that agree in code,
        rule and help have the same cause and become one finding, which lists the
        examples.
        """
        self._add(
            ImportFinding(code, message, spot, help, "error", DOUBTFUL, place), example
        )

    def warn(
        self,
        code: str,
        message: str,
        spot: SourcePlace,
        help: str,
        place: Place | None = None,
        example: str = "",
    ) -> None:
        """Report that something must be compared with the source.

        ``example`` as for `error`.
        """
        self._add(
            ImportFinding(code, message, spot, help, "warning", LIKELY, place), example
        )

    def _add(self, import_finding: ImportFinding, example: str) -> None:
        if not example:
            self.single.append(import_finding)
            return
        # The help names the change to make: one change removes all findings with the same
        # help and rule.
        key = (
            import_finding.code,
            import_finding.severity,
            import_finding.help,
            import_finding.place,
        )
        self.groups.setdefault(key, FindingGroup(import_finding)).add(
            import_finding.spot, example
        )

    @property
    def import_findings(self) -> list[ImportFinding]:
        """All findings, with one finding per cause."""
        return [
            *self.single,
            *(group.as_import_finding() for group in self.groups.values()),
        ]

    def drop(self, rule: TableRule, operation: str, text: str) -> None:
        """Count a row that the rule drops on purpose."""
        self.dropped[rule.name, operation].append(text)

    def finish(self, rules: list[TableRule]) -> None:
        """Add a note for each rule and operation that dropped rows."""
        places = {rule.name: rule.place for rule in rules}
        for (name, operation), texts in self.dropped.items():
            kinds = list(dict.fromkeys(texts))
            shown = ", ".join(f"`{text[:50]}`" for text in kinds[:3]) + (
                " ..." if len(kinds) > 3 else ""
            )
            rows = count(len(texts), "row")
            self.single.append(
                ImportFinding(
                    "IMP108",
                    f"rule `{name}`: `{operation}` drops {rows}: {shown}",
                    SourcePlace(),
                    "make sure that none is a field",
                    "note",
                    place=places[name],
                )
            )
