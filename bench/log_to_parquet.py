"""Measure time and memory of `icdgen log LOG --out LOG.parquet`, for a log with all
loggable frames.

Usage::

    python bench/log_to_parquet.py [--size 1000] [--folder /tmp]

``--size`` is in millions of bytes. The log contains slowly changing values with noise,
like real telemetry.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from icdgen.model_cache import load_checked
from icdgen.protocol import facts

ROOT = Path(__file__).parent.parent
PIECE = 20_000  # entries


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, default=1000, help="millions of bytes")
    parser.add_argument("--folder", default=tempfile.gettempdir())
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        log, out = Path(folder, "log.bin"), Path(folder, "log.parquet")
        columns = write(log, options.size * 1_000_000)
        begin, cpu = time.perf_counter(), used()
        subprocess.run(
            [sys.executable, "-m", "icdgen", "log", str(log), "--out", str(out)],
            check=True,
            cwd=ROOT,
        )
        took, cpu = time.perf_counter() - begin, used() - cpu
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        size = log.stat().st_size
        print(
            f"{size / 1e6:.0f} MB of log, {columns} columns: {took:.1f} s ({size / 1e6 / took:.0f} MB/s), ",
            end="",
        )
        print(
            f"{cpu:.1f} s of CPU, {memory:.0f} MB of memory, {out.stat().st_size / 1e6:.0f} MB of Parquet"
        )


def used() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def write(path: Path, size: int) -> int:
    """Write a log of about ``size`` bytes, and return the number of fields of an entry."""
    icd = load_checked([ROOT / "icd"], ()).icd
    node_facts = next(
        k
        for k in (facts.of(icd, node) for node in icd.nodes)
        if k.log_file and k.mask and k.mask.bits
    )
    mask = bytearray(node_facts.mask.size)
    for bit in node_facts.mask.bits:
        mask[bit // 8] |= 1 << (7 - bit % 8 if node_facts.mask.msb0 else bit % 8)
    slots, random = node_facts.mask.selected(bytes(mask)), np.random.default_rng(1)
    step, width = node_facts.mask.slot_bytes, node_facts.log_file.frames_at
    entry_bytes = width + len(slots) * step
    with path.open("wb") as file:
        file.write(bytes(mask).ljust(node_facts.log_file.header_bytes, b"\0"))
        number = 0
        while file.tell() < size:
            data = np.zeros((PIECE, entry_bytes), np.uint8)
            seconds = np.arange(number, number + PIECE) // 10 + 1_700_000_000
            data[:, :4] = seconds.astype("<u4").view(np.uint8).reshape(-1, 4)
            data[:, 4:6] = (
                (np.arange(PIECE) % 10 * 100)
                .astype("<u2")
                .view(np.uint8)
                .reshape(-1, 2)
            )
            slow = (
                np.sin(
                    np.arange(PIECE)[:, None] / 500
                    + np.arange((entry_bytes - width) // 2)
                )
                * 3000
            )
            noisy = (slow + random.normal(0, 20, slow.shape)).astype("<i2")
            data[:, width:] = noisy.view(np.uint8)
            file.write(data.tobytes())
            number += PIECE
    os.sync()
    return sum(
        len(node_facts.telemetry[slot.id].fields)
        for slot in slots
        if slot.id in node_facts.telemetry
    )


if __name__ == "__main__":
    main()
