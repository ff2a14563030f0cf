"""Measure time and memory of `icdgen import` for a manual, and the share of each stage.

python bench/import_manual.py MANUAL.pdf [--profile NAME] [--jobs N] [--where] [--explore]

Before it, prints the processor time of pdfminer alone, in one process.
"""

from __future__ import annotations

import argparse
import cProfile
import os
import pstats
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STAGES = {
    "pdfminer: content streams": ("pdfinterp.py", "execute"),
    "pdfplumber: words": ("text.py", "extract_words"),
    "pages to words and rules, those two included": ("extract.py", "extract"),
    "pages to pieces of tables": ("flow.py", "items"),
    "pieces to tables": ("tables.py", "run"),
    "tables to messages": ("interpret.py", "interpret"),
    "messages to ICDs": ("assemble.py", "assemble"),
    "YAML, read back": ("emit.py", "text"),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("manual", type=Path)
    parser.add_argument("--profile")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--where", action="store_true", help="where the time goes, in one process"
    )
    parser.add_argument(
        "--explore", action="store_true", help="list the kinds of tables, write no ICD"
    )
    options = parser.parse_args()
    if options.where:
        measure_stages(options.manual, options.profile)
    else:
        measure_pdfminer(options.manual)
        measure_command(options.manual, options.profile, options.jobs, options.explore)


def measure_pdfminer(manual: Path) -> None:
    """Measure pdfminer alone, which groups the characters of a page to lines."""
    from pdfminer.high_level import extract_pages

    start = time.process_time()
    count = sum(1 for _ in extract_pages(manual))
    seconds = time.process_time() - start
    print(f"pdfminer alone: {seconds:.1f} s processor, {count} pages")


def measure_command(
    manual: Path, profile: str | None, jobs: int, explore: bool
) -> None:
    """Measure the command as a user runs it: wall time, processor time, and memory of
    the largest process and of all processes.
    """
    with tempfile.TemporaryDirectory() as folder:
        words = ["--profile", profile] if profile else []
        target = ["--explore"] if explore else ["--out", folder]
        command = [
            sys.executable,
            "-m",
            "icdgen",
            "import",
            str(manual),
            *words,
            *target,
            "--jobs",
            str(jobs),
        ]
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        together = 0
        while process.poll() is None:
            together = max(
                together, sum(_resident(pid) for pid in _family(process.pid))
            )
            time.sleep(0.1)
        wall = time.perf_counter() - start
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"{jobs} processes: {wall:.1f} s wall, {usage.ru_utime + usage.ru_stime:.1f} s processor"
    )
    print(
        f"largest process {usage.ru_maxrss / 1024:.0f} MB, all together {together / 2**20:.0f} MB"
    )


def _family(pid: int) -> list[int]:
    """Return the ids of a process and its descendants, from Linux's /proc."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return [pid]
    return [
        pid,
        *(descendant for child in children for descendant in _family(int(child))),
    ]


def _resident(pid: int) -> int:
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf(
            "SC_PAGE_SIZE"
        )
    except (OSError, IndexError):
        return 0


def measure_stages(manual: Path, profile: str | None) -> None:
    """Print the share of each stage, in one process under a profiler."""
    from icdgen.icd.fmt import emit
    from icdgen.importer import profile as profiles
    from icdgen.importer import run

    words = profiles.load(profiles.find(profile))
    profiler = cProfile.Profile()
    profiler.enable()
    _, trees = run.run(manual, words, jobs=1)
    for tree in trees.values():
        emit.canonical_yaml(tree)
    profiler.disable()
    statistics = pstats.Stats(profiler)
    time_by_function = {
        (os.path.basename(file), name): row[3]
        for (file, _, name), row in statistics.stats.items()
    }
    for stage, key in STAGES.items():
        print(f"{time_by_function.get(key, 0.0) / statistics.total_tt:6.1%}  {stage}")


if __name__ == "__main__":
    main()
