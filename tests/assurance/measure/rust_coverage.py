"""``python -m tests.assurance.measure.rust_coverage [--out FOLDER]``: what the golden
vectors execute of the generated Rust.

The testee of the conformance run, instrumented by rustc, is asked everything that the
vectors of messages and of the protocol demand, and a program asks what only Rust has.
Ends with status 1 if a line of what is made of the ICDs was not executed, or if an
answer differs. The tools that read what rustc counts come from a crate: ``cargo install
llvm_profparser``.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

from icdgen.backends.rust import CRATE
from icdgen.icd.model import Icd
from tests.assurance.measure import rust_rest
from tests.assurance.measure.measurement import Measured, share, total
from tests.conformance import run as messages
from tests.conformance import wire
from tests.conformance.build import execute
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import Language
from tests.conformance.languages import rust as rust_language

COMMAND = "python -m tests.assurance.measure.rust_coverage"
FLAGS = ("-C", "instrument-coverage")
_SAYS = (
    "What the golden vectors execute of the generated crate, line by line, generic code in each form that is used. Built "
    "without optimisation and instrumented by rustc; lines in which there is nothing to execute are not counted.",
    "The vectors are asked by the testee of the conformance run and by a program that asks what only Rust has: physical values "
    "in single precision and as whole numbers, messages as text and as data, buffers that are too small, dispatchers by every "
    "id. That a line is executed does not show that it is right: every answer of the testee was compared with the "
    "reference, and the trace says which vectors notice a change.",
    "The runtime is the same for every ICD and has tests of its own, which are not counted here.",
)
_LINE = re.compile(r" *(\d+)\| *(\d+)\|")

Lines = dict[str, Counter[int]]  # by file: how often each line was executed


def can_count() -> bool:
    """Whether rustc has what instrumented programs are linked with; that of Debian 12
    has not.
    """
    with tempfile.TemporaryDirectory() as folder:
        (empty := Path(folder) / "empty.rs").write_text("fn main() {}\n", "utf-8")
        command = ["rustc", *FLAGS, "--out-dir", folder, str(empty)]
        return subprocess.run(command, capture_output=True).returncode == 0


def build(source: Path, out: Path) -> list[str]:
    """The command of the testee, instrumented."""
    before = os.environ.get("RUSTFLAGS")
    os.environ["RUSTFLAGS"] = " ".join(FLAGS)
    try:
        rust_language.build(source, out, "dev")
    finally:
        os.environ.pop("RUSTFLAGS")
        os.environ.update({} if before is None else {"RUSTFLAGS": before})
    return [
        "env",
        f"LLVM_PROFILE_FILE={out / 'testee-%p.profraw'}",
        str(out / "debug" / "testee"),
    ]


def rest(icd: Icd, source: Path, out: Path) -> Path:
    """Builds and runs the program that asks the rest; it."""
    program, text = out / "rest", out / "rest.rs"
    text.write_text(rust_rest.source(icd), "utf-8")
    rustc = ("rustc", "--edition", "2021", *FLAGS)
    execute(
        *rustc,
        "--crate-name",
        CRATE,
        "--crate-type",
        "lib",
        "--out-dir",
        out,
        source / "lib.rs",
    )
    execute(
        *rustc, "--extern", f"{CRATE}={out / f'lib{CRATE}.rlib'}", "-o", program, text
    )
    execute(program, env={**os.environ, "LLVM_PROFILE_FILE": str(out / "rest.profraw")})
    return program


def measure(icd: Icd, folder: Path) -> tuple[Lines, Path, list[str]]:
    """How often each line of each file was executed; the folder of the crate's sources;
    what is wrong.
    """
    language = Language("rust-coverage", rust_language.BACKENDS, (), build)
    results = (
        *messages.run([language], icd, vectors_of(icd), 0, 1, folder),
        *wire.run([language], icd, wire.vectors_of(icd), folder),
    )
    built = next(folder.glob("rust-coverage-*"))
    out, source = built / "out", built / "source" / "rust" / "src"
    found: Lines = defaultdict(Counter)
    for program, profiles in (
        (out / "debug" / "testee", "testee-*.profraw"),
        (rest(icd, source, out), "rest.profraw"),
    ):
        collect(found, program, sorted(out.glob(profiles)), source)
    return found, source, [text for result in results for text in result.shown]


def collect(found: Lines, program: Path, profiles: list[Path], source: Path) -> None:
    """Adds what the runs of a program executed of the sources in a folder."""
    given = [word for profile in profiles for word in ("--instr-profile", profile)]
    name = None
    for line in execute("cov", "show", "--object", program, *given).splitlines():
        if line.startswith("/"):
            path = Path(line.strip())
            name = (
                path.relative_to(source).as_posix()
                if path.is_relative_to(source)
                else None
            )
        elif name is not None and (match := _LINE.match(line)):
            found[name][int(match[1])] += int(match[2])


def is_made(name: str) -> bool:
    """Whether a file is made of the ICDs, and none of the runtime."""
    return not name.startswith(("support/", "wire/")) or name.startswith("wire/links/")


def gaps(found: Lines, source: Path) -> Iterator[str]:
    """Lines that are made of the ICDs and were not executed."""
    for name, lines in sorted(found.items()):
        text = (source / name).read_text("utf-8").split("\n")
        missed = (
            number
            for number, count in sorted(lines.items())
            if not count and is_made(name)
        )
        yield from (
            f"{name}:{number}: not executed: {text[number - 1].strip()}"
            for number in missed
        )


def measured(found: Lines) -> Measured:
    """The paper."""
    rows = [
        (name, len(lines), sum(map(bool, lines.values())))
        for name, lines in sorted(found.items())
    ]
    made = [row for row in rows if is_made(row[0])]
    runtime = [row for row in rows if not is_made(row[0])]
    facts = [
        ("Made of the ICDs: lines", share(total(made, 2), total(made, 1))),
        ("The runtime: lines", share(total(runtime, 2), total(runtime, 1))),
    ]
    columns = ("file", "lines", "executed")
    title = "Coverage of the generated Rust"
    return Measured(
        "coverage-rust",
        title,
        _SAYS,
        "rust",
        COMMAND,
        ("rustc",),
        columns,
        [*made, *runtime],
        facts,
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
    if missing := [
        tool for tool in ("cargo", "rustc", "cov") if shutil.which(tool) is None
    ]:
        parser.error(
            f"not installed: {', '.join(missing)} (cov comes with: cargo install llvm_profparser)"
        )
    if not can_count():
        parser.error(
            "rustc was built without the profiler's runtime: install it with rustup"
        )
    icd = icd_of(options.icds)
    with tempfile.TemporaryDirectory() as name:
        found, source, wrong = measure(icd, Path(name))
        wrong += gaps(found, source)
    paper = measured(found)
    print(paper.write(icd, options.out))
    for key, value in paper.facts:
        print(f"  {key}: {value}")
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
