"""``python -m tests.assurance.measure.coverage [--out FOLDER]``: what the golden
vectors execute of the generated C.

Two programs are built with gcc for coverage: the testee of the conformance run, which
is asked everything that the vectors of messages and of the protocol demand, and one
that asks what only C has. Ends with status 1 if a line or a branch of what is made of
the ICDs was not executed for a reason that is not known (gaps of the runtime are only
listed), or if an answer differs.
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
from pathlib import Path

import yaml

from icdgen.icd.model import Icd
from tests.assurance.measure import rest
from tests.assurance.measure.measurement import Measured, share, total
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
_SAYS = (
    "What the golden vectors execute of the generated C headers and of the runtime that they come with, each function of "
    "every header counted, called or not. Built without optimisation; a branch is one way out of a condition, and each "
    "operand of && and || is a condition of its own. No decision of the generated code mixes && and ||, so that both ways "
    "of each condition are what MC/DC asks for.",
    "The vectors are asked by the testee of the conformance run and by a program that asks what only C has: physical values "
    "as whole numbers, buffers that are too small, dispatchers by every id, the typed client. That a line is executed does "
    "not show that it is right: every answer was compared with the reference, and the trace says which vectors notice a "
    "change.",
    "The runtime, icdgen.h and the wire layer, is the same for every ICD and has tests of its own, which are not counted "
    "here: what only they execute, such as its checks of arguments, is among the gaps without a reason.",
)


@dataclass
class Executed:
    """How often each line of a file, each way out of its conditions and each function
    was taken.
    """

    lines: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    branches: dict[tuple[int, int], int] = field(
        default_factory=lambda: defaultdict(int)
    )
    functions: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    of: dict[int, str] = field(default_factory=dict)  # line -> function


def measure(icd: Icd, folder: Path) -> tuple[dict[str, Executed], Path, list[str]]:
    """What is executed, by file; the folder of the generated code; differences."""
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
    program = built / "out" / "rest"
    text = built / "source" / "rest.c"
    text.write_text(rest.source(icd), "utf-8")
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
    """What gcov says of all objects of a folder together."""
    found: dict[str, Executed] = defaultdict(Executed)
    for data in sorted(out.glob("*.gcda")):
        done = subprocess.run(
            ["gcov", "--json-format", "--stdout", "-b", data.name],
            cwd=out,
            capture_output=True,
            text=True,
        )
        for file in (
            one
            for text in done.stdout.splitlines()
            for one in json.loads(text)["files"]
        ):
            path = Path(file["file"])
            if not path.is_relative_to(source):
                continue
            one = found[path.relative_to(source).as_posix()]
            for function in file["functions"]:
                one.functions[function["name"]] += function["execution_count"]
            for row in file["lines"]:
                number = row["line_number"]
                one.lines[number] += row["count"]
                one.of[number] = row.get("function_name", "")
                for index, branch in enumerate(row["branches"]):
                    one.branches[number, index] += branch["count"]
    return dict(found)


def gaps(
    executed: dict[str, Executed], source: Path
) -> list[tuple[str, int, str, str, str, str]]:
    """File, line, function, what was not taken, the text and the reason (empty: not
    known), in order.
    """
    reasons = yaml.safe_load(REASONS.read_text("utf-8"))
    found = []
    for name, one in sorted(executed.items()):
        text = (source / name).read_text("utf-8").split("\n")
        missed = {number: "line" for number, count in one.lines.items() if not count}
        for (number, _), count in one.branches.items():
            if not count:
                missed.setdefault(number, "branch")
        for number, what in sorted(missed.items()):
            said, function = text[number - 1].strip(), one.of[number]
            why = next(
                (
                    row["why"]
                    for row in reasons
                    if _is_about(row, name, function, what, said)
                ),
                "",
            )
            if not one.functions.get(function, 1) and name in SUPPORT:
                why = why or "Nothing that is made of these ICDs calls the function."
            found.append((name, number, function, what, said, why))
    return found


def _is_about(
    reason: dict[str, str], file: str, function: str, what: str, said: str
) -> bool:
    asked = {"file": file, "function": function, "what": what, "text": said}
    return all(
        re.fullmatch(reason[key], value)
        for key, value in asked.items()
        if key in reason
    )


def mixed(source: Path) -> list[str]:
    """Decisions that mix && and ||, of what is made of the ICDs."""
    statements = (
        f"{path.name}: {statement.strip()}"
        for path in sorted(source.rglob("*.h"))
        if not path.name.startswith("icdgen")
        for statement in re.split(
            r"[;{}]", re.sub(r"/\*.*?\*/", "", path.read_text("utf-8"), flags=re.S)
        )
    )
    return [one for one in statements if "&&" in one and "||" in one]


def measurements(executed: dict[str, Executed], source: Path) -> list[Measured]:
    """Coverage by file, and the gaps."""
    rows = []
    for name, one in sorted(
        executed.items(), key=lambda item: (item[0].startswith("icdgen"), item[0])
    ):
        taken = [
            sum(map(bool, part.values()))
            for part in (one.functions, one.lines, one.branches)
        ]
        sizes = [len(part) for part in (one.functions, one.lines, one.branches)]
        rows.append(
            (
                name,
                *(number for pair in zip(sizes, taken, strict=True) for number in pair),
            )
        )
    columns = ("file", "functions", "called", "lines", "executed", "branches", "taken")
    facts = []
    for kind, some in (
        ("Made of the ICDs", [row for row in rows if not row[0].startswith("icdgen")]),
        ("The runtime", [row for row in rows if row[0].startswith("icdgen")]),
    ):
        for at, what in ((1, "functions"), (3, "lines"), (5, "branches")):
            facts.append(
                (f"{kind}: {what}", share(total(some, at + 1), total(some, at)))
            )
    missing = gaps(executed, source)
    of_gaps = ("file", "line", "function", "not taken", "text", "why")
    return [
        Measured("coverage-c", "Coverage of the generated C", _SAYS, "c", COMMAND, ("gcc", "gcov"), columns, rows, facts),
        Measured(
            "coverage-c-gaps", "Coverage of the generated C: what is not executed", _GAPS, "c", COMMAND, ("gcc", "gcov"), of_gaps,
            list(missing), [("Not executed, with a reason", str(sum(bool(row[5]) for row in missing))),
                            ("Not executed, without", str(sum(not row[5] for row in missing)))],
        ),
    ]  # fmt: skip


_GAPS = (
    "Each line that the vectors do not execute, or a condition of which only one way is taken, and why that is so.",
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
        found = measurements(executed, source)
        wrong += [f"&& and || are mixed: {one}" for one in mixed(source)]
    for one in found:
        print(one.write(icd, options.out))
        for key, value in one.facts:
            print(f"  {key}: {value}")
    wrong += [
        f"{row[0]}:{row[1]}: {row[3]} not executed, and nobody knows why: {row[4]}"
        for row in found[1].rows
        if not row[5] and not str(row[0]).startswith("icdgen")
    ]
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
