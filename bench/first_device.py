"""From an empty folder to a device that answers: seconds of each step, as a person waits for them.  python bench/first_device.py"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial

ICDGEN = (sys.executable, "-m", "icdgen")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=9)
    runs = [once() for _ in range(parser.parse_args().runs)]
    print("| step | median, s | least, s |\n|---|---|---|")
    for name in runs[0]:
        seconds = [run[name] for run in runs]
        print(f"| {name} | {statistics.median(seconds):.2f} | {min(seconds):.2f} |")


def once() -> dict[str, float]:
    """Nothing is remembered from an earlier run."""
    with tempfile.TemporaryDirectory() as folder:
        env = {**os.environ, "ICDGEN_CACHE": os.path.join(folder, ".cache")}
        run = partial(subprocess.run, cwd=folder, env=env, check=True, stdout=subprocess.DEVNULL)
        times = {
            "icdgen init battery": timed(lambda: run([*ICDGEN, "init", "battery"])),
            "icdgen check": timed(lambda: run([*ICDGEN, "check"])),
            "icdgen --lang c": timed(lambda: run([*ICDGEN, "--lang", "c"])),
        }
        begin = time.perf_counter()
        simulator = subprocess.Popen(
            [*ICDGEN, "sim", "--tcp", "0"], cwd=folder, env=env, stdout=subprocess.PIPE, text=True
        )
        try:
            assert simulator.stdout is not None
            place = simulator.stdout.readline().strip()
            times["icdgen sim listens"] = time.perf_counter() - begin
            ask = [*ICDGEN, "monitor", "Status", "--once", "--port", place]
            times["icdgen monitor shows what it says"] = timed(lambda: run(ask))
        finally:
            simulator.kill()
            simulator.communicate()
        return times | {"all": sum(times.values())}


def timed(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


if __name__ == "__main__":
    main()
