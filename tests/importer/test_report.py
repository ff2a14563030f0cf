"""Findings of an import as text: a manual cannot control the terminal."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.import_results.report import findings

BELL = "\x07\x1b[2J"


@pytest.mark.parametrize("severity", ["error", "warning", "note"])
def test_control_characters_of_a_manual_are_escaped(severity):
    spot = SourcePlace(line=3, file=f"manual{BELL}.txt")
    given = ImportFinding(
        "IMP010", f"message{BELL}", spot, help=f"help{BELL}", severity=severity
    )
    text = "\n".join(findings([given], "manual.pdf"))
    assert "message" in text and "IMP010" in text
    assert all(letter == "\n" or letter.isprintable() for letter in text)
