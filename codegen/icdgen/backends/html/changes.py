"""The page that says what changed since an older release."""

from __future__ import annotations

from icdgen.backends.html.atlas import Atlas
from icdgen.icd.model import Icd


def values(atlas: Atlas, previous: Icd) -> dict[str, object]:
    """Values of the page."""
    return {}
