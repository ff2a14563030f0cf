"""The invalid ICDs: every ``<theme>/<case>.yaml`` with its exact report in
``<case>.txt``.

Files in sub-folders (``errata/``, ``parts/``) belong to the cases of their theme.
"""

from __future__ import annotations

from contextlib import chdir
from pathlib import Path

from icdgen import reports
from icdgen.loading import load

FOLDER = Path(__file__).parent
CASES = sorted(FOLDER.glob("*/*.yaml"))


def name(case: Path) -> str:
    """Return the name of a case, such as ``layout/overlaps``."""
    return f"{case.parent.name}/{case.stem}"


def report(case: Path) -> str:
    """Return the output of `icdgen check` for a case, run in its folder."""
    with chdir(case.parent):
        loaded = load([Path(case.name)])
    return reports.get("text")(loaded.findings, loaded.texts)
