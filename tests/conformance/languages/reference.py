"""The reference codec as a language: shows that the run and the vectors agree with it."""

from __future__ import annotations

from tests.conformance.languages import REFERENCE, Language


def build(source, out) -> list[str]:
    """Return no command line, because the run answers in its own process."""
    return []


LANGUAGES = [Language("reference", (), (), build, REFERENCE)]
