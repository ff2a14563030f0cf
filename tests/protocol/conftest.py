from __future__ import annotations

import pytest
from icdgen_runtime.wire.link import Link

from icdgen.icd.model import Icd
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from tests import links
from tests.conformance.icds import icd_of


@pytest.fixture(scope="session")
def icd() -> Icd:
    return icd_of()


@pytest.fixture(scope="session")
def known(icd) -> Facts:
    """The protocol of the node that has all of it."""
    return facts.of(icd, icd.node("cubeacp"))


@pytest.fixture(scope="session")
def link(icd) -> Link:
    """The link of that node."""
    return links.link(icd, "cubeacp")
