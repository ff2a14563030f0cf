"""Single edits of ICD models: what a release may change, and what the diff must say of
it.

Each edit takes a set of ICDs and a source of randomness. It returns the edited set with
the codes that must be found and those that may be, or None where there is nothing to
which it applies.
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
