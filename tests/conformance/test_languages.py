"""Every language answers every vector as the reference codec does: the shipped ICDs, and odd ones."""

from __future__ import annotations

import pytest

from tests.conformance import odd, physical
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import SELFTEST, TESTEE, all_languages
from tests.conformance.random_icds import check
from tests.conformance.run import run

LANGUAGES = [language for language in all_languages().values() if language.kind in (TESTEE, SELFTEST)]
OPTIONAL = {"python3.9"}  # not every machine has an interpreter that old


@pytest.fixture(scope="module")
def shipped():
    icd = icd_of()
    return icd, vectors_of(icd)


@pytest.fixture(scope="module")
def strange(tmp_path_factory):
    icd = icd_of([odd.write(tmp_path_factory.mktemp("icd"))])
    return icd, vectors_of(icd)


@pytest.mark.parametrize(
    "language", [one for one in LANGUAGES if one.name not in OPTIONAL], ids=lambda language: language.name
)
def test_a_language_agrees_with_the_reference_codec(shipped, strange, language, tmp_path):
    assert not language.missing(), f"scripts/test installs {', '.join(language.missing())}"
    for (icd, files), frames in ((strange, 20), (shipped, 2)):
        (result,) = run([language], icd, files, frames, folder=tmp_path)
        assert result.differences == 0, "\n".join(result.shown)
        assert result.vectors >= sum(len(m["vectors"]) for data in files.values() for m in data["messages"])


@pytest.mark.parametrize("name", ["c", "python", "rust"])
def test_physical_values_are_the_same_to_the_last_bit(strange, name, tmp_path):
    totals, notes = physical.run([name], strange[0], 2000, tmp_path)
    assert notes == []
    assert totals[0].fields == 6 and totals[0].values > 20_000


def test_random_icds_agree_in_all_languages():
    totals = check(10, ["c", "python", "rust-debug"], start=1)
    assert all(total.vectors > 100 and total.differences == 0 for total in totals.values())
