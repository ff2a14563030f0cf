"""Shared by the tests of the importer."""

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
    """The folder of the vendor's manuals, which are no part of the repository."""
    if not VENDOR.is_dir():
        pytest.skip("the vendor's manuals are not at hand")
    return VENDOR


RULES = (
    Path(__file__).parent / "rules" / "layouts.yaml"
)  # of the documents that `manuals` draws


def imported(
    manual: Path, words: str | Path = RULES, jobs: int = 1
) -> tuple[run.Result, dict[str, dict]]:
    """Return what an import of a document gives.

    Raises `Findings` also if that is nothing.
    """
    result, trees = run.run(manual, profile.load(profile.find(str(words))), jobs=jobs)
    if not trees:
        nothing = next(t for t in result.import_findings if t.code == "IMP004")
        raise Findings(
            [Finding(nothing.code, nothing.message, Place(str(manual)), nothing.help)]
        )
    return result, trees
