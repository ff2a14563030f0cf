"""No key of the protocol section is ignored.

Another value changes the wire, the port, the simulator or the documentation, or is an
error.
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
def outcomes_by_key(tmp_path_factory):
    return walk.effects_of_keys(tmp_path_factory.mktemp("walk"), with_vectors=False)


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
        "documented",
        "only",
    }


def test_each_key_makes_a_difference_or_a_finding(outcomes_by_key):
    """Only the facts are compared, because a comparison of all vectors takes minutes.

    `python -m tests.protocol.walk` compares the vectors.
    """
    effective = {
        key for key, what in outcomes_by_key.items() if what & {walk.WIRE, walk.FINDING}
    }
    assert effective >= {
        key for key, what in TABLE.items() if what in ("wire", "finding")
    }
    assert "only" not in {TABLE[key] for key in effective}


@pytest.mark.parametrize(
    "key",
    [key for key, what in TABLE.items() if what in ("port", "simulator", "documented")],
)
def test_keys_without_an_effect_on_the_wire_are_shown_by_the_site_and_the_diff(
    key, sources
):
    source, place = next(
        (source, place)
        for source in sources
        for place in walk.places(source.section, BY_NAME[key].path)
    )
    changed = source.load(source.at(place, source.other_values(BY_NAME[key], place)[0]))
    assert page(changed) != page(source.icd)
    before, after = (
        next(node for node in icd.nodes if node.protocol)
        for icd in (source.icd, changed)
    )
    assert list(differences(before, after))


def page(icd):
    """Return the first page about the protocol of a node."""
    render = Renderer.of_backend(backends.get("html"))
    return next(
        text
        for path, text in site.files(icd, render, Packages())
        if path.name == "protocol.html"
    )
