from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from icdgen.protocol import facts, logs
from icdgen.protocol.facts import Facts
from tests.conformance.icds import icd_of


@pytest.fixture(scope="session")
def icd():
    return icd_of()


@pytest.fixture(scope="session")
def known(icd) -> Facts:
    """The protocol of the node that has logs."""
    return facts.of(icd, icd.node("cubeacp"))


@pytest.fixture(scope="session")
def everything(known) -> bytes:
    """A mask with every frame, and a bit that is not assigned."""
    mask = bytearray(known.mask.size)
    free = next(bit for bit in range(known.mask.size * 8) if bit not in known.mask.bits)
    for bit in (*known.mask.bits, free):
        mask[bit // 8] |= 1 << (7 - bit % 8 if known.mask.msb0 else bit % 8)
    return bytes(mask)


@pytest.fixture
def write(tmp_path, known):
    """Writes a log of random frames: path, and its entries."""

    def write(
        mask: bytes, count: int, truncated: bytes = b""
    ) -> tuple[Path, list[logs.Entry]]:
        source, slots = Random(count), known.mask.selected(mask)
        entries = [
            (
                1_600_000_000 + n,
                n * 7 % 1000,
                [source.randbytes(slot.length) for slot in slots],
            )
            for n in range(count)
        ]
        data = logs.encode(known, mask, entries)
        path = tmp_path / "log.bin"
        path.write_bytes(data + truncated)
        return path, logs.decode(known, data).entries

    return write
