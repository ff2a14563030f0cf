"""Every output supports every feature of the format, or the page states the reason."""

from __future__ import annotations

import dataclasses

from tests.features.data import examples, features, unmeasured
from tests.features.measure import row
from tests.features.page import OUTPUTS, PAGE, page

FEATURES = {feature.name: feature for feature in features()}


def test_every_output_supports_every_feature_or_has_a_reason(tmp_path):
    """The page must also be up to date. One test, so that no two workers measure the
    same.
    """
    measured = {
        name: (feature, row(feature, tmp_path)) for name, feature in FEATURES.items()
    }
    for name, (feature, cells) in measured.items():
        assert cells.keys() == OUTPUTS.keys() >= feature.without.keys(), name
        assert {output for output, cell in cells.items() if not cell.has} == set(
            feature.without
        ), name
    assert PAGE.read_text("utf-8") == page(measured), "python -m tests.features"


def test_every_example_of_the_format_belongs_to_a_feature_or_is_listed_as_unmeasured():
    used = {feature.example for feature in FEATURES.values()}
    unused = {
        heading
        for heading, texts in examples().items()
        for text in texts
        if text not in used
    }
    assert unused <= set(unmeasured())
    assert not {feature.section for feature in FEATURES.values()} & set(unmeasured())


def test_an_output_that_ignores_a_feature_is_detected(tmp_path):
    """A change without effect on the results must not count as support."""
    feature = FEATURES["Constants"]
    unsupported = dataclasses.replace(
        feature,
        uses={"fields": {"thermocouple": ".*"}},
        change=("icdgen: 1\n", "icdgen: 1\n# the same, with another digest\n"),
        wrong=("0x5A", "0x5B"),
        without={
            "random": "no draw has it, and to look through all of them takes minutes"
        },
    )
    has = {output for output, cell in row(unsupported, tmp_path).items() if cell.has}
    assert has == {"fmt"}
