"""The example pairs of the rules: ``rules/<code>/previous`` and ``current``, and the
exact report in ``expected.txt``. `compared_texts` compares other pairs.
"""

from __future__ import annotations

from contextlib import chdir
from pathlib import Path

from icdgen.diagnostics import Place
from icdgen.diff import inputs, report, reports
from icdgen.diff.compare import Comparison, compare
from icdgen.loading import load
from tests.icd.files import write

FOLDER = Path(__file__).parent / "rules"
CASES = sorted(path for path in FOLDER.iterdir() if path.is_dir())


def compared(case: Path) -> report.DiffReport:
    """Return the comparison of `icdgen diff previous current` in the folder of the
    case.
    """
    with chdir(case):
        return report.make_report(*inputs.sides(["previous", "current"], []))


def printed(case: Path) -> str:
    """Return the complete output of `icdgen diff`."""
    return reports.get("text")(compared(case), everything=True)


def compared_texts(
    folder: Path, old: str, new: str, is_checked: bool = True
) -> Comparison:
    """Compare two ICDs that have no findings, or that are not checked. `HEAD` is added
    to a text without it.
    """
    sides = []
    for name, text in (("old", old), ("new", new)):
        (folder / name).mkdir(parents=True, exist_ok=True)
        result = load([write(folder / name, text)], check=is_checked)
        assert result.findings == []
        sides.append(result.icd)
    return compare(*sides)


def rows_of(comparison: Comparison, *codes: str) -> list[tuple]:
    """Return the changes with these codes: code, kind, message, old and new value, the
    text at the old and at the new place, and the details.
    """
    return [
        (
            change.code,
            change.kind,
            change.message,
            change.was,
            change.now,
            text_at(change.old),
            text_at(change.new),
            *change.details,
        )
        for change in comparison.changes
        if change.code in codes
    ]


def text_at(place: Place | None) -> str | None:
    """Return the text at a place of a file; None without a place."""
    if place is None:
        return None
    line = Path(place.file).read_text(encoding="utf-8").splitlines()[place.line - 1]
    return line[place.column - 1 :][: place.length]
