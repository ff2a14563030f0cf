"""The wrong ICDs: every ``<theme>/<case>.yaml``, beside it the exact report in
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
    """``layout/overlaps``"""
    return f"{case.parent.name}/{case.stem}"


def report(case: Path) -> str:
    """What `icdgen check` prints about it, run in its folder."""
    with chdir(case.parent):
        loaded = load([Path(case.name)])
    return reports.get("text")(loaded.findings, loaded.texts)
