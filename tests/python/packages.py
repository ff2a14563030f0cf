"""Generates Python packages from ICDs and imports them."""

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
    """A generated package, where it is, and the ICDs that it was made from."""

    icd: Icd
    folder: Path
    name: str

    def answer(self, request: bytes) -> dict[str, Any]:
        """What the testee answers, by way of the front, within this program."""
        return self._front.answer(request)

    @cached_property
    def _front(self) -> Front:
        return Front(plan(self.icd), self.module("_testee").answer)

    def module(self, name: str = "") -> ModuleType:
        """The package, or a module of it."""
        return import_module(f"{self.name}.{name}" if name else self.name)


@cache
def shipped() -> Icd:
    """The ICDs of the project, errata applied."""
    return read(ROOT / "icd")


def read(path: Path) -> Icd:
    """ICDs in which nothing is wrong."""
    loaded = load([path])
    assert not [f for f in loaded.findings if f.severity == "error"], loaded.findings
    return loaded.icd


@cache
def renderer() -> Renderer:
    return Renderer("python")


def files(icd: Icd, name: str = "icdgen_messages") -> dict[str, str]:
    """Path and text of every generated file."""
    return {
        str(path): text for path, text in PythonBackend(name).files(icd, renderer())
    }


def testee(icd: Icd, name: str) -> dict[str, str]:
    """What answers questions about the package, from within."""
    backend = PythonTesteeBackend(name)
    return {
        str(path): text
        for path, text in backend.files(icd, Renderer.of_backend(backend))
    }


def write(icd: Icd, folder: Path, name: str) -> Package:
    """The package in ``folder``, ready to be imported under ``name``."""
    for path, text in (files(icd, name) | testee(icd, name)).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    sys.path.insert(0, str(folder))
    invalidate_caches()
    return Package(icd, folder, name)
