"""The programs of the guide to golden vectors work with the vectors of a first device."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests import documents
from tests.c import harness

GUIDE = documents.text("guides/golden-vectors")


def block(language: str) -> str:
    return documents.blocks(GUIDE, language)[0]


@pytest.fixture(scope="module")
def battery(tmp_path_factory):
    folder = tmp_path_factory.mktemp("golden")
    languages = [
        word for name in ("c", "vectors", "c-selftest") for word in ("--lang", name)
    ]
    for command in (["init", "battery"], languages):
        subprocess.run(
            [sys.executable, "-m", "icdgen", *command],
            cwd=folder,
            check=True,
            capture_output=True,
        )
    return folder


def test_a_decoder_is_tested_with_the_vectors(battery):
    subprocess.run([sys.executable, "-c", block("python")], cwd=battery, check=True)
    wrong = block("python").replace("flags >> 1", "flags >> 2")
    failed = subprocess.run(
        [sys.executable, "-c", wrong], cwd=battery, capture_output=True, text=True
    )
    assert failed.returncode == 1 and "AssertionError" in failed.stderr


def test_the_vector_shown_is_in_the_file(battery):
    vectors = (battery / "generated" / "vectors" / "battery.json").read_text("utf-8")
    assert "".join(block("json").split()) in "".join(vectors.split())


def test_the_self_test_compiles_and_passes(battery):
    source, folder = battery / "selftest.c", battery / "generated" / "c-selftest"
    source.write_text(block("c"))
    units = [*folder.glob("*.c"), *folder.glob("nodes/*.c")]
    options = (
        "-std=c99",
        "-Wall",
        "-Wextra",
        f"-I{battery / 'generated' / 'c'}",
        f"-I{folder}",
        *map(str, units),
    )
    assert (
        subprocess.run(
            [harness.compile(source, *options, output=battery / "selftest")]
        ).returncode
        == 0
    )
