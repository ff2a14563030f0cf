"""The protocol of the CubeACP node, as facts and as a link of the runtime."""

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
def acp_facts(icd) -> Facts:
    """The facts of the node that has every section of the protocol."""
    return facts.of(icd, icd.node("cubeacp"))


@pytest.fixture(scope="session")
def link(icd) -> Link:
    """The link of the same node."""
    return links.link(icd, "cubeacp")
