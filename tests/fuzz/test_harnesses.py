"""The fuzz harnesses find no error with the frames of the golden vectors and with
random bytes.

`python -m tests.fuzz` runs the fuzzers.
"""

from __future__ import annotations

import importlib
import random
import subprocess
import sys

import pytest

from tests.conformance import odd
from tests.conformance.build import execute
from tests.conformance.icds import icd_of
from tests.conformance.languages import Language
from tests.conftest import ROOT
from tests.fuzz.__main__ import (
    HERE,
    c_stream_seeds,
    c_wire_seeds,
    seeds,
    sources,
    stream_seeds,
)
from tests.fuzz.python_dispatch import Dispatch
from tests.fuzz.python_streams import Streams

DEVICES = [
    ROOT / "examples" / "devices" / name / f"{name}.yaml"
    for name in ("mavlink", "ublox")
]


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def odd_icd(tmp_path_factory):
    """Features that the shipped ICDs do not use: wide ids, variable length, shared ids,
    optional fields, calibration curves, and others.
    """
    return icd_of([odd.write(tmp_path_factory.mktemp("odd")), *DEVICES])


@pytest.fixture(scope="module")
def inputs(odd_icd):
    source = random.Random(1)
    inputs_ = list(seeds(odd_icd))
    for seed in inputs_[:]:
        flags = bytes((seed[0], source.randrange(16), seed[2]))
        inputs_ += [flags + source.randbytes(source.randrange(64)), flags + seed[3:]]
    return inputs_


@pytest.fixture(scope="module")
def wire_inputs(icd):
    source = random.Random(2)
    inputs_ = list(c_wire_seeds(icd))
    for seed in inputs_[:]:
        inputs_.append(
            seed[:1]
            + bytes((source.randrange(7),))
            + seed[2:]
            + source.randbytes(source.randrange(64))
        )
    return inputs_


@pytest.fixture(scope="module")
def linked():
    """Framed links of other protocols."""
    return icd_of([ROOT / "examples" / "links"])


@pytest.fixture(scope="module")
def stream_inputs(linked):
    source = random.Random(3)
    inputs_ = list(c_stream_seeds(linked))
    for seed in inputs_[:]:
        damaged = bytearray(seed[:2] + source.randbytes(2) + seed[4:] + seed[4:])
        damaged[source.randrange(2, len(damaged))] = source.randrange(256)
        inputs_.append(bytes(damaged))
    return inputs_


@pytest.mark.parametrize(
    ("target", "icds", "kind"),
    [
        ("c_target.c", "odd_icd", "inputs"),
        ("c_wire_target.c", "icd", "wire_inputs"),
        ("c_stream_target.c", "linked", "stream_inputs"),
    ],
)
def test_the_c_harnesses_find_no_error(target, icds, kind, request, tmp_path):
    inputs, icd = request.getfixturevalue(kind), request.getfixturevalue(icds)
    source = sources(
        Language("c", ("c", "c-testee"), (), lambda source, out: []), icd, tmp_path
    )
    testee = source / "c-testee"
    files = [
        HERE / target,
        HERE / "c_replay.c",
        testee / "testee_nodes.c",
        *sorted(testee.glob("nodes/*.c")),
    ]
    flags = [
        "-O0",  # with -O1, to compile takes three times as long as to run
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
        "-Wall",
        "-Wextra",
        "-Werror",
    ]
    execute(
        "gcc",
        "-std=c99",
        *flags,
        "-I",
        source / "c",
        "-I",
        testee,
        *files,
        "-o",
        tmp_path / "replay",
    )
    data = b"".join(len(input_).to_bytes(2, "little") + input_ for input_ in inputs)
    done = subprocess.run([tmp_path / "replay"], input=data, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stdout == f"{len(inputs)} inputs\n".encode()


@pytest.fixture
def package(icd, tmp_path, monkeypatch):
    """The package of the shipped ICDs."""
    yield from _imported(icd, tmp_path, monkeypatch)


@pytest.fixture
def odd_package(odd_icd, tmp_path, monkeypatch):
    """The package of the odd ICDs."""
    yield from _imported(odd_icd, tmp_path, monkeypatch)


def _imported(icd, tmp_path, monkeypatch):
    """Import a generated package that was not imported before."""
    source = sources(
        Language("python", ("python",), (), lambda source, out: []), icd, tmp_path
    )
    package = sorted((source / "python").glob("*/__init__.py"))[0].parent
    monkeypatch.syspath_prepend(str(package.parent))
    for name in [name for name in sys.modules if name.split(".")[0] == package.name]:
        monkeypatch.delitem(sys.modules, name)
    yield importlib.import_module(package.name)
    for name in [name for name in sys.modules if name.split(".")[0] == package.name]:
        # monkeypatch restores the modules that were imported before the test.
        del sys.modules[name]


def test_the_python_harness_finds_no_error(inputs, odd_package):
    dispatch = Dispatch(odd_package)
    for input_ in inputs:
        dispatch.run(input_)


def test_the_python_harness_of_streams_finds_no_error(icd, package):
    importlib.import_module(f"{package.__name__}.wire")
    streams, source = Streams(package), random.Random(1)
    seeds = list(stream_seeds(icd))
    assert {seed[0] for seed in seeds} >= {0, 2, 3, 5}
    for seed in seeds:
        streams.run(seed)
        spoilt = bytearray(seed)
        spoilt[source.randrange(len(spoilt))] = source.randrange(256)
        streams.run(bytes(spoilt))
    for _ in range(2000):
        streams.run(source.randbytes(source.randrange(200)))


def test_the_python_harness_of_streams_finds_no_error_in_framed_links(
    linked, tmp_path, monkeypatch
):
    for package in _imported(linked, tmp_path, monkeypatch):
        importlib.import_module(f"{package.__name__}.wire")
        streams, source = Streams(package), random.Random(1)
        seeds = list(stream_seeds(linked))
        assert {seed[0] for seed in seeds} == {7}
        for seed in seeds:
            streams.run(seed)
            spoilt = bytearray(seed)
            spoilt[source.randrange(1, len(spoilt))] = source.randrange(256)
            streams.run(bytes(spoilt))


def test_the_python_harness_of_streams_detects_a_wrong_decoder(package, monkeypatch):
    wire = importlib.import_module(f"{package.__name__}.wire")
    streams = Streams(package)
    streams.run(b"\0\0\0\x1f\x7f\x80\x1f\xff")
    monkeypatch.setattr(
        wire.UartDecoder, "_inside", lambda self, data, position, events: len(data)
    )
    with pytest.raises(AssertionError):
        streams.run(b"\0\0\0\x1f\x7f\x80\x1f\xff")


def test_the_python_harness_detects_a_wrong_codec():
    class Wrong:
        LENGTH, TAIL, FIELDS = 1, None, ()

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
        check(Wrong(), b"\0", None)
