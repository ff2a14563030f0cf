"""``python -m tests.mutation.tool [FILE ...]``: plants faults in icdgen itself, one at a
time, and runs the tests that cover the file (`tests.covering`).

In: Python files below ``codegen/`` and ``runtime/python/``; by default the files that
changed since ``--base``. Out: a line per fault that no test caught, and the counts.
Ends with status 0 if all are caught. A fault may be equivalent to the code; whoever
reads the list decides. The faults themselves are in `tests.mutation.faults`.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.conftest import ROOT
from tests.covering import covering_tests
from tests.mutation.faults import Fault, faults_of

PLANTING = Path(__file__).parent / "planting"

# A fault can make a loop endless. It is caught after this multiple of the time that the
# tests take without a fault.
PATIENCE = 5


def changed_since(base: str) -> list[str]:
    """Return the Python files of icdgen that differ from a revision of git."""
    command = ["git", "diff", "--name-only", "--diff-filter=d", base, "--"]
    names = subprocess.run(
        [*command, "codegen", "runtime/python"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    return [name for name in names if name.endswith(".py")]


def run_tests(
    tests: list[str],
    planted: tuple[Path, Path] | None = None,
    workers: int = 0,
    limit_s: float | None = None,
) -> tuple[bool, float]:
    """Run tests until one fails, with the source of a file replaced by another one.

    Returns whether all passed, and the time in seconds. Tests that take more than
    `limit_s` seconds have failed.
    """
    environment = dict(os.environ)
    if planted:
        path = [str(PLANTING), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment["PYTHONPATH"] = os.pathsep.join(path)
        environment["ICDGEN_PLANTED"] = os.pathsep.join(
            str(file.resolve()) for file in planted
        )
    command = [sys.executable, "-m", "pytest", "-x", "-n", str(workers), *tests]
    start = time.monotonic()
    try:
        ended = subprocess.run(
            command, cwd=ROOT, env=environment, timeout=limit_s, capture_output=True
        )
    except subprocess.TimeoutExpired:
        return False, time.monotonic() - start
    # Status 5: no test ran, which catches nothing.
    return ended.returncode in (0, 5), time.monotonic() - start


def survives(
    file: str, fault: Fault, tests: list[str], workers: int = 0, sound_s: float = 60
) -> bool:
    """Return whether all tests pass although the file has the fault. Without it, they
    take `sound_s` seconds.
    """
    source = (ROOT / file).read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        changed = Path(folder) / "changed.py"
        changed.write_text(fault.planted(source), encoding="utf-8")
        passed, _ = run_tests(
            tests, (ROOT / file, changed), workers, limit_s=PATIENCE * sound_s + 10
        )
    return passed


def sample(files: list[str], count: int, seed: int) -> list[tuple[str, Fault]]:
    """Choose faults of files at random, each with the same chance."""
    faults = [
        (file, fault)
        for file in files
        for fault in faults_of((ROOT / file).read_text(encoding="utf-8"))
    ]
    chosen = random.Random(seed).sample(faults, min(count, len(faults)))
    return sorted(chosen, key=lambda pair: (pair[0], pair[1].start))


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutation.tool", description=__doc__
    )
    parser.add_argument("files", nargs="*", help="Python files of icdgen")
    parser.add_argument(
        "--base",
        default="HEAD~1",
        help="revision to find changed files (default: %(default)s)",
    )
    parser.add_argument(
        "--sample", type=int, default=20, help="number of faults (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "-n", dest="workers", type=int, default=0, help="processes of pytest"
    )
    options = parser.parse_args(arguments)
    files = options.files or changed_since(options.base)
    chosen = sample(files, options.sample, options.seed)
    seconds: dict[tuple[str, ...], float] = {}
    survivors = 0
    for file, fault in chosen:
        tests = covering_tests(file)
        if tuple(tests) not in seconds:
            passed, took = run_tests(tests, workers=options.workers)
            if not passed:
                print(f"{file}: its tests fail without a fault")
                return 2
            seconds[tuple(tests)] = took
        if survives(file, fault, tests, options.workers, seconds[tuple(tests)]):
            survivors += 1
            print(f"{file}:{fault}", flush=True)
    print(f"{len(chosen)} faults in {len(files)} files, {survivors} not caught")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
