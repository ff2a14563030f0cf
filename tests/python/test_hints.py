"""What the README promises of annotations: those of messages can be evaluated, with the oldest Python too."""

from __future__ import annotations

import ast
import subprocess
import sys

import pytest

from tests.conftest import ROOT

PROGRAM = """
import inspect
import typing
from importlib import import_module

import icdgen_messages
from icdgen_messages import _base, _errors

seen = 0
classes = [_base.Message, _base.FieldInfo]
classes += [one for one in vars(_errors).values() if inspect.isclass(one)]
for name in icdgen_messages.NODES:
    node = import_module(f"icdgen_messages.{name}")
    classes += [message for _, message in (*node.TELEMETRY.items(), *node.TELECOMMANDS.items())]
    classes += [getattr(node, enum) for enum in node.ENUMS.values()]
for one in classes:
    typing.get_type_hints(one)
    for name, member in vars(one).items():
        if name.startswith("_") and name != "__init__":
            continue
        if isinstance(member, property):
            functions = [function for function in (member.fget, member.fset) if function]
        else:
            functions = [getattr(member, "__func__", member)]
        for function in functions:
            if inspect.isfunction(function):
                typing.get_type_hints(function)
                seen += 1
message = import_module("icdgen_messages.cubeacp").TELEMETRY[146]
assert typing.get_type_hints(message.from_bytes)["return"] is message
assert typing.get_type_hints(message)["FIELDS"]
print(seen)
"""


def works(interpreter: str) -> bool:
    try:
        return subprocess.run([interpreter, "-c", ""], capture_output=True).returncode == 0
    except OSError:
        return False


@pytest.mark.parametrize("interpreter", [sys.executable, *filter(works, ["python3.9"])])
def test_annotations_of_messages_can_be_evaluated(interpreter):
    done = subprocess.run([interpreter, "-c", PROGRAM], cwd=ROOT / "generated/python", capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 1000


def test_they_use_nothing_that_the_oldest_python_cannot_evaluate():
    package = ROOT / "generated/python/icdgen_messages"
    for path in (package / "_base.py", *package.glob("*/_types/*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            for found in (getattr(node, "annotation", None), getattr(node, "returns", None)):
                names = {one.id for one in ast.walk(found) if isinstance(one, ast.Name)} if found else set()
                unions = found and any(isinstance(one, ast.BinOp) for one in ast.walk(found))
                assert not unions and "Self" not in names, (path.name, ast.unparse(found))
