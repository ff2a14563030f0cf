"""Fixtures of all tests: a small ICD, and a cache folder of its own for each test."""

from __future__ import annotations

import gc
import os
import shutil
import tempfile
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from icdgen import shipped

ROOT = Path(__file__).parent.parent

# Tests import `icdgen_runtime`, also if they run alone.
shipped.provide_runtime()

# Programs that cargo builds in tests run once, so that incremental data and debug
# information would only cost time.
os.environ |= {"CARGO_INCREMENTAL": "0", "CARGO_PROFILE_DEV_DEBUG": "0"}

# The model of an ICD consists of many small objects that live as long as a test. With
# Python's own thresholds, the garbage collector looks through all of them so often that
# it takes a quarter of the time of many tests.
gc.set_threshold(10_000, 10, 50)

# Inputs are the same in every run, and a busy machine makes no test fail.
# `--hypothesis-profile=explore` tries new inputs each time.
_PATIENT = {
    "deadline": None,
    "suppress_health_check": [HealthCheck.too_slow, HealthCheck.data_too_large],
}
settings.register_profile("same", derandomize=True, **_PATIENT)
settings.register_profile("explore", max_examples=1000, **_PATIENT)
settings.load_profile("same")

DEMO = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - name: Mode
    members:
      - {value: 0, name: Idle}
      - {value: 1, name: Run}
messages:
  - name: Estimated Roll
    id: 146
    kind: telemetry
    length: 3
    fields:
      - {at: 0,  bits: 16, name: Roll Angle, type: int, unit: deg, formula: raw*0.01}
      - {at: 16, bits: 4,  name: Mode,       type: enum, enum: Mode}
  - name: Set Roll
    id: 20
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 16, name: Roll Angle, type: int, unit: deg, formula: raw*0.01}
"""


@cache
def _has_terminals() -> bool:
    """Return whether this machine can create a pseudo-terminal.

    A chroot without /dev/pts cannot.
    """
    try:
        for end in os.openpty():
            os.close(end)
    except OSError:
        return False
    return True


def pytest_collection_finish() -> None:
    """Exclude modules and tests from garbage collection, because they live until the
    end.
    """
    gc.collect()
    gc.freeze()


def pytest_runtest_setup(item: pytest.Item) -> None:
    for mark in item.iter_markers("needs"):
        missing = [program for program in mark.args if shutil.which(program) is None]
        if missing:
            pytest.skip(f"no {' and no '.join(missing)}: scripts/test installs it")
    if (
        item.get_closest_marker("pty") or "--pty]" in item.nodeid
    ) and not _has_terminals():
        pytest.skip("this machine has no pseudo-terminals: /dev/pts is not mounted")


@pytest.fixture(scope="session")
def caches(tmp_path_factory) -> Path:
    """Folder of the cache folders of all tests."""
    return tmp_path_factory.mktemp("caches")


@pytest.fixture(autouse=True)
def own_cache(caches, monkeypatch):
    """Give every test an empty cache."""
    # `mktemp` of pytest reads the names of all folders of earlier tests each time.
    monkeypatch.setenv("ICDGEN_CACHE", tempfile.mkdtemp(dir=caches))


@pytest.fixture
def demo(tmp_path) -> Path:
    """A valid ICD file in a folder of its own."""
    path = tmp_path / "icd" / "demo.yaml"
    path.parent.mkdir()
    path.write_text(DEMO, encoding="utf-8")
    return path
