"""Start-to-end time of ``icdgen`` over all five nodes: nothing remembered, generating anew, and nothing to do.

    python bench/generate.py [--runs 21] [--lang c ...]

Each figure is the processor's time of whole processes, interpreter start included, with their output thrown away; the least of
them is also given as a multiple of bare Python's. Every run writes to a folder that did not exist: ext4 takes ten times as long to
create a file where some have just been deleted, and a user's cold build deletes none. Python keeps its compiled modules, as it does
for a user, whatever the environment says.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from itertools import count
from pathlib import Path


def seconds(
    command: Callable[[], list[str]], runs: int, environment: dict[str, str], before: Callable[[], None]
) -> list[float]:
    """Seconds of the processor's time, after one run that is not counted."""
    times = []
    for _ in range(runs + 1):
        before()
        line = command()
        start = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime)
    return times[1:]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=21)
    parser.add_argument("--lang", action="append")
    options = parser.parse_args()
    languages = options.lang or ["c"]
    with tempfile.TemporaryDirectory() as folder:
        cache, numbers = Path(folder, "cache"), count()
        environment = {**os.environ, "ICDGEN_CACHE": str(cache), "PYTHONPYCACHEPREFIX": str(Path(folder, "pycache"))}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        program = shutil.which("icdgen", path=str(Path(sys.executable).parent))
        icdgen = [program] if program else [sys.executable, "-m", "icdgen"]
        icdgen += [word for language in languages for word in ("--lang", language)]

        def into(number: int) -> list[str]:
            return [*icdgen, "--out", str(Path(folder, f"out{number}"))]

        rows = [
            ("python -c pass", lambda: [sys.executable, "-c", "pass"], lambda: None),
            ("nothing remembered, all files written", lambda: into(next(numbers)), lambda: forget(cache)),
            ("ICDs validated before, all files written", lambda: into(next(numbers)), lambda: None),
            ("nothing to do", lambda: into(0), lambda: None),
        ]
        print(
            f"| {'+'.join(languages)}, {options.runs} runs | median, s | least, s | times bare Python |\n|---|---|---|---|"
        )
        bare = 0.0
        for title, command, before in rows:
            times = seconds(command, options.runs, environment, before)
            bare = bare or min(times)
            row = f"{statistics.median(times):.3f} | {min(times):.3f} | {min(times) / bare:.1f}"
            print(f"| {title} | {row} |", flush=True)


def forget(cache: Path) -> None:
    shutil.rmtree(cache, ignore_errors=True)


if __name__ == "__main__":
    main()
