"""ICDs that look strange and are right: no rule may object."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.loading import load

FINE = sorted(Path(__file__).with_name("fine").glob("*.yaml"))


@pytest.mark.parametrize("path", FINE, ids=lambda path: path.stem)
def test_nothing_is_found(path):
    assert load([path]).findings == []
