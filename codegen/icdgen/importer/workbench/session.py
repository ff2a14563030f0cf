"""State of the workbench: a document, its tables, and the profile as text."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from pathlib import Path
from threading import RLock
from typing import Any

from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.import_results import report, targets
from icdgen.import_results.findings import ImportFinding
from icdgen.importer import profile, run
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.rules.language import ROLES
from icdgen.importer.rules.parts import Part
from icdgen.importer.rules.selection import heading_rows, texts_of
from icdgen.importer.source_tables import kinds, name_of
from icdgen.importer.workbench import rule_text

Reader = Callable[[profile.Profile], tuple[Document, list[SourceTable]]]
RESOLUTION = 100  # dots per inch of a page's picture


class Session:
    """One document and one profile; every method may be called from any thread."""

    def __init__(
        self, document: Document, tables: list[SourceTable], path: Path, out: Path, reader: Reader | None = None
    ) -> None:
        self.document, self.tables, self.path, self.out, self.reader = document, tables, path, out, reader
        self.lock = RLock()
        self.text = path.read_text(encoding="utf-8") if path.exists() else rule_text.NEW
        self.saved = self.text if path.exists() else ""
        self.past: list[str] = []  # earlier texts of the profile, the latest last
        self.future: list[str] = []  # texts that were undone
        self.errors: list[dict[str, Any]] = []  # of the profile, which then is not applied
        self.pictures: dict[int, bytes] = {}
        self.result: run.Result | None = None
        self.trees: dict[str, dict[str, Any]] = {}
        self.apply()

    def apply(self) -> None:
        """Apply the rules to all tables. Findings of an invalid profile are shown with the last result."""
        try:
            words = profile.of_tree(source.parse(self.text.encode("utf-8"), self.path.name))
        except Findings as error:
            self.errors = [{"message": f.message, "help": f.help, "line": f.place.line} for f in error.findings]
            return
        self.errors = []
        self.result, self.trees = run.apply_rules(self.document, self.tables, words)

    # --- answers ---------------------------------------------------------------------------------------------------

    def state(self) -> dict[str, Any]:
        """Everything but the contents of single tables."""
        with self.lock:
            rules = rule_text.rules_of(self.text)
            import_findings = self.result.import_findings if self.result else []
            applied = self.rules_by_table()
            groups = kinds(self.tables)
            return {
                "document": Path(self.document.file).name,
                "profile": str(self.path),
                "is_saved": self.saved == self.text,
                "node": self.node(),
                "roles": ROLES,
                "rules": [{"keys": rule, "text": rule_text.text_of_rule(rule)} for rule in rules],
                "kinds": [{"titles": group[0].titles, "tables": [table.number for table in group]} for group in groups],
                "tables": [self.summary(table, applied, import_findings) for table in self.tables],
                "findings": [_finding(import_finding) for import_finding in import_findings],
                "errors": self.errors,
                "can_undo": bool(self.past),
                "can_redo": bool(self.future),
                "has_pictures": self.document.file.casefold().endswith(".pdf") and Path(self.document.file).exists(),
            }

    def node(self) -> dict[str, Any]:
        """Return the `node:` section of the profile."""
        tree = source.parse(self.text.encode("utf-8"), "profile")
        return dict(tree.get("node") or {})

    def rules_by_table(self) -> dict[int, list[int]]:
        """Number of a table -> the indices of the rules that apply to it."""
        if self.result is None:
            return {}
        lines = [rule.place.line for rule in self.words_rules()]
        return {
            choice.table.number: [lines.index(rule.place.line) for rule in choice.rules if rule.place.line in lines]
            for choice in self.result.interpretation.choices
        }

    def words_rules(self) -> list[Any]:
        """Return the rules as applied, in the order of the profile."""
        assert self.result is not None
        return self.result.interpretation.rules

    def summary(
        self, table: SourceTable, applied: dict[int, list[int]], import_findings: list[ImportFinding]
    ) -> dict[str, Any]:
        """Return a line of the list of tables."""
        own = [
            import_finding.severity
            for import_finding in import_findings
            if import_finding.is_about_table(table.number - 1)
        ]
        parts = self.parts(table)
        return {
            "number": table.number, "title": table.title, "name": name_of(table), "page": table.page,
            "boxes": [list(box) for box in table.boxes], "rules": applied.get(table.number, []),
            "errors": own.count("error"), "warnings": own.count("warning"),
            "messages": [part.name or "?" for part in parts if part.drafts or part.name],
            "fields": sum(len(part.drafts) for part in parts),
        }  # fmt: skip

    def parts(self, table: SourceTable) -> list[Part]:
        """Parts that rules read from a table."""
        if self.result is None:
            return []
        return [part for part in self.result.interpretation.parts if part.table.number == table.number]

    def table(self, number: int) -> dict[str, Any]:
        """A table with its cells, the texts around it and what rules read from it. Raises `KeyError`."""
        with self.lock:
            if not 1 <= number <= len(self.tables):
                raise KeyError(number)
            table = self.tables[number - 1]
            import_findings = self.result.import_findings if self.result else []
            choices = self.result.interpretation.choices if self.result else []
            reasons = [(rule.name, reason) for c in choices if c.table.number == number for rule, reason in c.reasons]
            return {
                "number": number, "title": table.title, "page": table.page, "caption": table.caption, "headings": table.headings,
                "before": table.before, "titles": table.titles, "head": self.head(table),
                "boxes": [list(box) for box in table.boxes],
                "rows": [[[cell.text, cell.columns, cell.rows] for cell in row.cells] for row in table.rows],
                "rules": self.rules_by_table().get(number, []), "reasons": reasons,
                "messages": [_message(part) for part in self.parts(table)],
                "findings": [_finding(t) for t in import_findings if t.is_about_table(number - 1)],
            }  # fmt: skip

    def head(self, table: SourceTable) -> int:
        """Return the index of the heading row, by the rule of the table.

        Without a rule, return the first row with several filled cells.
        """
        if self.result is not None:
            for choice in self.result.interpretation.choices:
                if choice.table.number == table.number and choice.rules:
                    head = heading_rows(choice.rules[-1], texts_of(table, choice.rules[-1].transpose))
                    if head is not None and not choice.rules[-1].transpose:
                        return head.start if head else -1
        return next((i for i, row in enumerate(table.rows) if sum(bool(c.text.strip()) for c in row.cells) > 1), 0)

    def picture(self, number: int) -> bytes:
        """Return the picture of a page as PNG. Raises `KeyError` if the document has no such page."""
        with self.lock:
            if number not in self.pictures:
                self.pictures[number] = _render(Path(self.document.file), number)
            return self.pictures[number]

    # --- changes ---------------------------------------------------------------------------------------------------

    def set_rule(self, index: int | None, rule: dict[str, Any] | None) -> None:
        """Replace, add or remove a rule. Raises `Findings` if the profile is no YAML."""
        with self.lock:
            self.change_text(rule_text.with_rule(self.text, index, rule))

    def set_node(self, node: dict[str, Any]) -> None:
        """Replace the `node:` section."""
        with self.lock:
            self.change_text(rule_text.with_node(self.text, node))

    def change_text(self, text: str) -> None:
        """Replace the text of the profile; `undo` brings the text before it back."""
        if text != self.text:
            self.past.append(self.text)
            self.future.clear()
            self.text = text
        self.apply()

    def undo(self) -> None:
        """Take back the last change of the profile; without one, nothing happens."""
        self._restore(self.past, self.future)

    def redo(self) -> None:
        """Make the change again that was taken back last; without one, nothing happens."""
        self._restore(self.future, self.past)

    def _restore(self, source: list[str], target: list[str]) -> None:
        """Replace the text by the last one of ``source``, and append it to ``target``."""
        with self.lock:
            if source:
                target.append(self.text)
                self.text = source.pop()
                self.apply()

    def read_document(self) -> None:
        """Read the document again with the words of the profile, by which further tables may be found.

        Tables without vertical rules are found by the headings that rules name. Raises `Findings`.
        """
        with self.lock:
            if self.reader is not None:
                words = profile.of_tree(source.parse(self.text.encode("utf-8"), self.path.name))
                self.document, self.tables = self.reader(words)
                self.apply()

    def save(self) -> dict[str, Any]:
        """Write the profile and the ICDs; return the files and the findings of `icdgen check`. Raises `UserError`."""
        from icdgen.generation.write import replace

        with self.lock:
            try:
                replace(Path(os.path.realpath(self.path)), self.text.encode("utf-8"))
            except OSError as error:
                text = f"cannot write {self.path}: {error.strerror}"
                raise UserError(text, "start the workbench with another --profile") from None
            self.saved = self.text
            # A profile with errors is saved, so that no work is lost. Its last valid result must not become an ICD.
            aimed = targets.prepare(self.trees, self.out, over=True) if self.trees and not self.errors else []
            targets.write(aimed)
            checked = targets.check(aimed)
            return {
                "files": [f"{self.path}: written", *report.files(aimed)],
                "check": report.checked_as_json(checked),
                "is_complete": bool(aimed) and self.result is not None and not self.result.failed,
            }


def _finding(import_finding: ImportFinding) -> dict[str, Any]:
    table = import_finding.spot.order + 1 if import_finding.spot.order is not None else None
    line = import_finding.place.line if import_finding.place else None
    return {
        **report.finding_as_json(import_finding),
        "table": table,
        "page": import_finding.spot.page,
        "rule_line": line,
    }


def _message(part: Part) -> dict[str, Any]:
    fields = [
        {"at": draft.at, "bits": draft.bits, "count": draft.count, "name": draft.name, "type": draft.kind,
         "unit": draft.described.unit, "formula": draft.described.formula, "size": draft.size,
         "members": [[value, name] for value, name in draft.members],
         "facts": {key: value for key, value in draft.facts.items() if key != "points"}}
        for draft in part.drafts
    ]  # fmt: skip
    return {"what": part.rule.what, "given": part.given, "fields": fields, "pairs": [list(pair) for pair in part.pairs]}


def _render(path: Path, number: int) -> bytes:
    import pypdfium2  # type: ignore[import-untyped]

    try:
        document = pypdfium2.PdfDocument(str(path))
        if not 1 <= number <= len(document):
            raise KeyError(number)
        data = io.BytesIO()
        document[number - 1].render(scale=RESOLUTION / 72).to_pil().save(data, "PNG")
    except pypdfium2.PdfiumError:  # it is stricter with broken files than the reader of text
        raise KeyError(number) from None
    return data.getvalue()
