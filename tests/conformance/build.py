"""Generate and build testees. A build from the same sources with the same tools comes
from the cache.
"""

from __future__ import annotations

import fcntl
import hashlib
import inspect
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from icdgen import backends
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance import (
    ROOT,
    testees,  # noqa: F401
)
from tests.conformance.front.plan import plan
from tests.conformance.languages import TESTEE, Language, version

FRONT = ROOT / "tests" / "conformance" / "front" / "__main__.py"
BOARD = ROOT / "tests" / "conformance" / "board"  # what the self-tests are linked with


class BuildError(RuntimeError):
    """The generated code does not build; the message contains the compiler's output."""


def cache_folder() -> Path:
    """Folder of cached builds: ``ICDGEN_BUILD``, or ``.icdgen-build`` in the checkout."""
    return Path(os.environ.get("ICDGEN_BUILD") or ROOT / ".icdgen-build")


@contextmanager
def locked_folder(folder: Path) -> Iterator[Path]:
    """Yield a folder of the cache that only this worker writes; other workers wait."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


def build(language: Language, icd: Icd, folder: Path | None = None) -> list[str]:
    """Build the language's testee for these ICDs and return its command line. Raises
    `BuildError`.
    """
    files = generated(language, icd)
    plan_json = json.dumps(plan(icd)).encode()
    folder = (
        folder or cache_folder()
    ) / f"{language.name}-{_key(language, {**files, 'plan.json': plan_json})}"
    done = folder / "command.json"
    with locked_folder(folder):
        # The command is written last: a build that was interrupted is done again.
        if not done.exists():
            source, out = folder / "source", folder / "out"
            for old in (source, out):
                shutil.rmtree(old, ignore_errors=True)
                old.mkdir()
            for name, data in files.items():
                (source / name).parent.mkdir(parents=True, exist_ok=True)
                (source / name).write_bytes(data)
            (folder / "plan.json").write_bytes(plan_json)
            command = language.build(source, out)
            front = (
                [sys.executable, str(FRONT), str(folder / "plan.json")]
                if language.kind == TESTEE and language.front
                else []
            )
            done.write_text(json.dumps([*front, *command]))
        return json.loads(done.read_text())


def generated(language: Language, icd: Icd) -> dict[str, bytes]:
    """Return what the language's backends generate: path, starting with the backend's
    name -> content.
    """
    files = {}
    for name in language.backends:
        for path, text in backends.get(name).files(icd, renderer(name)):
            files[f"{name}/{path}"] = text.encode("utf-8")
    return files


@cache
def renderer(name: str) -> Renderer:
    return Renderer.of_backend(backends.get(name))


def execute(
    *command: str | Path, cwd: Path | None = None, env: dict[str, str] | None = None
) -> str:
    """Run a build step and return its output. Raises `BuildError`."""
    words = [str(word) for word in command]
    environment = {**os.environ, **env} if env else None
    done = subprocess.run(
        words,
        cwd=cwd,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        raise BuildError(f"{' '.join(words)}\n{done.stdout[-8000:]}")
    return done.stdout


def _key(language: Language, files: dict[str, bytes]) -> str:
    digest = hashlib.sha256()
    digest.update(f"{sys.executable}\0".encode())
    recipe = Path(inspect.getfile(getattr(language.build, "func", language.build)))
    for file in (recipe, *sorted(BOARD.glob("*"))):
        digest.update(file.read_bytes() + b"\0")
    for part in (language.name, *(version(tool) or tool for tool in language.tools)):
        digest.update(part.encode() + b"\0")
    for name, data in files.items():
        digest.update(f"{name}\0{len(data)}\0".encode() + data)
    return digest.hexdigest()[:16]
