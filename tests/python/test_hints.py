"""Annotations of all public classes and functions can be evaluated at run time.

The README of the generated package promises this for the oldest supported Python too.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

PROGRAM = """
import inspect
import pkgutil
import typing
from importlib import import_module

import icdgen_messages

seen, failed = 0, []


def functions_of(owner):
    for name, member in list(vars(owner).items()):
        if name.startswith("_") and name not in ("__init__", "__new__"):
            continue
        if isinstance(member, property):
            yield from (function for function in (member.fget, member.fset) if function)
        else:
            yield getattr(member, "__func__", member)


def evaluate(member):
    global seen
    seen += 1
    try:
        typing.get_type_hints(member)
    except Exception as error:
        failed.append(f"{member.__module__}.{member.__qualname__}: {error!r}")


for info in pkgutil.walk_packages(icdgen_messages.__path__, "icdgen_messages."):
    module = import_module(info.name)
    for name, member in list(vars(module).items()):
        if getattr(member, "__module__", None) != module.__name__ or name.startswith("_"):
            continue
        if inspect.isclass(member):
            evaluate(member)
            for function in functions_of(member):
                if inspect.isfunction(function) and function.__module__ == module.__name__:
                    evaluate(function)
        elif inspect.isfunction(inspect.unwrap(member)):
            evaluate(inspect.unwrap(member))
assert not failed, "\\n".join([f"{len(failed)} of {seen}:", *failed])
node = import_module("icdgen_messages.cubeacp")
message, hints = node.TELEMETRY[146], typing.get_type_hints
assert bytes in typing.get_args(hints(message.from_bytes)["data"])
assert hints(message) == {info.attribute: int for info in message.FIELDS}
state = node.CurrentAdcsState
assert [*hints(state)] == [info.attribute for info in state.FIELDS]
assert hints(state)["control_mode"] is node.ConModeSelect
assert hints(node.decode_telemetry)["return"] is icdgen_messages.Message
print(seen)
"""


def works(interpreter: str) -> bool:
    """Check that an interpreter starts; one of pyenv may be an empty shim."""
    try:
        return (
            subprocess.run([interpreter, "-c", ""], capture_output=True).returncode == 0
        )
    except OSError:
        return False


def oldest() -> list[str]:
    """Python 3.9, if it is installed: the oldest version that is supported."""
    installed = sorted(
        map(str, (Path.home() / ".pyenv/versions").glob("3.9*/bin/python"))
    )
    return [*filter(works, ["python3.9", *installed])][:1]


@pytest.mark.parametrize("interpreter", [sys.executable, *oldest()])
def test_annotations_of_all_public_members_can_be_evaluated(interpreter):
    done = subprocess.run(
        [interpreter, "-c", PROGRAM],
        cwd=ROOT / "generated/python",
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 450


def test_importing_a_node_does_not_load_modules_that_only_annotations_use():
    program = "import sys, icdgen_messages.cubeacp as node; before = {*sys.modules}; assert node.decode_telemetry; "
    program += "assert not [name for name in ('icdgen_messages._base', 'typing') if name in before], before"
    command = [sys.executable, "-S", "-c", program]
    done = subprocess.run(
        command, cwd=ROOT / "generated/python", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
