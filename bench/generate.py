"""Start-to-end time of ``icdgen`` over all five nodes: nothing remembered, generating anew, and nothing to do.

    python bench/generate.py [--runs 21] [--lang c ...]

Each figure is the median of whole processes, interpreter start included, with its output thrown away.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path


def median(
    command: list[str], runs: int, environment: dict[str, str], before: Callable[[], None] = lambda: None
) -> float:
    """Median wall time in seconds."""
    times = []
    for _ in range(runs):
        before()
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=21)
    parser.add_argument("--lang", action="append")
    options = parser.parse_args()
    languages = options.lang or ["c"]
    with tempfile.TemporaryDirectory() as folder:
        out, cache = Path(folder, "out"), Path(folder, "cache")
        environment = {**os.environ, "ICDGEN_CACHE": str(cache)}
        program = shutil.which("icdgen", path=str(Path(sys.executable).parent))
        command = [program] if program else [sys.executable, "-m", "icdgen"]
        command += [word for language in languages for word in ("--lang", language)] + ["--out", str(out)]

        def forget() -> None:
            shutil.rmtree(cache, ignore_errors=True)
            shutil.rmtree(out, ignore_errors=True)

        def remove_output() -> None:
            shutil.rmtree(out, ignore_errors=True)

        rows = [
            ("python -c pass", [sys.executable, "-c", "pass"], lambda: None),
            ("nothing remembered, all files written", command, forget),
            ("ICDs validated before, all files written", command, remove_output),
            ("nothing to do", command, lambda: None),
        ]
        print(f"| {'+'.join(languages)}, median of {options.runs} | s |\n|---|---|")
        for title, line, before in rows:
            subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
            print(f"| {title} | {median(line, options.runs, environment, before):.3f} |", flush=True)


if __name__ == "__main__":
    main()
