"""``icdgen show --format json`` of every feature of the format agrees with its schema."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema_rs
import pytest

from icdgen.loading import load
from icdgen.show.machine import SCHEMA, to_json
from tests.conftest import ROOT
from tests.features.data import examples, features

VALIDATOR = jsonschema_rs.validator_for(json.loads(SCHEMA.read_text("utf-8")))
TEXTS = {
    f"{section} {number}": text
    for section, texts in examples().items()
    for number, text in enumerate(texts, 1)
}
FILES = [
    ROOT / "icd",
    *sorted((ROOT / "examples").rglob("*.yaml")),
    ROOT / "tests" / "conformance" / "odd_icds",
]


def shown(path: Path) -> object:
    loaded = load([path])
    assert [
        finding.message for finding in loaded.findings if finding.severity == "error"
    ] == []
    return json.loads(json.dumps(to_json(loaded.icd)))


def violations(tree: object) -> list[str]:
    return [
        f"{list(error.instance_path)}: {error.message}"
        for error in VALIDATOR.iter_errors(tree)
    ]


@pytest.mark.parametrize("name", TEXTS)
def test_every_example_of_the_format_is_shown_as_the_schema_says(tmp_path, name):
    path = tmp_path / "example.yaml"
    path.write_text(TEXTS[name], encoding="utf-8")
    assert violations(shown(path)) == []


@pytest.mark.parametrize("feature", features(), ids=lambda feature: feature.name)
def test_every_other_form_of_a_feature_fits_the_schema(tmp_path, feature):
    path = tmp_path / "example.yaml"
    path.write_text(feature.changed(), encoding="utf-8")
    assert violations(shown(path)) == []


@pytest.mark.parametrize(
    "path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix()
)
def test_all_shipped_icds_are_shown_as_the_schema_says(path):
    assert violations(shown(path)) == []
