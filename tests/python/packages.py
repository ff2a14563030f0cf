"""Generate Python packages from ICDs, write them to a folder and import them.

The fixtures of `tests.python.conftest` provide the packages that most tests share.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module, invalidate_caches
from pathlib import Path
from types import ModuleType
from typing import Any

from icdgen.backends.python import PythonBackend
from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.render import Renderer
from tests.conformance.front import Front
from tests.conformance.front.plan import plan
from tests.conformance.testees.python import PythonTesteeBackend
from tests.conftest import ROOT

ODD = Path(__file__).with_name("odd")


@dataclass(eq=False)
class Package:
    """A generated package, its folder and name, and the ICDs it was generated from."""

    icd: Icd
    folder: Path
    name: str

    def answer(self, request: bytes) -> dict[str, Any]:
        """Return the testee's answer to a request, computed in this process."""
        return self._front.answer(request)

    @cached_property
    def _front(self) -> Front:
        return Front(plan(self.icd), self.module("_testee").answer)

    def module(self, name: str = "") -> ModuleType:
        """Import the package, or the module ``name`` of it."""
        return import_module(f"{self.name}.{name}" if name else self.name)


@cache
def shipped() -> Icd:
    """ICDs of the project, errata applied."""
    return read(ROOT / "icd")


def read(path: Path) -> Icd:
    """Load the ICDs of a path; fail if `icdgen` reports an error in them."""
    loaded = load([path])
    assert not [f for f in loaded.findings if f.severity == "error"], loaded.findings
    return loaded.icd


@cache
def renderer() -> Renderer:
    return Renderer("python")


def files(icd: Icd, name: str = "icdgen_messages") -> dict[str, str]:
    """Return the text of every generated file by its path."""
    return {
        str(path): text for path, text in PythonBackend(name).files(icd, renderer())
    }


def testee(icd: Icd, name: str) -> dict[str, str]:
    """Return the files of the testee: the module `_testee`, which answers requests."""
    backend = PythonTesteeBackend(name)
    return {
        str(path): text
        for path, text in backend.files(icd, Renderer.of_backend(backend))
    }


def write(icd: Icd, folder: Path, name: str) -> Package:
    """Write a package and its testee to ``folder``, importable as ``name``."""
    for path, text in (files(icd, name) | testee(icd, name)).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    sys.path.insert(0, str(folder))
    invalidate_caches()
    return Package(icd, folder, name)
