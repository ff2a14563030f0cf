"""Every feature of the format is in every output, or the page says why not."""

from __future__ import annotations

import dataclasses

from tests.features.data import examples, features, unmeasured
from tests.features.measure import row
from tests.features.page import OUTPUTS, PAGE, page

FEATURES = {feature.name: feature for feature in features()}


def test_every_feature_is_in_every_output_but_those_that_are_said_to_lack_it(tmp_path):
    """And the page says so. In one test, so that no two workers measure the same."""
    measured = {
        name: (feature, row(feature, tmp_path)) for name, feature in FEATURES.items()
    }
    for name, (feature, cells) in measured.items():
        assert cells.keys() == OUTPUTS.keys() >= feature.without.keys(), name
        assert {output for output, cell in cells.items() if not cell.has} == set(
            feature.without
        ), name
    assert PAGE.read_text("utf-8") == page(measured), "python -m tests.features"


def test_every_example_of_the_format_is_that_of_a_feature_or_said_not_to_be_measured():
    used = {feature.example for feature in FEATURES.values()}
    left = {
        heading
        for heading, texts in examples().items()
        for text in texts
        if text not in used
    }
    assert left <= set(unmeasured())
    assert not {feature.section for feature in FEATURES.values()} & set(unmeasured())


def test_an_output_that_does_not_know_a_feature_is_noticed(tmp_path):
    """What changes nothing that an output says is nothing that it has."""
    feature = FEATURES["Constants"]
    nothing = dataclasses.replace(
        feature,
        uses={"fields": {"thermocouple": ".*"}},
        change=("icdgen: 1\n", "icdgen: 1\n# the same, with another digest\n"),
        wrong=("0x5A", "0x5B"),
        without={
            "random": "no draw has it, and to look through all of them takes minutes"
        },
    )
    has = {output for output, cell in row(nothing, tmp_path).items() if cell.has}
    assert has == {"fmt"}
