"""No key of the protocol section is passed over: it makes a difference on the wire, to
the port or the pages, or a finding.
"""

from __future__ import annotations

import pytest
import yaml

from icdgen import backends
from icdgen.backends.html import site
from icdgen.backends.packages import Packages
from icdgen.diff.facts import facts as differences
from icdgen.render import Renderer
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
    assert set(TABLE.values()) <= {
        "wire",
        "finding",
        "port",
        "simulator",
        "told",
        "only",
    }


def test_each_key_makes_a_difference_or_a_finding(found):
    """Here of the facts that vectors are made of: each key costs a check of the ICDs.

    The walk by hand compares all vectors.
    """
    heeded = {key for key, what in found.items() if what & {walk.WIRE, walk.FINDING}}
    assert heeded >= {key for key, what in TABLE.items() if what in ("wire", "finding")}
    assert "only" not in {TABLE[key] for key in heeded}


@pytest.mark.parametrize(
    "key", [key for key, what in TABLE.items() if what in ("port", "simulator", "told")]
)
def test_what_else_the_section_says_is_told_by_the_site_and_the_diff(key, sources):
    source, place = next(
        (one, it)
        for one in sources
        for it in walk.places(one.section, BY_NAME[key].path)
    )
    changed = source.load(source.at(place, source.others(BY_NAME[key], place)[0]))
    assert page(changed) != page(source.icd)
    before, after = (
        next(node for node in icd.nodes if node.protocol)
        for icd in (source.icd, changed)
    )
    assert list(differences(before, after))


def page(icd):
    """The first page on how a node talks."""
    render = Renderer.of_backend(backends.get("html"))
    return next(
        text
        for path, text in site.files(icd, render, Packages())
        if path.name == "protocol.html"
    )
