"""Findings as SARIF 2.1.0, a format of code-scanning services and editors.

`document` and `described` also serve the SARIF report of `icdgen diff`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import PurePath
from typing import Any, Protocol
from urllib.parse import quote

from icdgen import __version__
from icdgen.diagnostics import Finding, Place
from icdgen.icd import rules


class PrintedPage(Protocol):
    """Page of a rule, as far as SARIF needs it."""

    @property
    def why(self) -> str: ...


class Explained(Protocol):
    """A rule for ICDs or a rule of the diff, as far as SARIF needs it."""

    @property
    def severity(self) -> str: ...

    @property
    def title(self) -> str: ...

    @property
    def page(self) -> PrintedPage: ...


SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def report(
    findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False
) -> str:
    """Return a log with one run, which describes the violated rules."""
    return json.dumps(document(list(findings), _rule), indent=2) + "\n"


def document(
    findings: list[Finding], about: Callable[[str], dict[str, Any]]
) -> dict[str, Any]:
    """Return the log as values for JSON.

    ``about`` returns the description of a rule by its code.
    """
    codes = sorted({finding.code for finding in findings})
    index = {code: number for number, code in enumerate(codes)}
    driver = {
        "name": "icdgen",
        "semanticVersion": __version__,
        "rules": [about(code) for code in codes],
    }
    run = {
        "tool": {"driver": driver},
        # Columns of findings are indices of Python strings. The default of SARIF is
        # UTF-16 code units.
        "columnKind": "unicodeCodePoints",
        "results": [_result(finding, index[finding.code]) for finding in findings],
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(code: str) -> dict[str, Any]:
    """Return the description of a rule for ICDs."""
    rule = rules.ALL.get(code)
    return {"id": code} if rule is None else described(code, rule, rules.explain(code))


def described(code: str, rule: Explained, text: str) -> dict[str, Any]:
    """Return the `reportingDescriptor` of a rule (SARIF, section 3.49); ``text`` is its
    explanation in Markdown.
    """
    return {
        "id": code,
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": " ".join(rule.page.why.split())},
        "help": {"text": text, "markdown": text},
        "defaultConfiguration": {"level": rule.severity},
    }


def _result(finding: Finding, index: int) -> dict[str, Any]:
    """Return the `result` of a finding (SARIF, section 3.27)."""
    text = finding.message + (f"\n{finding.help}" if finding.help else "")
    result = {
        "ruleId": finding.code,
        "ruleIndex": index,
        "level": finding.severity,
        "message": {"text": text},
        "locations": [{"physicalLocation": physical(finding.place)}],
    }
    if finding.related is not None:
        label = {"text": finding.related.label}
        result["relatedLocations"] = [
            {"physicalLocation": physical(finding.related.place), "message": label}
        ]
    if finding.fix is not None:
        region = physical(finding.fix.place)
        replacement = {
            "deletedRegion": region["region"],
            "insertedContent": {"text": finding.fix.text},
        }
        change = {
            "artifactLocation": region["artifactLocation"],
            "replacements": [replacement],
        }
        result["fixes"] = [
            {"description": {"text": finding.help}, "artifactChanges": [change]}
        ]
    return result


def physical(place: Place) -> dict[str, Any]:
    """Return the `physicalLocation` of a place (SARIF, section 3.29)."""
    # SARIF 2.1.0, 3.30.8: `endColumn` is the column behind the region.
    region = {
        "startLine": place.line,
        "startColumn": place.column,
        "endColumn": place.column + place.length,
    }
    return {"artifactLocation": {"uri": _uri(place.file)}, "region": region}


def _uri(file: str) -> str:
    """Return the URI of a file; relative for a relative path."""
    path = PurePath(file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))
