"""``python -m tests.assurance.measure.coverage [--out FOLDER]``: the coverage of the
generated C by the golden vectors.

Two programs are built with gcc for coverage: the testee of the conformance run, which
runs all vectors of messages and of the protocol, and one for functions that only C has.
The exit status is 1 if a line or a branch of code that is generated from the ICDs is
not executed without a known reason, or if an answer differs. Gaps of the runtime are
only listed.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path

import yaml

from icdgen.icd.model import Icd
from tests.assurance.measure import c_only
from tests.assurance.measure.measurement import MeasurementFile, share, total
from tests.conformance import run as messages
from tests.conformance import wire
from tests.conformance.build import execute
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import Language
from tests.conformance.languages import c as c_language

COMMAND = "python -m tests.assurance.measure.coverage"
FLAGS = ("-O0", "--coverage", "-fkeep-inline-functions", "-fkeep-static-functions")
SUPPORT = ("icdgen.h", "icdgen_wide.h")
REASONS = Path(__file__).parent / "reasons.yaml"
_REMARKS = (
    "Coverage of the generated C headers and of the runtime by the golden vectors. Every function of every header is "
    "counted, called or not. The code is built without optimisation. A branch is one outcome of a condition, and each "
    "operand of && and || is a condition. No decision of the generated code mixes && and ||, so that both outcomes of each "
    "condition are what MC/DC requires.",
    "The vectors are run by the testee of the conformance run and by a program for features of C only: physical values as "
    "integers, buffers that are too small, dispatchers by every id, the typed client. An executed line can still be wrong; "
    "therefore every answer was compared with the reference, and the trace lists the vectors that notice a change.",
    "The runtime, icdgen.h and the wire layer, is the same for every ICD. It has tests of its own, which are not counted "
    "here. Lines that only these tests execute, such as its checks of arguments, are among the gaps without a reason.",
)


@dataclass
class Executed:
    """Execution counts of a file: of each line, each outcome of its conditions and each
    function.
    """

    lines: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    branches: dict[tuple[int, int], int] = field(
        default_factory=lambda: defaultdict(int)
    )
    functions: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    function_of: dict[int, str] = field(default_factory=dict)  # by line


def measure(icd: Icd, folder: Path) -> tuple[dict[str, Executed], Path, list[str]]:
    """Return the counts by file, the folder of the generated code, and wrong answers."""
    language = Language(
        "c-coverage",
        c_language.BACKENDS,
        ("gcc",),
        partial(c_language.build, compiler="gcc", flags=FLAGS),
    )
    wrong = []
    for result in (
        *messages.run([language], icd, vectors_of(icd), 0, 1, folder),
        *(wire.run([language], icd, wire.vectors_of(icd), folder)),
    ):
        wrong += result.shown
    built = next(folder.glob("c-coverage-*"))
    program = built / "out" / "c_only"
    text = built / "source" / "c_only.c"
    text.write_text(c_only.source(icd), "utf-8")
    execute(
        "gcc", "-std=c99", *FLAGS, "-I", built / "source" / "c", text, "-o", program
    )
    done = subprocess.run([program], capture_output=True, text=True)
    wrong += [done.stdout] if done.returncode else []
    return (
        collected(built / "out", built / "source" / "c"),
        built / "source" / "c",
        wrong,
    )


def collected(out: Path, source: Path) -> dict[str, Executed]:
    """Return the counts that gcov reports for all objects of a folder together."""
    executed: dict[str, Executed] = defaultdict(Executed)
    for data in sorted(out.glob("*.gcda")):
        done = subprocess.run(
            ["gcov", "--json-format", "--stdout", "-b", data.name],
            cwd=out,
            capture_output=True,
            text=True,
        )
        files = (json.loads(text)["files"] for text in done.stdout.splitlines())
        for file in chain.from_iterable(files):
            path = Path(file["file"])
            if not path.is_relative_to(source):
                continue
            counts = executed[path.relative_to(source).as_posix()]
            for function in file["functions"]:
                counts.functions[function["name"]] += function["execution_count"]
            for row in file["lines"]:
                number = row["line_number"]
                counts.lines[number] += row["count"]
                counts.function_of[number] = row.get("function_name", "")
                # gcov lists the outcomes of the conditions of a line without names.
                for index, branch in enumerate(row["branches"]):
                    counts.branches[number, index] += branch["count"]
    return dict(executed)


def gaps(
    executed: dict[str, Executed], source: Path
) -> list[tuple[str, int, str, str, str, str]]:
    """Return file, line, function, kind, text and reason of each gap, in order.

    The reason is empty if ``reasons.yaml`` has no entry for the gap.
    """
    reasons = yaml.safe_load(REASONS.read_text("utf-8"))
    rows = []
    for name, counts in sorted(executed.items()):
        text = (source / name).read_text("utf-8").split("\n")
        missed = {number: "line" for number, count in counts.lines.items() if not count}
        for (number, _), count in counts.branches.items():
            if not count:
                missed.setdefault(number, "branch")
        for number, kind in sorted(missed.items()):
            text_of_line, function = (
                text[number - 1].strip(),
                counts.function_of[number],
            )
            reason = next(
                (
                    row["why"]
                    for row in reasons
                    if _is_about(row, name, function, kind, text_of_line)
                ),
                "",
            )
            # The support header is the same for all ICDs, so that some of its functions
            # have no callers.
            if not counts.functions.get(function, 1) and name in SUPPORT:
                reason = (
                    reason or "No code generated from these ICDs calls the function."
                )
            rows.append((name, number, function, kind, text_of_line, reason))
    return rows


def _is_about(
    reason: dict[str, str], file: str, function: str, kind: str, text: str
) -> bool:
    gap = {"file": file, "function": function, "what": kind, "text": text}
    return all(
        re.fullmatch(reason[key], value) for key, value in gap.items() if key in reason
    )


def mixed(source: Path) -> list[str]:
    """Return decisions that mix && and ||, in code that is generated from the ICDs."""
    decisions = []
    for path in sorted(source.rglob("*.h")):
        if path.name.startswith("icdgen"):
            continue
        code = re.sub(r"/\*.*?\*/", "", path.read_text("utf-8"), flags=re.S)
        for statement in re.split(r"[;{}]", code):
            if "&&" in statement and "||" in statement:
                decisions.append(f"{path.name}: {statement.strip()}")
    return decisions


def measurements(executed: dict[str, Executed], source: Path) -> list[MeasurementFile]:
    """Return the coverage by file, and the gaps."""
    rows = []
    for name, counts in sorted(
        executed.items(), key=lambda item: (item[0].startswith("icdgen"), item[0])
    ):
        taken = [
            sum(map(bool, part.values()))
            for part in (counts.functions, counts.lines, counts.branches)
        ]
        sizes = [
            len(part) for part in (counts.functions, counts.lines, counts.branches)
        ]
        rows.append(
            (
                name,
                *(number for pair in zip(sizes, taken, strict=True) for number in pair),
            )
        )
    columns = ("file", "functions", "called", "lines", "executed", "branches", "taken")
    facts = []
    for kind, rows_of_kind in (
        (
            "Generated from the ICDs",
            [row for row in rows if not row[0].startswith("icdgen")],
        ),
        ("The runtime", [row for row in rows if row[0].startswith("icdgen")]),
    ):
        for at, what in ((1, "functions"), (3, "lines"), (5, "branches")):
            facts.append(
                (
                    f"{kind}: {what}",
                    share(total(rows_of_kind, at + 1), total(rows_of_kind, at)),
                )
            )
    missing = gaps(executed, source)
    of_gaps = ("file", "line", "function", "not taken", "text", "why")
    return [
        MeasurementFile("coverage-c", "Coverage of the generated C", _REMARKS, "c", COMMAND, ("gcc", "gcov"), columns, rows, facts),
        MeasurementFile(
            "coverage-c-gaps", "Coverage of the generated C: gaps", _ON_GAPS, "c", COMMAND, ("gcc", "gcov"), of_gaps,
            list(missing), [("Not executed, with a reason", str(sum(bool(row[5]) for row in missing))),
                            ("Not executed, without", str(sum(not row[5] for row in missing)))],
        ),
    ]  # fmt: skip


_ON_GAPS = (
    "Each line that the vectors do not execute, and each condition of which only one outcome occurs, with the reason.",
)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog=COMMAND, description=__doc__)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("measured"),
        help="folder to write to (default: %(default)s)",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    if missing := [tool for tool in ("gcc", "gcov") if shutil.which(tool) is None]:
        parser.error(f"not installed: {', '.join(missing)}")
    icd = icd_of(options.icds)
    with tempfile.TemporaryDirectory() as name:
        executed, source, wrong = measure(icd, Path(name))
        files = measurements(executed, source)
        wrong += [f"&& and || are mixed: {text}" for text in mixed(source)]
    for file in files:
        print(file.write(icd, options.out))
        for key, value in file.facts:
            print(f"  {key}: {value}")
    wrong += [
        f"{row[0]}:{row[1]}: {row[3]} not executed without a known reason: {row[4]}"
        for row in files[1].rows
        if not row[5] and not str(row[0]).startswith("icdgen")
    ]
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
