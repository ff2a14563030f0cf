"""Imports lead one way: down the order of CONTRIBUTING.md. The order stands here, from the bottom to the top."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import imports
from tests.conftest import ROOT

PACKAGE = ROOT / "codegen" / "icdgen"
LAYERS = [  # what stands in one row does not know each other
    "diagnostics errors fingerprints frozen naming once shipped suggest tables",
    "cache config icd render",
    "codec layout reports",
    "protocol",
    "describe",
    "values vectors",
    "show",
    "backends",
    "link loading recognize sim",
    "diff logfile model_cache",
    "backends.html generation",
    "importer site starter",
    "definitions",
    "commands",
    "cli",
    "__main__",
]
ROWS = [["icdgen"], *([f"icdgen.{name}" for name in row.split()] for row in LAYERS)]


def test_no_modules_of_ours_import_each_other():
    assert imports.circles(imports.graph(PACKAGE)) == []


def test_imports_lead_down():
    assert imports.upward(imports.graph(PACKAGE), ROWS) == []


def test_the_order_names_only_what_there_is():
    modules = imports.graph(PACKAGE)
    assert [name for row in ROWS for name in row if name not in modules] == []


@pytest.fixture
def package(tmp_path) -> Path:
    folder = tmp_path / "made"
    for name, text in {
        "__init__": "",
        "low": "",
        "high/__init__": "from made import low\n",
        "high/one": "from made.low import anything\n",
        "high/two": "from . import one\n",
    }.items():
        path = folder / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder


MADE = [["made"], ["made.low"], ["made.high"]]


def test_what_leads_down_is_accepted(package):
    modules = imports.graph(package)
    assert modules["made.high.two"] == {"made.high.one"}
    assert (imports.circles(modules), imports.upward(modules, MADE)) == ([], [])


@pytest.mark.parametrize(
    "text",
    [
        "import made.high\n",
        "from made import high\n",
        "from .high import one\n",
        "def late():\n    from made.high.one import anything\n",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from made.high import two\n",
    ],
)
def test_a_planted_import_upwards_is_found_wherever_it_hides(package, text):
    (package / "low.py").write_text(text)
    assert imports.upward(imports.graph(package), MADE) == ["made.low imports made.high, which does not stand below it"]


def test_a_planted_circle_is_found(package):
    (package / "high" / "one.py").write_text("def late():\n    from made.high.two import anything\n")
    assert imports.circles(imports.graph(package)) == [["made.high.one", "made.high.two"]]


def test_a_module_that_is_in_no_layer_is_found(package):
    (package / "stray.py").write_text("")
    assert imports.upward(imports.graph(package), MADE) == ["made.stray is in no layer"]
