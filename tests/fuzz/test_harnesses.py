"""The fuzz harnesses, on the frames of the golden vectors and on random bytes; fuzzing proper is `python -m tests.fuzz`."""

from __future__ import annotations

import importlib
import random
import subprocess
import sys

import pytest

from tests.conformance.build import execute
from tests.conformance.icds import icd_of
from tests.conformance.languages import Language
from tests.fuzz.__main__ import HERE, seeds, sources, wire_seeds
from tests.fuzz.python_dispatch import Dispatch


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def inputs(icd):
    source = random.Random(1)
    found = list(seeds(icd))
    for seed in found[:]:
        flags = bytes((seed[0], source.randrange(16), seed[2]))
        found.append(flags + source.randbytes(source.randrange(64)))
    return found


@pytest.fixture(scope="module")
def wire_inputs(icd):
    source = random.Random(2)
    found = list(wire_seeds(icd))
    for seed in found[:]:
        found.append(seed[:1] + bytes((source.randrange(7),)) + seed[2:] + source.randbytes(source.randrange(64)))
    return found


@pytest.mark.parametrize(("target", "kind"), [("c_target.c", "inputs"), ("c_wire_target.c", "wire_inputs")])
def test_the_c_harnesses_find_nothing(icd, target, kind, request, tmp_path):
    inputs = request.getfixturevalue(kind)
    source = sources(Language("c", ("c", "c-testee"), (), lambda source, out: []), icd, tmp_path)
    testee = source / "c-testee"
    files = [HERE / target, HERE / "c_replay.c", testee / "testee_nodes.c", *sorted(testee.glob("nodes/*.c"))]
    flags = ["-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-Wall", "-Wextra", "-Werror"]
    execute("gcc", "-std=c99", *flags, "-I", source / "c", "-I", testee, *files, "-o", tmp_path / "replay")
    data = b"".join(len(one).to_bytes(2, "little") + one for one in inputs)
    done = subprocess.run([tmp_path / "replay"], input=data, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stdout == f"{len(inputs)} inputs\n".encode()


def test_the_python_harness_finds_nothing(icd, inputs, tmp_path, monkeypatch):
    source = sources(Language("python", ("python",), (), lambda source, out: []), icd, tmp_path)
    package = sorted((source / "python").rglob("testee.py"))[0].parent
    monkeypatch.syspath_prepend(str(package.parent))
    for name in [name for name in sys.modules if name.split(".")[0] == package.name]:
        monkeypatch.delitem(sys.modules, name)
    dispatch = Dispatch(importlib.import_module(package.name))
    for one in inputs:
        dispatch.one(one)
    for name in [name for name in sys.modules if name.split(".")[0] == package.name]:
        monkeypatch.delitem(sys.modules, name)


def test_the_python_harness_notices_a_codec_that_is_wrong():
    class Wrong:
        LENGTH, FIELDS = 1, ()

        @classmethod
        def from_bytes(cls, data):
            return cls()

        def __init__(self):
            Wrong.count = getattr(Wrong, "count", 0) + 1
            self.number = Wrong.count

        def to_bytes(self):
            return bytes((self.number,))

    from tests.fuzz.python_dispatch import check

    with pytest.raises(AssertionError):
        check(Wrong(), b"\0")
