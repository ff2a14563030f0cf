"""What the README promises of annotations: all of what is public can be evaluated, with
the oldest Python too.
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


def evaluate(one):
    global seen
    seen += 1
    try:
        typing.get_type_hints(one)
    except Exception as error:
        failed.append(f"{one.__module__}.{one.__qualname__}: {error!r}")


for found in pkgutil.walk_packages(icdgen_messages.__path__, "icdgen_messages."):
    module = import_module(found.name)
    for name, one in list(vars(module).items()):
        if getattr(one, "__module__", None) != module.__name__ or name.startswith("_"):
            continue
        if inspect.isclass(one):
            evaluate(one)
            for function in functions_of(one):
                if inspect.isfunction(function) and function.__module__ == module.__name__:
                    evaluate(function)
        elif inspect.isfunction(inspect.unwrap(one)):
            evaluate(inspect.unwrap(one))
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
    try:
        return (
            subprocess.run([interpreter, "-c", ""], capture_output=True).returncode == 0
        )
    except OSError:
        return False


def oldest() -> list[str]:
    """Python 3.9, where there is one."""
    installed = sorted(
        map(str, (Path.home() / ".pyenv/versions").glob("3.9*/bin/python"))
    )
    return [*filter(works, ["python3.9", *installed])][:1]


@pytest.mark.parametrize("interpreter", [sys.executable, *oldest()])
def test_annotations_of_all_that_is_public_can_be_evaluated(interpreter):
    done = subprocess.run(
        [interpreter, "-c", PROGRAM],
        cwd=ROOT / "generated/python",
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 450


def test_importing_a_node_loads_nothing_that_only_annotations_name():
    program = "import sys, icdgen_messages.cubeacp as node; before = {*sys.modules}; assert node.decode_telemetry; "
    program += "assert not [name for name in ('icdgen_messages._base', 'typing') if name in before], before"
    command = [sys.executable, "-S", "-c", program]
    done = subprocess.run(
        command, cwd=ROOT / "generated/python", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
