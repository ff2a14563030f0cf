"""The tool that plants faults in icdgen itself finds all places for faults, and the
tests catch a sample of them.

``python -m tests.mutation.tool`` plants more.
"""

from __future__ import annotations

import ast
import os
import subprocess
import sys

import pytest

from tests.conftest import ROOT
from tests.mutation.faults import faults_of
from tests.mutation.tool import PLANTING, run_tests, sample, survives

SOURCE = '''\
"""A module with 3 words."""

def share(part: int, whole: int = 4) -> float:
    """Return 1 of 2."""
    if part < whole and not part == 0:
        print("1 < 2")
        return part / whole
    return 0.5
'''


def test_each_operator_constant_condition_and_statement_can_have_a_fault():
    changes = {str(fault) for fault in faults_of(SOURCE)}
    assert changes == {
        "line 3: '4' -> '5'",
        "line 5: '<' -> '<='",
        "line 5: 'and' -> 'or'",
        "line 5: 'not part == 0' -> 'bool(part == 0)'",
        "line 5: '==' -> '!='",
        "line 5: '0' -> '1'",
        "line 5: 'part < whole and not part == 0' -> "
        "'(not (part < whole and not part == 0))'",
        "line 6: 'print(\"1 < 2\")' -> 'pass'",
        "line 7: 'return part / whole' -> 'return None'",
        "line 7: '/' -> '*'",
        "line 8: 'return 0.5' -> 'return None'",
    }


def test_a_changed_module_is_python_with_the_same_lines():
    source = (ROOT / "codegen/icdgen/icd/curve.py").read_text(encoding="utf-8")
    faults = faults_of(source)
    assert len(faults) > 150
    for fault in faults:
        planted = fault.planted(source)
        assert planted != source
        ast.parse(planted)


@pytest.mark.parametrize(
    "program",
    [
        "from icdgen import suggest; print(suggest.close_to('a', []))",
        # as a generator does that copies a runtime into a package
        "print(eval(__import__('pathlib').Path(FILE).read_text().split('return ')[1]))",
    ],
    ids=["import", "read"],
)
def test_other_processes_get_the_module_with_the_fault(program, tmp_path):
    """This includes processes that a test starts, such as `icdgen`."""
    file = ROOT / "codegen/icdgen/suggest.py"
    changed = tmp_path / "changed.py"
    changed.write_text("def close_to(*_):\n    return 'planted'\n", encoding="utf-8")
    environment = os.environ | {
        "PYTHONPATH": str(PLANTING),
        "ICDGEN_PLANTED": f"{file}{os.pathsep}{changed}",
    }
    ran = subprocess.run(
        [sys.executable, "-c", f"FILE = {str(file)!r}; {program}"],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert ran.stdout == "planted\n", ran.stderr


# Small modules that everything stands on, each with tests that take a second.
SAMPLED = {
    "codegen/icdgen/suggest.py": ["tests/test_suggest.py"],
    "codegen/icdgen/naming.py": ["tests/test_naming.py"],
    "codegen/icdgen/icd/expression.py": ["tests/icd/test_expression.py"],
}


@pytest.mark.parametrize("file", SAMPLED)
def test_tests_catch_planted_faults(file):
    tests = SAMPLED[file]
    passed, seconds = run_tests(tests)
    assert passed
    for _, fault in sample([file], 1, seed=1):
        assert not survives(file, fault, tests, sound_s=seconds), str(fault)
