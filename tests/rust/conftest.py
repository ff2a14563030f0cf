"""Fixtures: generated crates, each generated once in a run of the tests."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from icdgen.icd.model import Icd
from tests.every_language.programs import write_icds
from tests.every_language.stories import STORIES
from tests.rust import harness, odd


class Subject(NamedTuple):
    """ICDs, and the main file of the crate generated from them."""

    icd: Icd
    crate: Path


@pytest.fixture(scope="session")
def shipped(tmp_path_factory) -> Subject:
    return Subject(
        harness.shipped(),
        harness.generate(harness.shipped(), tmp_path_factory.mktemp("shipped")),
    )


@pytest.fixture(scope="session")
def strange(tmp_path_factory) -> Subject:
    """Crate of ICDs with features that the ICDs of the project do not use."""
    icd = harness.read_unchecked(*odd.write(tmp_path_factory.mktemp("icd")))
    return Subject(icd, harness.generate(icd, tmp_path_factory.mktemp("strange")))


@pytest.fixture(scope="session")
def stories(tmp_path_factory) -> Subject:
    """Crate of the ICDs of `tests.every_language`: arrays, structs and more."""
    folder = tmp_path_factory.mktemp("stories")
    icd = write_icds(STORIES, folder / "icd")
    return Subject(icd, harness.generate(icd, folder))


@pytest.fixture(scope="session", params=["shipped", "strange"])
def subject(request) -> Subject:
    """Run the test with each of the two crates."""
    return request.getfixturevalue(request.param)
