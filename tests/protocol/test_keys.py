"""No key of the protocol section is passed over: each makes a difference on the wire, or a finding."""

from __future__ import annotations

import copy

import pytest
import yaml

from icdgen.diff.facts import facts as differences
from tests.protocol import walk

TABLE = yaml.safe_load(walk.TABLE.read_text(encoding="utf-8"))
BY_NAME = {str(key): key for key in walk.all_keys()}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return walk.walked(tmp_path_factory.mktemp("walk"), whole=False)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return list(walk.sources(tmp_path_factory.mktemp("sources")))


def test_the_table_has_the_keys_of_the_format():
    assert list(TABLE) == list(BY_NAME)
    assert set(TABLE.values()) <= {"wire", "finding", "port", "simulator", "told", "only"}


def test_each_key_makes_a_difference_or_a_finding(found):
    """Here of the facts that vectors are made of: each key costs a check of the ICDs. The walk by hand compares all vectors."""
    heeded = {key for key, what in found.items() if what & {walk.WIRE, walk.FINDING}}
    assert heeded >= {key for key, what in TABLE.items() if what in ("wire", "finding")}
    assert not {key for key in heeded if TABLE[key] in ("port", "only")}


@pytest.mark.parametrize("key", [key for key, what in TABLE.items() if what in ("port", "simulator", "told")])
def test_what_else_the_section_says_is_told_by_the_diff(key, sources):
    source, place = next((one, it) for one in sources for it in walk.places(one.section, BY_NAME[key].path))
    before, *_ = (node for node in source.icd.nodes if node.protocol)
    after = copy.copy(before)
    object.__setattr__(after, "protocol", source.at(place, source.others(BY_NAME[key], place)[0]))
    assert list(differences(before, after))
