"""The ICDs for which outputs are compared, and the command lines that generate the
outputs.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from hypothesis import HealthCheck, Phase, given, seed, settings

from tests.conformance.random_icds import written
from tests.conformance.strategies import icds
from tests.conformance.wholes import with_composites

ROOT = Path(__file__).parent.parent.parent

LANGUAGES = ("c", "python", "rust", "vectors", "c-selftest", "xtce", "html")
"""Backends that are run for every set.

`assurance` takes minutes for large arrays and runs for the shipped ICDs only.
"""

_FOLDERS = (
    "icd",
    "tests/conformance/odd_icds",
    "tests/icd/fine",
    "tests/python/odd",
    "tests/protocol/keys",
)
"""Folders whose ICDs belong together.

ICDs of any other folder are compared one by one.
"""

_SINGLE = ("examples", "docs", "tests/conformance/links")


class Command(NamedTuple):
    """A command line of icdgen; `{out}` in an argument is replaced by an empty folder."""

    name: str
    arguments: list[str]


def commands(random_count: int) -> Iterator[Command]:
    """List the commands for all sets of ICDs.

    Random ICDs are written into `build/`, because paths appear in outputs.
    """
    yield Command("icd assurance", ["--lang", "assurance", "--out", "{out}", "icd"])
    for name, files in _sets(random_count):
        languages = [word for language in LANGUAGES for word in ("--lang", language)]
        yield Command(f"{name} generate", [*languages, "--out", "{out}", *files])
        yield Command(f"{name} show", ["show", "--format", "json", *files])
        yield Command(f"{name} check", ["check", *files])
    for path in sorted((ROOT / "tests" / "wrong").rglob("*.yaml")):
        if "parts" not in path.parts:
            yield Command(
                f"check {path.relative_to(ROOT)}",
                ["check", str(path.relative_to(ROOT))],
            )
    for folder in sorted((ROOT / "tests" / "diff" / "rules").iterdir()):
        before, after = (
            str((folder / side).relative_to(ROOT)) for side in ("previous", "current")
        )
        for form in ("text", "json"):
            yield Command(
                f"diff {folder.name} {form}", ["diff", before, after, "--format", form]
            )


def _sets(random_count: int) -> Iterator[tuple[str, list[str]]]:
    """List the sets of ICDs by name, with their files relative to the root of the
    repository.
    """
    for name in _FOLDERS:
        yield name, [name]
    for top in _SINGLE:
        for path in sorted((ROOT / top).rglob("*.yaml")):
            if (
                path.read_text("utf-8").lstrip().startswith("#")
                or "icdgen:" in path.read_text("utf-8")[:400]
            ):
                relative = str(path.relative_to(ROOT))
                if "errata" not in path.parts and "profiles" not in path.parts:
                    yield relative, [relative]
    for number, trees in enumerate(_random_trees(random_count)):
        folder = Path("build", "outputs", f"random{number:03}")
        shutil.rmtree(ROOT / folder, ignore_errors=True)
        (ROOT / folder).mkdir(parents=True)
        written(trees, ROOT / folder)
        yield f"random {number:03}", [str(folder)]


def _random_trees(count: int) -> list[dict[str, dict]]:
    """Draw random ICDs; the same ones in every run."""
    drawn: list[dict[str, dict]] = []
    if not count:
        return drawn

    @seed(36)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(with_composites(icds()))
    def draw(trees: dict[str, dict]) -> None:
        drawn.append(json.loads(json.dumps(trees)))

    draw()
    return drawn
