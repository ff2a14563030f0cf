from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.logs import LogEntry, LogReader

from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.links import link_of
from tests import links
from tests.conformance.icds import icd_of


@pytest.fixture(scope="session")
def icd():
    return icd_of()


@pytest.fixture(scope="session")
def node_facts(icd) -> Facts:
    """Return the protocol facts of the node that has logs."""
    return facts.of(icd, icd.node("cubeacp"))


@pytest.fixture(scope="session")
def link(icd, node_facts) -> Link:
    return link_of(icd, node_facts)


@pytest.fixture(scope="session")
def everything(node_facts) -> bytes:
    """Return a mask with every frame, and one unassigned bit."""
    mask = bytearray(node_facts.mask.size)
    free = next(
        bit
        for bit in range(node_facts.mask.size * 8)
        if bit not in node_facts.mask.bits
    )
    for bit in (*node_facts.mask.bits, free):
        mask[bit // 8] |= 1 << (7 - bit % 8 if node_facts.mask.msb0 else bit % 8)
    return bytes(mask)


@pytest.fixture
def write(tmp_path, link):
    """Return a function that writes a log of random frames and returns its path and
    entries.
    """

    def write(
        mask: bytes, count: int, truncated: bytes = b""
    ) -> tuple[Path, list[LogEntry]]:
        source, slots = Random(count), link.mask.selected(mask)
        entries = [
            (
                1_600_000_000 + n,
                n * 7 % 1000,
                [source.randbytes(slot.length) for slot in slots],
            )
            for n in range(count)
        ]
        data = links.log_file(link, mask, entries)
        path = tmp_path / "log.bin"
        path.write_bytes(data + truncated)
        return path, LogReader(link).feed(data)

    return write
