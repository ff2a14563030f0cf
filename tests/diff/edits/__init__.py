"""Single edits of ICD models: what a release may change, and what the diff must say of
it.

Each edit takes a set of ICDs and a source of randomness. It returns the edited set with
the codes that must be found and those that may be, or None where there is nothing to
which it applies.
"""

from __future__ import annotations

from tests.diff.edits import (
    meaning,  # noqa: F401
    source,  # noqa: F401
    text,  # noqa: F401
    wire,  # noqa: F401
)
from tests.diff.edits.edit import BEYOND, EDITS, TEXT

__all__ = ["BEYOND", "EDITS", "TEXT"]
