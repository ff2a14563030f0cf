"""Folders of the files that icdgen ships with its code: in a wheel below
``icdgen/data``, in a checkout at the top.
"""

from __future__ import annotations

import sys
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

PACKAGE = Path(__file__).parent


@cache
def _root() -> Path:
    """Return the folder that contains the shipped folders."""
    data = PACKAGE / "data"
    return data if data.is_dir() else PACKAGE.parent.parent


def templates() -> Path:
    """Return the folder of the shipped templates, with a subfolder per backend."""
    return _root() / "templates"


def runtimes() -> Path:
    """Return the folder of the runtimes of generated code, with a subfolder per
    backend.
    """
    return _root() / "runtime"


def icds() -> Path:
    """Return the folder of the shipped ICDs."""
    return _root() / "icd"


def cmake() -> Path:
    """Return the folder of the CMake module."""
    return _root() / "cmake"


def examples() -> Path:
    """Return the folder of example programs and ICDs."""
    return _root() / "examples"


def docs() -> Path:
    """Return the folder of the documentation of icdgen, in Markdown."""
    return _root() / "docs"


def provide_runtime() -> None:
    """Make ``icdgen_runtime``, the runtime of generated Python code, importable for
    commands that talk to devices.
    """
    name = "icdgen_runtime"
    if name in sys.modules:
        return
    folder = runtimes() / "python" / name
    spec = spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert spec and spec.loader
    sys.modules[name] = module = module_from_spec(spec)
    spec.loader.exec_module(module)
