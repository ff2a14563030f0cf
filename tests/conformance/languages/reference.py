"""The reference codec itself behind the protocol: shows that the run and the vectors
agree with it.
"""

from __future__ import annotations

from tests.conformance.languages import REFERENCE, Language


def build(source, out) -> list[str]:
    """Nothing is built: the run answers by itself."""
    return []


LANGUAGES = [Language("reference", (), (), build, REFERENCE)]
