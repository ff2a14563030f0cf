from __future__ import annotations

import pytest

from icdgen.icd.model import Icd
from icdgen.loading import load
from tests.conftest import ROOT


@pytest.fixture(scope="session")
def shipped() -> Icd:
    return load([ROOT / "icd"]).icd
