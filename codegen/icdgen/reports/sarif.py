"""Findings as SARIF 2.1.0, which code-scanning services and editors read."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import PurePath
from urllib.parse import quote

from icdgen import __version__
from icdgen.diagnostics import Finding
from icdgen.icd import rules

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def report(findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str:
    """One run of the tool, with the rules that were broken."""
    findings = list(findings)
    codes = sorted({f.code for f in findings})
    index = {code: number for number, code in enumerate(codes)}
    driver = {"name": "icdgen", "semanticVersion": __version__, "rules": [_rule(code) for code in codes]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(f, index[f.code]) for f in findings],
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _rule(code: str) -> dict:
    rule = rules.ALL.get(code)
    if rule is None:
        return {"id": code}
    text = rules.explain(code)
    return {
        "id": code,
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": " ".join(rule.page.why.split())},
        "help": {"text": text, "markdown": text},
        "defaultConfiguration": {"level": rule.severity},
    }


def _result(finding: Finding, index: int) -> dict:
    place = finding.place
    text = finding.message + (f"\n{finding.help}" if finding.help else "")
    region = {"startLine": place.line, "startColumn": place.column, "endColumn": place.column + place.length}
    where = {"artifactLocation": {"uri": _uri(place.file)}, "region": region}
    return {
        "ruleId": finding.code,
        "ruleIndex": index,
        "level": finding.severity,
        "message": {"text": text},
        "locations": [{"physicalLocation": where}],
    }


def _uri(file: str) -> str:
    path = PurePath(file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))
