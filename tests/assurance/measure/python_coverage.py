"""``python -m tests.assurance.measure.python_coverage [--out FOLDER]``: what the golden
vectors execute of the generated Python.

The testee of the conformance run is asked everything that the vectors of messages and
of the protocol demand. Ends with status 1 if a line of what is made of the ICDs was not
executed, if there is a branch in it, or if an answer differs.
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
from tests.assurance.measure.measurement import Measured, share, total
from tests.conformance import run as messages
from tests.conformance import wire
from tests.conformance.build import execute
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import Language
from tests.conformance.languages import python as python_language

COMMAND = "python -m tests.assurance.measure.python_coverage"
_SAYS = (
    "What the golden vectors execute of the generated package, line by line. What is made of the ICDs are declarations: "
    "classes with fields, tables of facts, and functions without a branch, which is checked; so every line is every way. "
    "What type checkers alone read is not counted.",
    "Besides the testee of the conformance run a few lines ask each node for its link, for the message of every id and for "
    "one that it does not have. What encodes and "
    "decodes is compiled by the runtime from the declarations when it is first used. The runtime is the same for every ICD "
    "and has tests of its own, which are not counted here.",
)
_TYPES_ONLY = "TYPE_CHECKING"  # False whenever the program runs
_ASKED = "asked_by_id"
_BY_ID = """\
from importlib import import_module
from importlib.util import find_spec

for node, direction, id, length in {asked}:
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
    """The command of the testee, watched."""
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
    """Lines of each file and how many were executed, and what is wrong."""
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
            or path.stem == _ASKED
        ):
            continue
        lines = executable(path.read_text("utf-8"))
        name = path.relative_to(top).as_posix()
        rows.append((name, len(lines), len(lines & seen.get(str(path), set()))))
        if is_made(icd, name):
            wrong += [
                f"{name}:{line}: not executed"
                for line in sorted(lines - seen.get(str(path), set()))
            ]
            wrong += [
                f"{name}:{line}: a branch" for line in branches(path.read_text("utf-8"))
            ]
    return rows, wrong


def by_id(icd: Icd, built: Path) -> list[messages.Result]:
    """Asks each node for the message of every id."""
    top = built / "source" / "python"
    asked = [
        (node.name, direction.kind, getattr(one.model, name), one.model.length)
        for node in describe(icd).nodes
        for direction in node.directions
        for one, name in direction.messages
    ]
    package = next(top.glob("*/_base.py")).parent.name
    (top / f"{_ASKED}.py").write_text(
        _BY_ID.format(
            asked=asked, nodes=[node.name for node in icd.nodes], package=package
        ),
        "utf-8",
    )
    command = [
        sys.executable,
        traced.__file__,
        str(built / "out" / "lines.json"),
        str(top),
        _ASKED,
    ]
    execute("env", f"PYTHONPATH={top}", "PYTHONDONTWRITEBYTECODE=1", *command)
    return []


def executable(text: str) -> set[int]:
    """The lines of a source that there is something to execute in."""
    found: set[int] = set()
    codes = [compile(text, "", "exec")]
    while codes:
        code = codes.pop()
        found |= traced.lines_of(code)
        codes += [one for one in code.co_consts if hasattr(one, "co_lines")]
    for node in ast.walk(ast.parse(text)):
        if (
            isinstance(node, ast.If)
            and isinstance(node.test, ast.Name)
            and node.test.id == _TYPES_ONLY
        ):
            found -= set(range(node.lineno + 1, (node.end_lineno or node.lineno) + 1))
    return found


def branches(text: str) -> list[int]:
    """The lines in which one of several ways is taken."""
    found = (node for node in ast.walk(ast.parse(text)) if isinstance(node, _BRANCHES))
    return sorted(
        one.lineno
        for one in found
        if not (isinstance(one, ast.If) and _TYPES_ONLY in ast.unparse(one.test))
    )


def is_made(icd: Icd, name: str) -> bool:
    """Whether a file is made of the ICDs, and none of the runtime."""
    return any(f"/{node.name}/" in name for node in icd.nodes)


def measured(icd: Icd, rows: list[tuple[str, int, int]]) -> Measured:
    """The paper."""
    made = [row for row in rows if is_made(icd, row[0])]
    runtime = [row for row in rows if not is_made(icd, row[0])]
    facts = [
        ("Made of the ICDs: lines", share(total(made, 2), total(made, 1))),
        ("The runtime: lines", share(total(runtime, 2), total(runtime, 1))),
        ("Measured in", f"Python {sys.version.split()[0]}"),
    ]
    columns = ("file", "lines", "executed")
    title = "Coverage of the generated Python"
    return Measured(
        "coverage-python",
        title,
        _SAYS,
        "python",
        COMMAND,
        (),
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
    icd = icd_of(options.icds)
    with tempfile.TemporaryDirectory() as name:
        rows, wrong = measure(icd, Path(name))
    found = measured(icd, rows)
    print(found.write(icd, options.out))
    for key, value in found.facts:
        print(f"  {key}: {value}")
    print("\n".join(wrong[:40]), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
