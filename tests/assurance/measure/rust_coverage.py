"""``python -m tests.assurance.measure.rust_coverage [--out FOLDER]``: the coverage of
the generated Rust by the golden vectors.

The testee of the conformance run, instrumented by rustc, runs all vectors of messages
and of the protocol; another program tests functions that only Rust has. The exit status
is 1 if a line of code that is generated from the ICDs is not executed, or if an answer
differs. The tool that reads the counts of rustc comes from a crate: ``cargo install
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
from tests.assurance.measure import rust_only
from tests.assurance.measure.measurement import MeasurementFile, share, total
from tests.conformance import run as messages
from tests.conformance import wire
from tests.conformance.build import execute
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import Language
from tests.conformance.languages import rust as rust_language

COMMAND = "python -m tests.assurance.measure.rust_coverage"
FLAGS = ("-C", "instrument-coverage")
_REMARKS = (
    "Coverage of the generated crate by the golden vectors, line by line, generic code in each form that is used. The crate is "
    "built without optimisation and instrumented by rustc. Lines without code to execute are not counted.",
    "The vectors are run by the testee of the conformance run and by a program for features of Rust only: physical values in "
    "single precision and as integers, messages as text and as data, buffers that are too small, dispatchers by every id. An "
    "executed line can still be wrong; therefore every answer of the testee was compared with the reference, and the trace "
    "lists the vectors that notice a change.",
    "The runtime is the same for every ICD and has tests of its own, which are not counted here.",
)
_LINE = re.compile(r" *(\d+)\| *(\d+)\|")

Lines = dict[str, Counter[int]]  # by file: how often each line was executed


def can_count() -> bool:
    """Return whether rustc has the runtime with which instrumented programs are linked.

    The rustc of Debian 12 does not have it.
    """
    with tempfile.TemporaryDirectory() as folder:
        (empty := Path(folder) / "empty.rs").write_text("fn main() {}\n", "utf-8")
        command = ["rustc", *FLAGS, "--out-dir", folder, str(empty)]
        return subprocess.run(command, capture_output=True).returncode == 0


def build(source: Path, out: Path) -> list[str]:
    """Return the command of the instrumented testee."""
    # Cargo reads the flags of rustc from this variable.
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


def run_program_of_rust_only(icd: Icd, source: Path, out: Path) -> Path:
    """Build and run the program for features of Rust only; return its path."""
    program, text = out / "rust_only", out / "rust_only.rs"
    text.write_text(rust_only.source(icd), "utf-8")
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
    execute(
        program, env={**os.environ, "LLVM_PROFILE_FILE": str(out / "rust_only.profraw")}
    )
    return program


def measure(icd: Icd, folder: Path) -> tuple[Lines, Path, list[str]]:
    """Return the counts of each file, the folder of the crate's sources, and errors."""
    language = Language("rust-coverage", rust_language.BACKENDS, (), build)
    results = (
        *messages.run([language], icd, vectors_of(icd), 0, 1, folder),
        *wire.run([language], icd, wire.vectors_of(icd), folder),
    )
    built = next(folder.glob("rust-coverage-*"))
    out, source = built / "out", built / "source" / "rust" / "src"
    counts: Lines = defaultdict(Counter)
    for program, profiles in (
        (out / "debug" / "testee", "testee-*.profraw"),
        (run_program_of_rust_only(icd, source, out), "rust_only.profraw"),
    ):
        collect(counts, program, sorted(out.glob(profiles)), source)
    return counts, source, [text for result in results for text in result.shown]


def collect(counts: Lines, program: Path, profiles: list[Path], source: Path) -> None:
    """Add the counts that the runs of a program have for the sources in a folder."""
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
            counts[name][int(match[1])] += int(match[2])


def is_generated_from_icds(name: str) -> bool:
    """Return whether a file is generated from the ICDs and does not belong to the
    runtime.
    """
    return not name.startswith(("support/", "wire/")) or name.startswith("wire/links/")


def gaps(counts: Lines, source: Path) -> Iterator[str]:
    """Yield lines that are generated from the ICDs and were not executed."""
    for name, lines in sorted(counts.items()):
        text = (source / name).read_text("utf-8").split("\n")
        missed = (
            number
            for number, count in sorted(lines.items())
            if not count and is_generated_from_icds(name)
        )
        yield from (
            f"{name}:{number}: not executed: {text[number - 1].strip()}"
            for number in missed
        )


def measurement_file(counts: Lines) -> MeasurementFile:
    """Return the coverage as a measurement."""
    rows = [
        (name, len(lines), sum(map(bool, lines.values())))
        for name, lines in sorted(counts.items())
    ]
    generated = [row for row in rows if is_generated_from_icds(row[0])]
    runtime = [row for row in rows if not is_generated_from_icds(row[0])]
    facts = [
        (
            "Generated from the ICDs: lines",
            share(total(generated, 2), total(generated, 1)),
        ),
        ("The runtime: lines", share(total(runtime, 2), total(runtime, 1))),
    ]
    columns = ("file", "lines", "executed")
    title = "Coverage of the generated Rust"
    return MeasurementFile(
        "coverage-rust",
        title,
        _REMARKS,
        "rust",
        COMMAND,
        ("rustc",),
        columns,
        [*generated, *runtime],
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
        counts, source, wrong = measure(icd, Path(name))
        wrong += gaps(counts, source)
    file = measurement_file(counts)
    print(file.write(icd, options.out))
    for key, value in file.facts:
        print(f"  {key}: {value}")
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
