"""Every language answers every vector like the reference codec: for the shipped ICDs
and for unusual ones.
"""

from __future__ import annotations

from typing import NamedTuple

import pytest

from icdgen.icd.model import Icd
from icdgen.icd.places import raw_fields_in
from tests.conformance import odd, physical
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import SELFTEST, TESTEE, all_languages
from tests.conformance.random_icds import check
from tests.conformance.run import Batch, batches, run_batches

LANGUAGES = [
    language
    for language in all_languages().values()
    if language.kind in (TESTEE, SELFTEST)
]
# Built for the shipped ICDs too, the optimised C for a processor without an operating
# system; the others, variants of these, for the odd ones only.
SHIPPED = ("c-cortex-m", "c-sanitizers", "javascript", "python", "rust-debug")
OPTIONAL = {"python3.9"}  # not every machine has an interpreter that old


class RunInput(NamedTuple):
    """ICDs with their requests to every language."""

    icd: Icd
    batches: list[Batch]
    vectors: int


def run_input(icd: Icd, frames: int) -> RunInput:
    files = vectors_of(icd)
    vectors = sum(
        len(message["vectors"])
        for data in files.values()
        for message in data["messages"]
    )
    return RunInput(icd, list(batches(icd, files, frames, 1)), vectors)


@pytest.fixture(scope="module")
def shipped():
    return run_input(icd_of(), 2)


@pytest.fixture(scope="module")
def odd_icds(tmp_path_factory):
    return run_input(icd_of([odd.write(tmp_path_factory.mktemp("icd"))]), 8)


def agree(language, run_input):
    assert not language.missing(), (
        f"scripts/test installs {', '.join(language.missing())}"
    )
    (result,) = run_batches([language], run_input.icd, run_input.batches)
    assert result.differences == 0, "\n".join(result.shown)
    assert result.vectors >= run_input.vectors


# Left to `python -m tests.conformance.run`: what takes minutes to build, and variants
# of which others here are as well.
LEFT = {"rust", "c-clang", "c-cortex-m", "c-portable", "c-selftest-no-double"}
ODD = [language.name for language in LANGUAGES if language.name not in OPTIONAL | LEFT]


@pytest.mark.parametrize("name", ODD)
def test_a_language_agrees_with_the_reference_codec_on_odd_icds(odd_icds, name):
    agree(all_languages()[name], odd_icds)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_language_agrees_with_the_reference_codec_on_the_shipped_icds(shipped, name):
    agree(all_languages()[name], shipped)


def test_physical_values_are_the_same_to_the_last_bit(odd_icds):
    totals, notes = physical.run(
        ["c", "javascript", "python", "rust-debug"],
        odd_icds.icd,
        100,
        exhaustive_bits=10,
        near=50,
    )
    assert notes == []
    scaled = [
        f
        for node in odd_icds.icd.nodes
        for m in node.messages
        for f in raw_fields_in(m.layout)
        if f.has_formula and f.is_invertible
    ]
    assert all(
        total.fields == len(scaled) > 20 and total.values > 20_000 for total in totals
    )


def test_random_icds_agree_in_all_languages():
    totals = check(1, ["c", "javascript", "python", "rust-debug"], start=1)
    assert all(
        total.vectors > 100 and total.differences == 0 for total in totals.values()
    )


def test_another_package_can_add_a_language_by_an_entry_point(tmp_path, monkeypatch):
    (tmp_path / "icdgen_other.py").write_text(
        "from tests.conformance.languages import Language\n"
        'LANGUAGES = [Language("other", ("c",), ("env true", "env false"), lambda source, out: [])]\n'
    )
    info = tmp_path / "icdgen_other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: icdgen-other\nVersion: 1.0\n"
    )
    (info / "entry_points.txt").write_text(
        "[icdgen.conformance]\nother = icdgen_other:LANGUAGES\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    other = all_languages()["other"]
    # A tool is installed if the command that prints its version ends with status 0.
    assert other.missing() == ["env"]
    assert "c" in all_languages()
