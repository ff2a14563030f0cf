"""Modules of the generator and of the Python runtime import only modules of lower
layers.

The layers are listed here, from the bottom to the top.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests import imports
from tests.conftest import ROOT

PACKAGE = ROOT / "codegen" / "icdgen"
LAYERS = [  # modules in one row do not import each other
    "frozen",
    "diagnostics errors fingerprints naming once shipped suggest tables wording",
    "cache config icd render",
    "codec frame_bits reports",
    "protocol",
    "describe procedures",
    "link_calls values",
    "runtime_objects",
    "vectors",
    "link recognize show sim",
    "logfile",
    "backends",
    "loading",
    "diff model_cache",
    "backends.html generation",
    "import_results site starter",
    "definitions importer",
    "commands",
    "cli",
    "__main__",
]
ROWS = [["icdgen"], *([f"icdgen.{name}" for name in row.split()] for row in LAYERS)]
RUNTIME = ROOT / "runtime" / "python" / "icdgen_runtime"
RUNTIME_LAYERS = [
    "_enumeration _errors _hints",
    "_types",
    "_derived _floats _layout",
    "_codec _curves _parts",
    "_conditions _dataclass _dicts _fields _tails",
    "_columns _compiled",
    "_base",
    "_shared",
    "_lazy",
    "wire",
]
RUNTIME_ROWS = [
    *([f"icdgen_runtime.{name}" for name in row.split()] for row in RUNTIME_LAYERS),
    ["icdgen_runtime"],  # exports names of all modules, so none of them imports it
]
# The only packages that import a package. Some need the names of messages and fields in
# a language. The model and the codec do not need the runtime, and the runtime does not need
# the generator.
USERS = {
    "icdgen": [],
    "icdgen_runtime": [
        "icdgen.backends.html",
        "icdgen.commands",
        "icdgen.link",
        "icdgen.logfile",
        "icdgen.procedures",
        "icdgen.recognize",
        "icdgen.runtime_objects",
        "icdgen.sim",
        "icdgen.vectors",
    ],
    "icdgen.backends.c": [
        "icdgen.backends.c_selftest",
        "icdgen.backends.html",
        "icdgen.diff",
    ],
    "icdgen.backends.python": ["icdgen.diff"],
    "icdgen.backends.rust": [
        "icdgen.backends.html",
        "icdgen.backends.packages",
        "icdgen.diff",
    ],
}


@pytest.mark.parametrize("folder", [PACKAGE, RUNTIME], ids=lambda folder: folder.name)
def test_no_modules_import_each_other(folder):
    assert imports.circles(imports.graph(folder)) == []


@pytest.mark.parametrize(
    "folder, rows",
    [(PACKAGE, ROWS), (RUNTIME, RUNTIME_ROWS)],
    ids=["icdgen", "icdgen_runtime"],
)
def test_imports_lead_down(folder, rows):
    assert imports.upward(imports.graph(folder), rows) == []


def test_backends_runtime_and_generator_are_imported_by_their_users_only():
    assert imports.reserved(imports.graph(PACKAGE, RUNTIME), USERS) == []


def test_the_layers_name_only_existing_modules():
    modules = {*imports.graph(PACKAGE), *imports.graph(RUNTIME)}
    assert [
        name for row in (*ROWS, *RUNTIME_ROWS) for name in row if name not in modules
    ] == []


@pytest.fixture
def package(tmp_path) -> Path:
    folder = tmp_path / "sample"
    for name, text in {
        "__init__": "",
        "low": "",
        "high/__init__": "from sample import low\n",
        "high/first": "from sample.low import anything\n",
        "high/second": "from . import first\n",
    }.items():
        path = folder / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder


SAMPLE_LAYERS = [["sample"], ["sample.low"], ["sample.high"]]


def test_imports_of_lower_layers_are_accepted(package):
    modules = imports.graph(package)
    assert modules["sample.high.second"] == {"sample.high.first"}
    assert (imports.circles(modules), imports.upward(modules, SAMPLE_LAYERS)) == (
        [],
        [],
    )


@pytest.mark.parametrize(
    "text",
    [
        "import sample.high\n",
        "from sample import high\n",
        "from .high import first\n",
        "def late():\n    from sample.high.first import anything\n",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from sample.high import second\n",
    ],
)
def test_a_planted_import_upwards_is_detected_in_every_form(package, text):
    (package / "low.py").write_text(text)
    assert imports.upward(imports.graph(package), SAMPLE_LAYERS) == [
        "sample.low imports sample.high, which does not stand below it"
    ]


def test_a_planted_circle_is_found(package):
    (package / "high" / "first.py").write_text(
        "def late():\n    from sample.high.second import anything\n"
    )
    assert imports.circles(imports.graph(package)) == [
        ["sample.high.first", "sample.high.second"]
    ]


def test_a_module_that_is_in_no_layer_is_found(package):
    (package / "stray.py").write_text("")
    assert imports.upward(imports.graph(package), SAMPLE_LAYERS) == [
        "sample.stray is in no layer"
    ]


def test_a_planted_import_of_a_reserved_package_is_found(package):
    (package / "top.py").write_text("def late():\n    from sample.high import second\n")
    modules = imports.graph(package)
    assert imports.reserved(modules, {"sample.high": []}) == [
        "sample.top imports sample.high.second"
    ]
    assert imports.reserved(modules, {"sample.high": ["sample.top"]}) == []


@pytest.mark.parametrize(
    "module, text, error",
    [
        (
            "sim/run.py",
            "from icdgen.backends.python.names import class_name",
            "icdgen.sim imports icdgen.backends, which does not stand below it",
        ),
        (
            "frame_bits.py",
            "from icdgen.describe import describe",
            "icdgen.frame_bits imports icdgen.describe, which does not stand below it",
        ),
    ],
)
def test_an_import_that_is_planted_in_a_copy_of_the_package_is_found(
    tmp_path, module, text, error
):
    assert imports.upward(
        imports.graph(_copy(PACKAGE, tmp_path, module, text)), ROWS
    ) == [error]


def test_a_backend_that_is_imported_by_the_site_in_a_copy_of_the_package_is_found(
    tmp_path,
):
    modules = imports.graph(
        _copy(
            PACKAGE,
            tmp_path,
            "backends/html/wire.py",
            "from icdgen.backends.python import nodes",
        )
    )
    error = "icdgen.backends.html.wire imports icdgen.backends.python.nodes"
    assert imports.reserved(modules, USERS) == [error]


@pytest.mark.parametrize(
    "text",
    [
        "import_module('icdgen.backends.python')",
        "importlib.import_module('icdgen.backends.python')",
        "__import__('icdgen.backends.python')",
    ],
)
def test_a_planted_import_by_a_call_in_the_simulator_is_detected(tmp_path, text):
    modules = imports.graph(_copy(PACKAGE, tmp_path, "sim/run.py", text))
    error = "icdgen.sim.run imports icdgen.backends.python"
    assert imports.reserved(modules, USERS) == [error]


def test_a_planted_import_of_the_generator_by_the_runtime_is_detected(tmp_path):
    copy = _copy(RUNTIME, tmp_path, "wire/uart.py", "from icdgen.naming import words")
    error = "icdgen_runtime.wire.uart imports icdgen.naming"
    assert imports.reserved(imports.graph(PACKAGE, copy), USERS) == [error]


def test_a_planted_import_of_the_runtime_by_the_model_is_detected(tmp_path):
    copy = _copy(PACKAGE, tmp_path, "icd/units.py", "import icdgen_runtime._codec")
    error = "icdgen.icd.units imports icdgen_runtime._codec"
    assert imports.reserved(imports.graph(copy, RUNTIME), USERS) == [error]


def test_a_module_of_the_runtime_that_imports_all_names_in_a_copy_is_detected(tmp_path):
    copy = _copy(RUNTIME, tmp_path, "_errors.py", "from icdgen_runtime import Message")
    error = (
        "icdgen_runtime._errors imports icdgen_runtime, which does not stand below it"
    )
    assert imports.upward(imports.graph(copy), RUNTIME_ROWS) == [error]


def test_a_circle_that_is_planted_in_a_copy_of_the_package_is_found(tmp_path):
    modules = imports.graph(
        _copy(PACKAGE, tmp_path, "icd/model.py", "from icdgen import codec")
    )
    (group,) = imports.circles(modules)
    assert {"icdgen.codec", "icdgen.icd.model"} <= set(group)


def test_a_worker_of_the_runtime_that_imports_the_messages_in_a_copy_is_found(tmp_path):
    modules = imports.graph(
        _copy(RUNTIME, tmp_path, "_tails.py", "from ._base import Message")
    )
    error = "icdgen_runtime._tails imports icdgen_runtime._base, which does not stand below it"
    assert imports.upward(modules, RUNTIME_ROWS) == [error]
    (group,) = imports.circles(modules)
    assert {
        "icdgen_runtime._base",
        "icdgen_runtime._compiled",
        "icdgen_runtime._tails",
    } <= set(group)


def test_a_circle_that_is_planted_in_a_copy_of_the_wire_layer_is_found(tmp_path):
    modules = imports.graph(
        _copy(RUNTIME, tmp_path, "wire/link.py", "from .client import Client")
    )
    assert any(
        "icdgen_runtime.wire.link" in group for group in imports.circles(modules)
    )


def _copy(package: Path, folder: Path, module: str, text: str) -> Path:
    """Return a copy of a package in which a module has another import in a function."""
    copy = shutil.copytree(
        package, folder / package.name, ignore=shutil.ignore_patterns("__pycache__")
    )
    with (copy / module).open("a", encoding="utf-8") as file:
        file.write(f"\n\ndef _late() -> None:\n    {text}\n")
    return copy
