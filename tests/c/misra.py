"""Compare violations of MISRA C:2012 in the C runtime and generated C with a record.

cppcheck's addon finds them. ``python -m tests.c.misra`` writes the current places to
the record, `runtime/c/misra.yaml`; the reasons for deviations are written by hand. The
tests check a sample of the messages.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import yaml

from icdgen.describe import describe
from icdgen.icd.model import Icd
from icdgen.icd.places import NodePlace
from tests.c import harness
from tests.conftest import ROOT

RUNTIME = ROOT / "runtime" / "c"
RECORD = RUNTIME / "misra.yaml"
# The checks of cppcheck itself stay off, since only those of the addon are used.
COMMAND = (
    "cppcheck",
    "--addon=misra",
    "--std=c99",
    "--platform=unix64",
    "--quiet",
)
GNUC = (
    "-D__GNUC__=12",
    "-D__x86_64__=1",
    "-D__BYTE_ORDER__=1",
    "-D__ORDER_LITTLE_ENDIAN__=1",
    "-DUINTPTR_MAX=0xFFFFFFFFFFFFFFFFu",
)
"""Macros of gcc that select the fast code of the support header, which needs words in
the byte order of the machine.
"""

_FINDING = re.compile(r"misra-c2012-(?P<rule>[\d.]+) (?P<file>\S+) (?P<at>\d+:\d+)")
_ORDER = ("rule", "category", "verdict", "reason", "runtime", "generated")

Places = dict[str, dict[str, Any]]
"""By rule: the number of violations in each file of the runtime, and the templates
whose output violates the rule.
"""


def findings(*arguments: str | Path) -> set[tuple[str, str, str]]:
    """Run cppcheck and return rule, file and position of each finding in a source."""
    done = subprocess.run(
        [
            *COMMAND,
            "--template=misra {id} {file} {line}:{column}",
            *map(str, arguments),
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return {
        (match["rule"], match["file"], match["at"])
        for match in _FINDING.finditer(done.stderr)
    }


def current_places(is_complete: bool = True) -> Places:
    """Find the violations in all messages, or only in those of `_sample`."""
    with tempfile.TemporaryDirectory() as folder:
        return places(_all(Path(folder), is_complete), Path(folder))


def _sample(icd: Icd) -> Iterator[str]:
    """Yield headers of a sample of messages, and of the nodes with few messages.

    The sample has the smallest messages that together cover each kind of field, and
    each combination of types that share a byte.
    """
    seen: set[object] = set()
    for node in describe(icd).nodes:
        for message in sorted(
            node.messages, key=lambda message: len(message.model.fields)
        ):
            new = _kinds(message.model.fields) - seen
            if new:
                seen |= new
                yield f"{node.name}/{message.name}.h"
        if len(node.messages) < 20:
            yield f"{node.name}.h"


def _kinds(fields: Iterable[NodePlace]) -> set[object]:
    kinds: set[object] = set()
    sharing: dict[int, Counter[str]] = defaultdict(Counter)
    for field in fields:
        kinds.add((field.type, field.bits, field.has_formula, field.at % 8 != 0))
        for byte in range(field.at // 8, (field.at + field.bits - 1) // 8 + 1):
            sharing[byte][field.type] += 1
    return kinds | {
        frozenset((type_, number > 1) for type_, number in types.items())
        for types in sharing.values()
    }


def _all(folder: Path, is_complete: bool) -> set[tuple[str, str, str]]:
    icd = harness.shipped()
    generated = harness.generate(icd, folder / "generated")
    wide, nodes = folder / "wide.c", folder / "nodes.c"
    wide.write_text(f'#include "{RUNTIME / "icdgen_wide.h"}"\n')
    headers = (f"{node.name}.h" for node in icd.nodes) if is_complete else _sample(icd)
    nodes.write_text(
        "".join(f'#include "{generated / header}"\n' for header in headers)
    )
    shared = "-DICDGEN_SHARED=1"
    rows = (
        findings(shared, wide)
        | findings(shared, *GNUC, wide)
        | findings(shared, RUNTIME / "icdgen_wire.c")
    )
    rows |= findings(shared, nodes)
    for link in sorted(generated.glob("*/link.c")):
        rows |= findings(shared, link)
    return rows


def places(rows: set[tuple[str, str, str]], folder: Path) -> Places:
    """Group findings by rule, and findings in generated C by template."""
    runtime: dict[str, Counter[str]] = defaultdict(Counter)
    generated: dict[str, set[str]] = defaultdict(set)
    for rule, file, _ in rows:
        path = Path(file)
        if path.is_relative_to(RUNTIME):
            runtime[rule][path.relative_to(RUNTIME).as_posix()] += 1
        elif not path.name.startswith(
            "icdgen"
        ):  # the support headers are copies of the runtime
            generated[rule].add(template(path.relative_to(folder / "generated")))
    return {
        rule: {
            "runtime": dict(sorted(runtime[rule].items())),
            "generated": sorted(generated[rule]),
        }
        for rule in runtime.keys() | generated.keys()
    }


def template(path: Path) -> str:
    """Return the name of the template of a generated file."""
    if path.name in ("enums.h", "link.h", "link.c", "client.h", "procedures.h"):
        return f"{path.name}.j2"
    return "message.h.j2" if len(path.parts) > 1 else "node.h.j2"


def record() -> list[dict[str, Any]]:
    """Return the entries of the record, one for each rule."""
    return list(yaml.safe_load(RECORD.read_text("utf-8"))["findings"])


def differences(recorded: list[dict[str, Any]], now: Places) -> list[str]:
    """Describe findings that are not recorded, and entries that are not found."""
    lines = []
    entries = {entry["rule"]: entry for entry in recorded}
    for rule in sorted(entries.keys() | now.keys(), key=_number):
        nothing: dict[str, Any] = {"runtime": {}, "generated": []}
        old, new = entries.get(rule, nothing), now.get(rule, nothing)
        for file in sorted(old["runtime"].keys() | new["runtime"].keys()):
            before, after = old["runtime"].get(file, 0), new["runtime"].get(file, 0)
            if before != after:
                lines.append(
                    f"{rule}: runtime/c/{file}: {before} in the record, {after} found"
                )
        lines += [
            f"{rule}: {name} is not in the record"
            for name in sorted(set(new["generated"]) - set(old["generated"]))
        ]
        lines += [
            f"{rule}: {name} is stale"
            for name in sorted(set(old["generated"]) - set(new["generated"]))
        ]
    return lines


def update() -> None:
    """Write the current places to the record; keep verdicts and reasons."""
    now = current_places()
    entries = {entry["rule"]: entry for entry in record()}
    text = RECORD.read_text("utf-8").partition("findings:")[0] + "findings:\n"
    for rule in sorted(now, key=_number):
        entry = {
            "rule": rule,
            "category": "",
            "verdict": "",
            "reason": "",
            **entries.get(rule, {}),
            **now[rule],
        }
        text += yaml.safe_dump(
            [{key: entry[key] for key in _ORDER}],
            sort_keys=False,
            width=140,
            allow_unicode=True,
        )
    RECORD.write_text(text, "utf-8")


def _number(rule: str) -> tuple[int, ...]:
    return tuple(map(int, rule.split(".")))


if __name__ == "__main__":
    update()
