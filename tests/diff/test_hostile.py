"""Any input to the diff gives a report or a finding, never a traceback."""

from __future__ import annotations

import copy
import json
import random

import pytest

from icdgen.diagnostics import Findings
from icdgen.diff import report, reports
from icdgen.diff.inputs import shown
from icdgen.diff.inputs.side import ComparisonSide, from_paths
from icdgen.loading import load
from icdgen.show.machine import to_json
from tests.conftest import ROOT

VALUES = [
    0, 1, 7, 64, 65, 1000, -1, "", "x", "1/3", "0", "-5", "uint", "int", "bool", "enum", "float", "bytes", "telemetry",
    "telecommand", "configuration", "big", "msb0", [], {}, None, True, "None", "9 x", "\u00e9", "a b",
]  # fmt: skip


def mutated(tree: dict, seed: int) -> dict:
    """Return the tree with some values replaced, duplicated or removed."""
    rng, tree = random.Random(seed), copy.deepcopy(tree)
    for _ in range(rng.randint(1, 3)):
        owners = [owner for owner in containers(tree) if owner]
        owner = rng.choice(owners)
        key = rng.choice(list(owner) if isinstance(owner, dict) else range(len(owner)))
        what = rng.random()
        if what < 0.2:
            del owner[key]
        elif what < 0.4 and isinstance(owner, list):
            owner.append(copy.deepcopy(owner[key]))
        else:
            owner[key] = rng.choice(VALUES)
    return tree


def containers(tree: object):
    if isinstance(tree, (dict, list)):
        yield tree
        for item in tree.values() if isinstance(tree, dict) else tree:
            yield from containers(item)


def compared_both_ways(first: ComparisonSide, other: ComparisonSide) -> None:
    for sides in ((first, other), (other, first)):
        diff_report = report.make_report(*sides)
        for form in reports.FORMATS:
            assert isinstance(reports.get(form)(diff_report), str)


def test_output_of_show_that_was_tampered_with(tmp_path):
    icd = load([ROOT / "icd" / "cubemag.yaml", ROOT / "icd" / "bootloader.yaml"]).icd
    tree = json.loads(json.dumps(to_json(icd)))
    untouched = shown.from_bytes(json.dumps(tree).encode(), "whole.json")
    read = 0
    for seed in range(70):
        try:
            side = shown.from_bytes(
                json.dumps(mutated(tree, seed)).encode(), "tampered.json"
            )
        except Findings as error:
            assert all(
                finding.message and finding.place.file == "tampered.json"
                for finding in error.findings
            )
            continue
        read += 1
        compared_both_ways(untouched, side)
    assert read > 8


def test_icds_that_break_rules(tmp_path, demo):
    import yaml

    tree = yaml.safe_load(demo.read_text(encoding="utf-8"))
    valid, read = from_paths([demo]), 0
    for seed in range(70):
        path = tmp_path / "tampered.yaml"
        path.write_text(json.dumps(mutated(tree, seed), indent=1), encoding="utf-8")
        side = from_paths([path], unchecked=True)
        if side.is_comparable(unchecked=True):
            read += 1
            compared_both_ways(valid, side)
    assert read > 8


@pytest.mark.parametrize(
    "change, expected",
    [
        (('"scale": "1/100"', '"scale": "0"'), "`scale` cannot be 0"),
        (('"includes": []', '"includes": ["nowhere"]'), "which is not shown before it"),
    ],
)
def test_mistakes_beyond_the_schema_are_findings(demo, change, expected):
    text = json.dumps(to_json(load([demo]).icd))
    assert change[0] in text
    with pytest.raises(Findings) as caught:
        shown.from_bytes(text.replace(*change).encode(), "shown.json")
    assert expected in caught.value.findings[0].message
