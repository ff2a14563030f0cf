"""``python -m tests.assurance.measure.python_coverage [--out FOLDER]``: the coverage of
the generated Python by the golden vectors.

The testee of the conformance run runs all vectors of messages and of the protocol. The
exit status is 1 if a line of code that is generated from the ICDs is not executed, if
it has a branch, or if an answer differs.
"""

from __future__ import annotations

import argparse
import ast
import json
import sys
import tempfile
from functools import partial
from pathlib import Path

from icdgen.describe import describe
from icdgen.icd.model import Icd
from tests.assurance.measure import traced
from tests.assurance.measure.measurement import MeasurementFile, share, total
from tests.conformance import run as messages
from tests.conformance import wire
from tests.conformance.build import execute
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import Language
from tests.conformance.languages import python as python_language

COMMAND = "python -m tests.assurance.measure.python_coverage"
_REMARKS = (
    "Coverage of the generated package by the golden vectors, line by line. The code of the ICDs has only declarations: "
    "classes with fields, tables of facts, and functions without a branch. This is checked, so that line coverage includes "
    "branch coverage. Lines for type checkers only are not counted.",
    "In addition to the testee of the conformance run, a small program requests from each node its link, the message of every "
    "id, and an unknown id. The runtime compiles encoders and decoders from the declarations when they are first used. It is "
    "the same for every ICD and has tests of its own, which are not counted here.",
)
_TYPES_ONLY = "TYPE_CHECKING"  # False whenever the program runs
_PROGRAM = "asked_by_id"
_BY_ID = """\
from importlib import import_module
from importlib.util import find_spec

for node, direction, id, length in {requests}:
    module = import_module("{package}." + node)
    assert set(module._HOMES) <= set(dir(module))
    message = getattr(module, "decode_" + direction)(id, bytes(length))
    assert id in message.IDS and message.LENGTH == length
for node in {nodes}:
    module = import_module("{package}." + node)
    if find_spec("{package}." + node + "._link"):
        assert import_module("{package}." + node + "._link").LINK.node == node
    for direction in ("telecommand", "telemetry"):
        try:
            getattr(module, "decode_" + direction)(-1, b"")
        except import_module("{package}").UnknownIdError:
            pass
"""
_BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.BoolOp, ast.Try, ast.Match)


def build(source: Path, out: Path) -> list[str]:
    """Return the command of the testee, run under the tracer."""
    # The command of the testee is `env ... python -m MODULE`.
    *env, interpreter, _, module = python_language.build(
        source, out, interpreter=sys.executable
    )
    return [
        *env,
        interpreter,
        traced.__file__,
        str(out / "lines.json"),
        str(source / "python"),
        module,
    ]


def measure(icd: Icd, folder: Path) -> tuple[list[tuple[str, int, int]], list[str]]:
    """Return the lines of each file, how many were executed, and errors."""
    language = Language("python-coverage", python_language.BACKENDS, (), partial(build))
    wrong, seen = [], {}
    for results in (
        lambda: messages.run([language], icd, vectors_of(icd), 0, 1, folder),
        lambda: wire.run([language], icd, wire.vectors_of(icd), folder),
        lambda: by_id(icd, next(folder.glob("python-coverage-*"))),
    ):
        wrong += [text for result in results() for text in result.shown]
        built = next(folder.glob("python-coverage-*"))
        for name, lines in json.loads(
            (built / "out" / "lines.json").read_text("utf-8")
        ).items():
            seen.setdefault(name, set()).update(lines)
    rows = []
    top = built / "source" / "python"
    own = {str(path) for path in (built / "source" / "python-testee").rglob("*.py")}
    for path in sorted(top.rglob("*.py")):
        if (
            str(built / "source" / "python-testee" / path.relative_to(top)) in own
            or path.stem == _PROGRAM
        ):
            continue
        lines = executable(path.read_text("utf-8"))
        name = path.relative_to(top).as_posix()
        rows.append((name, len(lines), len(lines & seen.get(str(path), set()))))
        if is_generated_from_icds(icd, name):
            wrong += [
                f"{name}:{line}: not executed"
                for line in sorted(lines - seen.get(str(path), set()))
            ]
            wrong += [
                f"{name}:{line}: a branch" for line in branches(path.read_text("utf-8"))
            ]
    return rows, wrong


def by_id(icd: Icd, built: Path) -> list[messages.Result]:
    """Decode a message of every id of each node."""
    top = built / "source" / "python"
    requests = [
        (node.name, direction.kind, getattr(message.model, name), message.model.length)
        for node in describe(icd).nodes
        for direction in node.directions
        for message, name in direction.messages
    ]
    package = next(top.glob("*/_base.py")).parent.name
    (top / f"{_PROGRAM}.py").write_text(
        _BY_ID.format(
            requests=requests, nodes=[node.name for node in icd.nodes], package=package
        ),
        "utf-8",
    )
    command = [
        sys.executable,
        traced.__file__,
        str(built / "out" / "lines.json"),
        str(top),
        _PROGRAM,
    ]
    execute("env", f"PYTHONPATH={top}", "PYTHONDONTWRITEBYTECODE=1", *command)
    return []


def executable(text: str) -> set[int]:
    """Return the lines of a source that have code to execute."""
    lines: set[int] = set()
    codes = [compile(text, "", "exec")]
    while codes:
        code = codes.pop()
        lines |= traced.lines_of(code)
        codes += [
            constant for constant in code.co_consts if hasattr(constant, "co_lines")
        ]
    for node in ast.walk(ast.parse(text)):
        if (
            isinstance(node, ast.If)
            and isinstance(node.test, ast.Name)
            and node.test.id == _TYPES_ONLY
        ):
            lines -= set(range(node.lineno + 1, (node.end_lineno or node.lineno) + 1))
    return lines


def branches(text: str) -> list[int]:
    """Return the lines with a branch."""
    return sorted(
        node.lineno
        for node in ast.walk(ast.parse(text))
        if isinstance(node, _BRANCHES)
        and not (isinstance(node, ast.If) and _TYPES_ONLY in ast.unparse(node.test))
    )


def is_generated_from_icds(icd: Icd, name: str) -> bool:
    """Return whether a file is generated from the ICDs and does not belong to the
    runtime.
    """
    return any(f"/{node.name}/" in name for node in icd.nodes)


def measurement_file(icd: Icd, rows: list[tuple[str, int, int]]) -> MeasurementFile:
    """Return the coverage as a measurement."""
    generated = [row for row in rows if is_generated_from_icds(icd, row[0])]
    runtime = [row for row in rows if not is_generated_from_icds(icd, row[0])]
    facts = [
        (
            "Generated from the ICDs: lines",
            share(total(generated, 2), total(generated, 1)),
        ),
        ("The runtime: lines", share(total(runtime, 2), total(runtime, 1))),
        ("Measured in", f"Python {sys.version.split()[0]}"),
    ]
    columns = ("file", "lines", "executed")
    title = "Coverage of the generated Python"
    return MeasurementFile(
        "coverage-python",
        title,
        _REMARKS,
        "python",
        COMMAND,
        (),
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
    icd = icd_of(options.icds)
    with tempfile.TemporaryDirectory() as name:
        rows, wrong = measure(icd, Path(name))
    file = measurement_file(icd, rows)
    print(file.write(icd, options.out))
    for key, value in file.facts:
        print(f"  {key}: {value}")
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
