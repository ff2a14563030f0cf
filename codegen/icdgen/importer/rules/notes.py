"""What rules report: findings with the place in the source and the place of the rule, and counts of what they drop."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from icdgen.diagnostics import Place
from icdgen.import_results.findings import DOUBTFUL, LIKELY, Spot, Trouble
from icdgen.importer.rules.rule import Rule


@dataclass
class Notes:
    """Findings so far. ``dropped`` are the texts of rows that a rule drops on purpose, by rule and operation."""

    troubles: list[Trouble] = field(default_factory=list)
    dropped: dict[tuple[str, str], list[str]] = field(default_factory=lambda: defaultdict(list))
    used_corrections: set[Place] = field(default_factory=set)

    def error(self, code: str, message: str, spot: Spot, help: str, place: Place | None = None) -> None:
        """Report that something is missing from the result, or wrong in it."""
        self.troubles.append(Trouble(code, message, spot, help, "error", DOUBTFUL, place))

    def warn(self, code: str, message: str, spot: Spot, help: str, place: Place | None = None) -> None:
        """Report that something must be compared with the source."""
        self.troubles.append(Trouble(code, message, spot, help, "warning", LIKELY, place))

    def drop(self, rule: Rule, operation: str, text: str) -> None:
        """Count a row that the rule drops on purpose."""
        self.dropped[rule.name, operation].append(text)

    def finish(self, rules: list[Rule]) -> None:
        """Add a note for each rule and operation that dropped rows."""
        places = {rule.name: rule.place for rule in rules}
        for (name, operation), texts in self.dropped.items():
            kinds = list(dict.fromkeys(texts))
            shown = ", ".join(f"`{text[:50]}`" for text in kinds[:3]) + (" ..." if len(kinds) > 3 else "")
            rows = f"{len(texts)} row{'s' if len(texts) != 1 else ''}"
            self.troubles.append(
                Trouble(
                    "IMP108",
                    f"rule `{name}`: `{operation}` drops {rows}: {shown}",
                    Spot(),
                    "make sure that none is a field",
                    "note",
                    place=places[name],
                )
            )
