"""Where what is shipped beside the code lies: in the wheel under ``icdgen/data``, in a checkout at its top."""

from __future__ import annotations

import sys
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

PACKAGE = Path(__file__).parent


@cache
def _root() -> Path:
    data = PACKAGE / "data"
    return data if data.is_dir() else PACKAGE.parent.parent


def templates() -> Path:
    """Folder of the shipped templates, one folder a backend."""
    return _root() / "templates"


def runtimes() -> Path:
    """Folder of what generated code runs on, one folder a backend."""
    return _root() / "runtime"


def icds() -> Path:
    """Folder of the shipped ICDs."""
    return _root() / "icd"


def cmake() -> Path:
    """Folder of the CMake module."""
    return _root() / "cmake"


def examples() -> Path:
    """Folder of the small programs and of the ICDs to begin with."""
    return _root() / "examples"


def docs() -> Path:
    """Folder of the manual, in Markdown."""
    return _root() / "docs"


def provide_runtime() -> None:
    """Makes ``icdgen_runtime`` importable, what generated Python runs on: the tool talks to devices by it as well."""
    name = "icdgen_runtime"
    if name in sys.modules:
        return
    folder = runtimes() / "python" / name
    spec = spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec and spec.loader
    sys.modules[name] = module = module_from_spec(spec)
    spec.loader.exec_module(module)
