"""Single edits of ICD models: possible changes of a release, and the codes that the
diff must report.

Each edit takes a set of ICDs and a random source. It returns the edited set with the
codes that must and the codes that may be reported, or ``None`` if it does not apply.
"""

from __future__ import annotations

from tests.diff.edits import (  # noqa: F401
    meaning,
    source,
    text,
    wire,
)
from tests.diff.edits.edit import BEYOND, EDITS, TEXT

__all__ = ["BEYOND", "EDITS", "TEXT"]
