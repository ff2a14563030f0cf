"""What cppcheck's addon finds of MISRA C:2012 in the runtime and in C made from the
shipped ICDs, held against the record.

``python -m tests.c.misra`` writes the places found into the record; what a rule is
deviated from for, you write. The tests look at a sample of the messages.
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
# The checks of cppcheck itself, of which nothing is used here, stay off.
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
"""What the faster ways through the support header ask for: words in the byte order of
the machine.
"""

_FINDING = re.compile(r"misra-c2012-(?P<rule>[\d.]+) (?P<file>\S+) (?P<at>\d+:\d+)")
_ORDER = ("rule", "category", "verdict", "reason", "runtime", "generated")

Places = dict[str, dict[str, Any]]
"""Of each rule: how often each file of the runtime breaks it, and what templates do."""


def findings(*arguments: str | Path) -> set[tuple[str, str, str]]:
    """Rule, file and place of each finding in a source."""
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


def found(whole: bool = True) -> Places:
    """What there is now; if not ``whole``, in fewer messages, see `_sample`."""
    with tempfile.TemporaryDirectory() as folder:
        return places(_all(Path(folder), whole), Path(folder))


def _sample(icd: Icd) -> Iterator[str]:
    """Headers of the smallest messages that have each kind of field and all types that
    share a byte, once or more often, and of the nodes with few messages.
    """
    seen: set[object] = set()
    for node in describe(icd).nodes:
        for message in sorted(node.messages, key=lambda one: len(one.model.fields)):
            new = _kinds(message.model.fields) - seen
            if new:
                seen |= new
                yield f"{node.name}/{message.name}.h"
        if len(node.messages) < 20:
            yield f"{node.name}.h"


def _kinds(fields: Iterable[NodePlace]) -> set[object]:
    kinds: set[object] = set()
    sharing: dict[int, Counter[str]] = defaultdict(Counter)
    for one in fields:
        kinds.add((one.type, one.bits, one.has_formula, one.at % 8 != 0))
        for byte in range(one.at // 8, (one.at + one.bits - 1) // 8 + 1):
            sharing[byte][one.type] += 1
    return kinds | {
        frozenset((type_, number > 1) for type_, number in types.items())
        for types in sharing.values()
    }


def _all(folder: Path, whole: bool) -> set[tuple[str, str, str]]:
    icd = harness.shipped()
    made = harness.generate(icd, folder / "made")
    wide, nodes = folder / "wide.c", folder / "nodes.c"
    wide.write_text(f'#include "{RUNTIME / "icdgen_wide.h"}"\n')
    headers = (f"{node.name}.h" for node in icd.nodes) if whole else _sample(icd)
    nodes.write_text("".join(f'#include "{made / header}"\n' for header in headers))
    shared = "-DICDGEN_SHARED=1"
    rows = (
        findings(shared, wide)
        | findings(shared, *GNUC, wide)
        | findings(shared, RUNTIME / "icdgen_wire.c")
    )
    rows |= findings(shared, nodes)
    for link in sorted(made.glob("*/link.c")):
        rows |= findings(shared, link)
    return rows


def places(rows: set[tuple[str, str, str]], folder: Path) -> Places:
    """The findings by rule; those in C that is made by the template that made it."""
    runtime: dict[str, Counter[str]] = defaultdict(Counter)
    generated: dict[str, set[str]] = defaultdict(set)
    for rule, file, _ in rows:
        path = Path(file)
        if path.is_relative_to(RUNTIME):
            runtime[rule][path.relative_to(RUNTIME).as_posix()] += 1
        elif not path.name.startswith("icdgen"):  # those are the runtime once more
            generated[rule].add(template(path.relative_to(folder / "made")))
    return {
        rule: {
            "runtime": dict(sorted(runtime[rule].items())),
            "generated": sorted(generated[rule]),
        }
        for rule in runtime.keys() | generated.keys()
    }


def template(path: Path) -> str:
    """What made a file."""
    name = (
        path.name
        if path.name in ("enums.h", "link.h", "link.c", "client.h", "procedures.h")
        else "message.h"
        if len(path.parts) > 1
        else "node.h"
    )
    return f"{name}.j2"


def record() -> list[dict[str, Any]]:
    """The deviations as they are recorded."""
    return list(yaml.safe_load(RECORD.read_text("utf-8"))["findings"])


def differences(recorded: list[dict[str, Any]], now: Places) -> list[str]:
    """What is found and not recorded, and the other way round."""
    lines = []
    known = {one["rule"]: one for one in recorded}
    for rule in sorted(known.keys() | now.keys(), key=_number):
        nothing: dict[str, Any] = {"runtime": {}, "generated": []}
        old, new = known.get(rule, nothing), now.get(rule, nothing)
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
    """Writes the places found into the record."""
    now, known = found(), {one["rule"]: one for one in record()}
    text = RECORD.read_text("utf-8").partition("findings:")[0] + "findings:\n"
    for rule in sorted(now, key=_number):
        one = {
            "rule": rule,
            "category": "",
            "verdict": "",
            "reason": "",
            **known.get(rule, {}),
            **now[rule],
        }
        text += yaml.safe_dump(
            [{key: one[key] for key in _ORDER}],
            sort_keys=False,
            width=140,
            allow_unicode=True,
        )
    RECORD.write_text(text, "utf-8")


def _number(rule: str) -> tuple[int, ...]:
    return tuple(map(int, rule.split(".")))


if __name__ == "__main__":
    update()
