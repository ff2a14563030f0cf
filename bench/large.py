"""Measure how time grows with the size of an ICD: comparison of two releases, and
golden vectors, for thousands of fields.

Usage::

    python bench/large.py [--fields 3000 10000 30000] [--command] [--diff] [--vectors]

Each message has 40 fields. In the newer release a tenth of the messages has another
name, and in every third message a field is renamed or scaled differently. With --every,
all fields have another factor, or all messages another name. Times are processor times:
of the complete command `icdgen diff` without cache, and of the comparison alone. With
--runs, the minimum of several runs is printed.
"""

from __future__ import annotations

import argparse
import gc
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "codegen")]

from icdgen.diff import report  # noqa: E402
from icdgen.diff.inputs.side import ComparisonSide  # noqa: E402
from icdgen.loading import load  # noqa: E402
from icdgen.vectors.make import make_vectors  # noqa: E402
from icdgen.vectors.write import vector_file_text  # noqa: E402

PER_MESSAGE = 40
PER_NODE = 250  # messages: an id is a byte
_HEAD = "icdgen: 1\nnode: {name: %s, title: T, byte_order: little, bit_order: lsb0}\nmessages:\n"


def write(folder: Path, fields: int, newer: bool, every: str | None = None) -> Path:
    """Write a folder of ICDs with ``fields`` fields, and return it."""
    folder.mkdir()
    messages = fields // PER_MESSAGE
    for node in range((messages + PER_NODE - 1) // PER_NODE):
        here = range(node * PER_NODE, min(messages, (node + 1) * PER_NODE))
        text = _HEAD % f"node{node}" + "".join(
            _message(number, node, newer) for number in here
        )
        if newer:
            text = text.replace(
                *{
                    "factor": ("raw*0.01", "raw*0.03"),
                    "name": ("Sensor Data", "Reading"),
                }.get(every, ("", ""))
            )
        (folder / f"node{node}.yaml").write_text(text, encoding="utf-8")
    return folder


def _message(number: int, node: int, newer: bool) -> str:
    moved = newer and number % 10 == 3
    name = f"Sampled Set {number}" if moved else f"Sensor Data {number}"
    lines = [f"  - name: {name}", f"    id: {number % PER_NODE}", "    kind: telemetry"]
    lines += [f"    length: {2 * PER_MESSAGE}", "    fields:"]
    for index in range(PER_MESSAGE):
        changed = newer and number % 3 == 0 and index == number % PER_MESSAGE
        field = (
            f"Renamed Value {index}"
            if changed and number % 2
            else f"Channel {index} of {number}"
        )
        factor = "0.02" if changed and not number % 2 else "0.01"
        lines.append(
            f"      - {{at: {16 * index}, bits: 16, name: {field}, type: int, unit: C, formula: raw*{factor}}}"
        )
    return "\n".join(lines) + "\n"


def seconds(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def command_seconds(*words: object) -> float:
    """Return the processor time of an `icdgen` command.

    Python caches its compiled modules, as it does for a user.
    """
    environment = {
        name: value
        for name, value in os.environ.items()
        if name != "PYTHONDONTWRITEBYTECODE"
    }
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-m", "icdgen", *map(str, words)],
        stdout=subprocess.DEVNULL,
        env=environment,
        check=True,
    )
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime


def _compare(sides: list[ComparisonSide], results: list[report.DiffReport]) -> None:
    results.append(report.make_report(*sides))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fields", type=int, nargs="+", default=[3000, 10000, 30000])
    parser.add_argument(
        "--every", choices=["factor", "name"], help="change this everywhere"
    )
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--command", action="store_true")
    parser.add_argument("--diff", action="store_true")
    parser.add_argument("--vectors", action="store_true")
    options = parser.parse_args()
    os.environ["ICDGEN_CACHE"] = "off"
    gc.disable()  # as the command line does
    everything = not (options.command or options.diff or options.vectors)
    with tempfile.TemporaryDirectory() as top:
        for fields in options.fields:
            gc.collect()
            folders = [
                write(
                    Path(top, f"{name}{fields}"), fields, name == "new", options.every
                )
                for name in ("old", "new")
            ]
            if options.command or everything:
                spent = min(
                    command_seconds("diff", *folders) for _ in range(options.runs)
                )
                print(f"icdgen diff, {fields} fields: {spent:.2f} s", flush=True)
            if not (options.diff or options.vectors or everything):
                continue
            sides = [
                ComparisonSide(folder.name, load([folder], check=False).icd)
                for folder in folders
            ]
            if options.diff or everything:
                results: list[report.DiffReport] = []
                spent = min(
                    seconds(partial(_compare, sides, results))
                    for _ in range(options.runs)
                )
                print(
                    f"diff, {fields} fields: {spent:.2f} s, {len(results[0].changes)} changes",
                    flush=True,
                )
            if options.vectors or everything:
                icd = sides[0].icd
                spent = seconds(
                    lambda icd=icd: [
                        vector_file_text(make_vectors(icd, node)) for node in icd.nodes
                    ]
                )
                print(
                    f"vectors, {fields} fields: {spent:.2f} s, {spent / fields * 1e3:.2f} ms a field",
                    flush=True,
                )


if __name__ == "__main__":
    main()
