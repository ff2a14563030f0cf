"""Measure each step from an empty folder to a responding device: waiting time and
processor time.

python bench/first_device.py
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial

MONITOR = "icdgen monitor shows what it says"
ICDGEN = (sys.executable, "-m", "icdgen")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=9)
    runs = [run_all_steps() for _ in range(parser.parse_args().runs)]
    print("| step | median, s | least, s | of the processor, s |\n|---|---|---|---|")
    for name in runs[0]:
        waited, busy = zip(*(run[name] for run in runs), strict=True)
        print(
            f"| {name} | {statistics.median(waited):.2f} | {min(waited):.2f} | {statistics.median(busy):.2f} |"
        )


Times = tuple[float, float]


def run_all_steps() -> dict[str, Times]:
    """Run all steps with an empty cache, and return their times."""
    with tempfile.TemporaryDirectory() as folder:
        env = {**os.environ, "ICDGEN_CACHE": os.path.join(folder, ".cache")}
        run = partial(
            subprocess.run, cwd=folder, env=env, check=True, stdout=subprocess.DEVNULL
        )
        times = {
            "icdgen init battery": timed(lambda: run([*ICDGEN, "init", "battery"])),
            "icdgen check": timed(lambda: run([*ICDGEN, "check"])),
            "icdgen --lang c": timed(lambda: run([*ICDGEN, "--lang", "c"])),
        }
        begin, before = time.perf_counter(), processor()
        simulator = subprocess.Popen(
            [*ICDGEN, "sim", "--tcp", "0"],
            cwd=folder,
            env=env,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert simulator.stdout is not None
            place = simulator.stdout.readline().strip()
            listens = time.perf_counter() - begin
            ask = [*ICDGEN, "monitor", "Status", "--once", "--port", place]
            times[MONITOR] = timed(lambda: run(ask))
        finally:
            simulator.kill()
            simulator.communicate()
        monitor = times.pop(MONITOR)
        times["icdgen sim listens"] = listens, processor() - before - monitor[1]
        times[MONITOR] = monitor
        return times | {
            "all": (
                sum(wall for wall, _ in times.values()),
                sum(busy for _, busy in times.values()),
            )
        }


def timed(call: Callable[[], object]) -> Times:
    begin, before = time.perf_counter(), processor()
    call()
    return time.perf_counter() - begin, processor() - before


def processor() -> float:
    """Return the processor time of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
