"""State of the workbench: a document, its tables, and the profile as text.

`server` calls a method of `Session` for each request. Every change of the profile
applies all rules again, without reading the document again.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from pathlib import Path
from threading import RLock
from typing import Any

from icdgen.errors import UserError, unreadable
from icdgen.icd import source
from icdgen.import_results import report, targets
from icdgen.import_results.findings import ImportFinding
from icdgen.importer import profile, run
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import ReadMessage
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.language import ROLES, ROLES_OF, normalised
from icdgen.importer.rules.parts import TablePart
from icdgen.importer.rules.selection import heading_rows, texts_of_rows
from icdgen.importer.source_tables import group_by_headings, name_of
from icdgen.importer.workbench import rule_text
from icdgen.importer.workbench.valid_rules import read_profile

Reader = Callable[[profile.Profile], tuple[Document, list[SourceTable]]]
Version = tuple[str, list[dict[str, Any] | None]]
"""Text of a profile, and the last valid form of each of its rules."""
RESOLUTION = 100  # dots per inch of a page's picture


class Session:
    """One document and one profile; every method may be called from any thread."""

    def __init__(
        self,
        document: Document,
        tables: list[SourceTable],
        path: Path,
        out: Path,
        reader: Reader | None = None,
    ) -> None:
        self.document, self.tables, self.path, self.out, self.reader = (
            document,
            tables,
            path,
            out,
            reader,
        )
        self.lock = RLock()
        # Contents of the profile's file when it was read or written last.
        self.disk = self.read_disk()
        self.text = self.saved = _decoded(self.disk, path)
        if self.disk is None:
            self.text = rule_text.NEW
        # Earlier versions of the profile, the latest last.
        self.past: list[Version] = []
        self.future: list[Version] = []  # versions that were undone
        self.pictures: dict[int, bytes] = {}
        self.apply(self.text, [None] * len(rule_text.rules_of(self.text)))

    def apply(self, text: str, last_valid: list[dict[str, Any] | None]) -> None:
        """Apply the rules of a text to all tables.

        Raises `Findings`, and changes nothing, for errors outside the rules.
        """
        self.valid = read_profile(text, self.path.name, last_valid)
        self.text = text
        self.result, self.trees = run.apply_rules(
            self.document, self.tables, self.valid.words
        )

    def read_disk(self) -> bytes | None:
        """Return the contents of the profile's file; None if there is no file.

        Raises `UserError`.
        """
        try:
            return self.path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise unreadable(self.path, error) from None

    # Answers.

    def state(self) -> dict[str, Any]:
        """Everything but the contents of single tables."""
        with self.lock:
            rules = rule_text.rules_of(self.text)
            import_findings = self.result.import_findings
            applied = self.rules_by_table()
            groups = group_by_headings(self.tables)
            return {
                "document": Path(self.document.file).name,
                "profile": str(self.path),
                "is_saved": self.saved == self.text,
                "node": self.node(),
                "roles": ROLES,
                "roles_of": {what: sorted(roles) for what, roles in ROLES_OF.items()},
                "rules": [
                    {"keys": rule, "text": rule_text.text_of_rule(rule)}
                    for rule in rules
                ],
                "kinds": [
                    {
                        "titles": group[0].titles,
                        "tables": [table.number for table in group],
                    }
                    for group in groups
                ],
                "tables": [
                    self.summary(table, applied, import_findings)
                    for table in self.tables
                ],
                "findings": [
                    _finding(import_finding) for import_finding in import_findings
                ],
                "errors": [
                    {"rule": index, "message": f.message, "help": f.help}
                    for index, f in self.valid.errors
                ],
                "can_undo": bool(self.past),
                "can_redo": bool(self.future),
                "has_pictures": self.document.file.casefold().endswith(".pdf")
                and Path(self.document.file).exists(),
            }

    def node(self) -> dict[str, Any]:
        """Return the `node:` section of the profile."""
        tree = source.parse(self.text.encode("utf-8"), "profile")
        return dict(tree.get("node") or {})

    def rules_by_table(self) -> dict[int, list[int]]:
        """Number of a table -> the indices of the rules that apply to it."""
        # Several rules can stand in one line, so that places do not distinguish them.
        index_of = {
            id(rule): index
            for rule, index in zip(
                self.valid.words.rules, self.valid.indices, strict=True
            )
        }
        return {
            choice.table.number: [index_of[id(rule)] for rule in choice.rules]
            for choice in self.result.interpretation.choices
        }

    def summary(
        self,
        table: SourceTable,
        applied: dict[int, list[int]],
        import_findings: list[ImportFinding],
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

    def parts(self, table: SourceTable) -> list[TablePart]:
        """Parts that rules read from a table."""
        return [
            part
            for part in self.result.interpretation.parts
            if part.table.number == table.number
        ]

    def enumerations(self, part: TablePart) -> dict[str, str]:
        """Name of a field of a message -> name of its enumeration in the ICD."""
        messages = [
            message
            for _, message in self.result.survey.results_of(ReadMessage)
            if message.name == part.name and message.table.number == part.table.number
        ]
        return {
            field.name: field.enum
            for message in messages
            for field in message.all_fields
            if field.enum
        }

    def table(self, number: int) -> dict[str, Any]:
        """A table with its cells, the texts around it and what rules read from it.

        Raises `KeyError`.
        """
        with self.lock:
            if not 1 <= number <= len(self.tables):
                raise KeyError(number)
            table = self.tables[number - 1]
            import_findings = self.result.import_findings
            choices = self.result.interpretation.choices
            of_table = (choice for choice in choices if choice.table.number == number)
            reasons = [
                (rule.name, reason)
                for choice in of_table
                for rule, reason in choice.reasons
            ]
            return {
                "number": number, "title": table.title, "page": table.page, "caption": table.caption, "headings": table.headings,
                "before": table.before, "titles": table.titles, "head": self.head(table),
                "boxes": [list(box) for box in table.boxes],
                "rows": [[[cell.text, cell.columns, cell.rows] for cell in row.cells] for row in table.rows],
                "rules": self.rules_by_table().get(number, []), "reasons": reasons,
                "messages": [_message(part, self.enumerations(part)) for part in self.parts(table)],
                "findings": [_finding(t) for t in import_findings if t.is_about_table(number - 1)],
            }  # fmt: skip

    def head(self, table: SourceTable) -> int:
        """Return the index of the heading row, by the rule of the table.

        Without a rule, return the first row with several filled cells.
        """
        for choice in self.result.interpretation.choices:
            if choice.table.number == table.number and choice.rules:
                head = heading_rows(
                    choice.rules[-1], texts_of_rows(table, choice.rules[-1].transpose)
                )
                if head is not None and not choice.rules[-1].transpose:
                    return head.start if head else -1
        return next(
            (
                i
                for i, row in enumerate(table.rows)
                if sum(bool(c.text.strip()) for c in row.cells) > 1
            ),
            0,
        )

    def picture(self, number: int) -> bytes:
        """Return the picture of a page as PNG.

        Raises `KeyError` if the document has no such page.
        """
        with self.lock:
            if number not in self.pictures:
                self.pictures[number] = _render(Path(self.document.file), number)
            return self.pictures[number]

    # Changes.

    def set_rule(
        self, index: int | None, rule: dict[str, Any] | None, behind: int | None = None
    ) -> int | None:
        """Replace, add or remove a rule, and return its index.

        A rule that is added behind the rule ``behind`` reads the tables of that rule,
        too. Raises `Findings` if the profile is no YAML.
        """
        with self.lock:
            text, last_valid = self.text, list(self.valid.last_valid)
            if index is not None:
                text = rule_text.with_rule(text, index, rule)
                if rule is None:
                    del last_valid[index]
            else:
                if behind is not None:
                    text = rule_text.with_rule(
                        text, behind, rule_text.rules_of(text)[behind] | {"also": True}
                    )
                    if (before := last_valid[behind]) is not None:
                        last_valid[behind] = before | {"also": True}
                index = len(last_valid) if behind is None else behind + 1
                text = rule_text.with_rule(text, None, rule, behind)
                last_valid.insert(index, None)
            self.change_text(text, last_valid)
            return index if rule is not None else None

    def set_node(self, node: dict[str, Any]) -> None:
        """Replace the `node:` section.

        Raises `Findings`, and changes nothing, if it has errors.
        """
        with self.lock:
            self.change_text(
                rule_text.with_node(self.text, node), self.valid.last_valid
            )

    def change_text(self, text: str, last_valid: list[dict[str, Any] | None]) -> None:
        """Replace the text of the profile; `undo` restores the text before it.

        Raises `Findings`.
        """
        before = self.text, self.valid.last_valid
        self.apply(text, last_valid)
        if text != before[0]:
            self.past.append(before)
            self.future.clear()

    def undo(self) -> None:
        """Take back the last change of the profile; without one, nothing happens."""
        self._restore(self.past, self.future)

    def redo(self) -> None:
        """Make the change again that was taken back last; without one, nothing happens."""
        self._restore(self.future, self.past)

    def _restore(self, source: list[Version], target: list[Version]) -> None:
        """Replace the text by the last one of ``source``, and append it to ``target``."""
        with self.lock:
            if source:
                target.append((self.text, self.valid.last_valid))
                self.apply(*source.pop())

    def read_document(self) -> None:
        """Read the document again with the words of the profile, by which further
        tables may be found.

        Tables without vertical rules are found by the headings that rules name. Raises
        `Findings`.
        """
        with self.lock:
            if self.reader is not None:
                self.document, self.tables = self.reader(self.valid.words)
                self.apply(self.text, self.valid.last_valid)

    def reload(self) -> None:
        """Replace the profile by its file; `undo` restores the profile before it.

        Raises `Findings` or `UserError`, and changes nothing, if the file is not a
        valid profile.
        """
        with self.lock:
            contents = self.read_disk()
            if contents is None:
                raise UserError(
                    f"there is no file {self.path}",
                    "save the profile, which writes the file",
                )
            text = _decoded(contents, self.path)
            profile.profile_of_tree(source.parse(contents, str(self.path)))
            self.change_text(text, [None] * len(rule_text.rules_of(text)))
            self.disk, self.saved = contents, text

    def save(self, overwrite: bool = False) -> dict[str, Any]:
        """Write the profile and the ICDs; return the files and the findings of `icdgen
        check`. Raises `UserError`.

        If another program changed the profile's file, write nothing and return the
        ``conflict``, unless ``overwrite``.
        """
        from icdgen.generation.write import replace

        with self.lock:
            written = self.text.encode("utf-8")
            if not overwrite and (contents := self.read_disk()) not in (
                self.disk,
                written,
            ):
                change = "removed" if contents is None else "changed"
                return {
                    "conflict": f"{self.path} was {change} by another program; nothing is written"
                }
            try:
                replace(Path(os.path.realpath(self.path)), written)
            except OSError as error:
                text = f"cannot write {self.path}: {error.strerror}"
                raise UserError(
                    text, "start the workbench with another --profile"
                ) from None
            self.disk, self.saved = written, self.text
            # A profile with errors is saved, so that no work is lost. Its last valid
            # result must not become an ICD.
            aimed = (
                targets.prepare(self.trees, self.out, over=True)
                if self.trees and not self.valid.errors
                else []
            )
            targets.write(aimed)
            checked = targets.check(aimed)
            return {
                "files": [f"{self.path}: written", *report.files(aimed)],
                "check": report.checked_as_json(checked),
                "is_complete": bool(aimed) and not self.result.failed,
            }


def _decoded(contents: bytes | None, path: Path) -> str:
    """Return the text of a file, with line feeds only. Raises `UserError`."""
    try:
        return (contents or b"").decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        raise UserError(f"{path} is not UTF-8", "save it as UTF-8") from None


def _finding(import_finding: ImportFinding) -> dict[str, Any]:
    table = (
        import_finding.spot.order + 1 if import_finding.spot.order is not None else None
    )
    line = import_finding.place.line if import_finding.place else None
    return {
        **report.finding_as_json(import_finding),
        "table": table,
        "page": import_finding.spot.page,
        "rule_line": line,
    }


def _message(part: TablePart, enumerations: dict[str, str]) -> dict[str, Any]:
    fields = [
        {"at": draft.at, "bits": draft.bits, "name": draft.name, "type": draft.kind, "size": draft.size,
         "unit": draft.described.unit, "formula": draft.described.formula,
         "enumeration": enumerations.get(draft.name, ""), "repeated": _repetition(draft, part.drafts)}
        for draft in part.drafts
    ]  # fmt: skip
    return {
        "what": part.rule.what,
        "given": part.given,
        "fields": fields,
        "pairs": [list(pair) for pair in part.pairs],
    }


def _repetition(draft: FieldDraft, drafts: list[FieldDraft]) -> dict[str, Any] | None:
    """Return the group, the count and the stride in bits of a repeated field; None for
    a single field.
    """
    roles = draft.roles
    group = roles.get("group")
    if not group:
        count = draft.facts.get("count") or draft.count
        return {"group": "", "count": count, "stride": draft.bits} if count else None
    members = [
        other
        for other in drafts
        if normalised(other.roles.get("group")) == normalised(group)
    ]
    start, end = min(other.at for other in members), max(other.end for other in members)
    counted = roles.get("counter") or (
        "rest" if roles.get("rest") else roles.get("count")
    )
    count = int(counted) if counted.isdigit() else counted
    # An element of a group is a struct, which has whole bytes.
    return {"group": group, "count": count, "stride": (end - start + 7) // 8 * 8}


def _render(path: Path, number: int) -> bytes:
    import pypdfium2  # type: ignore[import-untyped]

    try:
        document = pypdfium2.PdfDocument(str(path))
        if not 1 <= number <= len(document):
            raise KeyError(number)
        data = io.BytesIO()
        document[number - 1].render(scale=RESOLUTION / 72).to_pil().save(data, "PNG")
    except pypdfium2.PdfiumError:
        # PDFium is stricter with broken files than the reader of text.
        raise KeyError(number) from None
    return data.getvalue()
