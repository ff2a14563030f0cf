"""Fixtures of the importer tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.importer import profile, run
from tests.conftest import ROOT

VENDOR = Path(os.environ.get("ICDGEN_MANUALS") or ROOT.parent / "shared" / "manual")


@pytest.fixture
def vendor() -> Path:
    """Return the folder of the vendor's manuals, which are not part of the repository."""
    if not VENDOR.is_dir():
        pytest.skip("the vendor's manuals are not at hand")
    return VENDOR


# The profile of the documents that `manuals` draws.
RULES = Path(__file__).parent / "rules" / "layouts.yaml"


def imported(
    manual: Path, words: str | Path = RULES, jobs: int = 1
) -> tuple[run.Result, dict[str, dict]]:
    """Return the result of an import. Raises `Findings`, also if nothing was imported."""
    result, trees = run.run(manual, profile.load(profile.find(str(words))), jobs=jobs)
    if not trees:
        finding = next(t for t in result.import_findings if t.code == "IMP004")
        raise Findings(
            [Finding(finding.code, finding.message, Place(str(manual)), finding.help)]
        )
    return result, trees
