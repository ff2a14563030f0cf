"""Measure complete runs of ``icdgen`` for the shipped nodes: without cache, with cached
ICDs, and without changes.

Usage::

    python bench/generate.py [--runs 21] [--lang c ...]

Each figure is the processor time of whole processes, start of the interpreter included.
The minimum is also given as a multiple of bare Python. The variants take turns, so that
other load affects all of them equally.

Each run writes to a new folder: ext4 needs ten times as long to create a file if files
were just deleted, and a cold build deletes none. Python caches its compiled modules as
it does for a user, whatever the environment says.
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


def seconds(line: list[str], environment: dict[str, str]) -> float:
    """Return the processor time of a command in seconds."""
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=21)
    parser.add_argument("--lang", action="append")
    options = parser.parse_args()
    languages = options.lang or ["c"]
    with tempfile.TemporaryDirectory() as folder:
        numbers, empty = count(1), Path(folder, "empty")
        environment = {
            **os.environ,
            "PYTHONPYCACHEPREFIX": str(Path(folder, "pycache")),
        }
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        forgetting = {**environment, "ICDGEN_CACHE": str(empty)}
        remembering = {**environment, "ICDGEN_CACHE": str(Path(folder, "cache"))}
        program = shutil.which("icdgen", path=str(Path(sys.executable).parent))
        icdgen = [program] if program else [sys.executable, "-m", "icdgen"]
        icdgen += [word for language in languages for word in ("--lang", language)]

        def into(number: int) -> list[str]:
            return [*icdgen, "--out", str(Path(folder, f"out{number}"))]

        bare = [sys.executable, "-c", "pass"]
        rows: list[tuple[str, Callable[[], list[str]], dict[str, str]]] = [
            ("python -c pass", lambda: bare, environment),
            (
                "nothing remembered, all files written",
                lambda: into(next(numbers)),
                forgetting,
            ),
            (
                "ICDs validated before, all files written",
                lambda: into(next(numbers)),
                remembering,
            ),
            ("nothing to do", lambda: into(0), remembering),
        ]
        times: dict[str, list[float]] = {title: [] for title, _, _ in rows}
        for turn in range(options.runs + 1):
            for title, command, its_environment in rows:
                shutil.rmtree(empty, ignore_errors=True)
                spent = seconds(command(), its_environment)
                # The first turn fills the caches
                times[title] += [spent] if turn else []
        print(
            f"| {'+'.join(languages)}, {options.runs} runs | median, s | least, s | times bare Python |\n|---|---|---|---|"
        )
        for title, all_spent in times.items():
            least, times_bare = (
                min(all_spent),
                min(all_spent) / min(times["python -c pass"]),
            )
            print(
                f"| {title} | {statistics.median(all_spent):.3f} | {least:.3f} | {times_bare:.1f} |"
            )


if __name__ == "__main__":
    main()
