"""Measure how time and memory of complete commands grow: with the number of fields of
an ICD, and with the greatest number of elements of an array of structs.

Usage::

    python bench/growth.py [--fields 1000 10000 100000] [--up-to 64 256 1024]
                           [--commands show check c python rust site]

The ICDs of the first table are those of `bench/large.py`. The second table takes UBX
NAV-SAT of `examples/devices/ublox` with another `up_to` of its satellites. Each figure
is the processor time of a process and its maximum memory, without cache.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from large import ROOT, write

UBLOX = ROOT / "examples" / "devices" / "ublox" / "ublox.yaml"
COMMANDS = ("show", "check", "c", "python", "rust", "site")


def arguments(command: str, icd: Path, out: Path) -> list[str]:
    """Return the command line for an ICD; `out` is a folder for its output."""
    lines = {
        "show": ["show", "--format", "json", "--icd", icd],
        "check": ["check", icd],
        "site": ["docs", "--out", out, icd],
    }
    line = lines.get(command, ["--lang", command, "--out", out, icd])
    return [sys.executable, "-m", "icdgen", *map(str, line)]


def measure(line: list[str]) -> tuple[float, float]:
    """Return the processor time of a command in seconds, and its maximum memory in MB."""
    environment = {
        name: value
        for name, value in os.environ.items()
        if name != "PYTHONDONTWRITEBYTECODE"
    }
    with subprocess.Popen(line, stdout=subprocess.DEVNULL, env=environment) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, line
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def row(title: str, icd: Path, commands: list[str], folder: Path) -> None:
    """Print a row of the table: all commands for an ICD."""
    cells = []
    for command in commands:
        seconds, megabytes = measure(
            arguments(command, icd, folder / f"{command}{time.monotonic_ns()}")
        )
        cells.append(f"{seconds:.2f} s, {megabytes:.0f} MB")
    print(f"| {title} | {' | '.join(cells)} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fields", type=int, nargs="*", default=[1000, 10000, 100000])
    parser.add_argument("--up-to", type=int, nargs="*", default=[64, 256, 1024])
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=COMMANDS)
    options = parser.parse_args()
    os.environ["ICDGEN_CACHE"] = "off"
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top)
        measure(
            arguments("site", UBLOX, folder / "first")
        )  # Python caches its compiled modules
        columns = options.commands
        print(f"| | {' | '.join(columns)} |\n|{'---|' * (len(columns) + 1)}")
        for fields in options.fields:
            row(
                f"{fields:,} fields",
                write(folder / f"fields{fields}", fields, newer=False),
                columns,
                folder,
            )
        text = UBLOX.read_text(encoding="utf-8")
        for most in options.up_to:
            icd = folder / f"up_to_{most}.yaml"
            wide = text.replace("bits: 8, name: numSvs", "bits: 16, name: numSvs")
            icd.write_text(
                wide.replace(
                    "count: numSvs, up_to: 64", f"count: numSvs, up_to: {most}"
                ),
                encoding="utf-8",
            )
            row(f"up_to {most:,}", icd, columns, folder)


if __name__ == "__main__":
    main()
