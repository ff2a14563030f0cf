"""Measure the time of comparisons, and of loading both sets of ICDs.

python bench/diff.py [--runs 21]
"""

from __future__ import annotations

import argparse
import os
import random
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import chdir
from functools import partial
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "codegen")]

from icdgen.diff import inputs, report, reports  # noqa: E402
from icdgen.diff.inputs.side import ComparisonSide  # noqa: E402
from tests.diff.edits import EDITS  # noqa: E402
from tests.diff.release.make import make  # noqa: E402


def median(runs: int, work: Callable[[], object]) -> float:
    """Return the median processor time in milliseconds."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return statistics.median(times) * 1e3


def edited(side: ComparisonSide) -> ComparisonSide:
    """Return the ICDs after 400 edits of all kinds."""
    rng, icd = random.Random(1), side.icd
    for number in range(400):
        result = EDITS[list(EDITS)[number % len(EDITS)]](icd, rng)
        icd = result.icd if result is not None else icd
    return ComparisonSide("edited", icd)


def say(what: str, runs: int, work: Callable[[], object]) -> None:
    print(f"{what}: {median(runs, work):.1f} ms")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=21)
    runs = parser.parse_args().runs
    os.environ["ICDGEN_CACHE"] = "off"
    with tempfile.TemporaryDirectory() as folder, chdir(ROOT):
        older = str(make(Path(folder)))
        old, new = inputs.sides([older, "icd"], [])
        same, other = inputs.sides(["icd", "icd"], [])
        pairs = {
            "the same twice": (same, other),
            "an older release": (old, new),
            "after 400 edits": (same, edited(same)),
        }
        say("load both", max(runs // 4, 3), lambda: inputs.sides([older, "icd"], []))
        for name, (first, second) in pairs.items():
            number = len(report.make_report(first, second).changes)
            say(
                f"compare {name} ({number} changes)",
                runs,
                partial(report.make_report, first, second),
            )
        comparison = report.make_report(old, new)
        for form in reports.FORMATS:
            say(
                f"report of an older release as {form}",
                runs,
                partial(reports.get(form), comparison),
            )


if __name__ == "__main__":
    main()
