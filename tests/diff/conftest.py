"""Fixture with two releases of a small ICD."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import icdgen  # noqa: F401
from tests.conftest import DEMO

LATER = DEMO.replace("formula: raw*0.01", "formula: raw*0.001", 1).replace(
    "id: 20", "id: 21"
)


@pytest.fixture
def releases(tmp_path) -> tuple[Path, Path]:
    """Write the folders ``old`` and ``new``, in which a factor and an id differ."""
    for name, text in (("old", DEMO), ("new", LATER)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "demo.yaml").write_text(text, encoding="utf-8")
    return tmp_path / "old", tmp_path / "new"
