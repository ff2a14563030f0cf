"""Fields that are not always there, as people give and read them."""

from __future__ import annotations

import json

import jsonschema_rs
import pytest

from icdgen.loading import load
from icdgen.recognize import recognize
from icdgen.show.machine import SCHEMA, to_json
from icdgen.show.people import to_text
from icdgen.values import encode
from icdgen.values.errors import BadValue
from tests.conformance import odd


@pytest.fixture(scope="module")
def icd():
    return load([odd.FOLDER / "mux.yaml"]).icd


def frame(icd, *values):
    return encode.encode(icd, "mux", "Choice", list(values)).data.hex()


def test_only_what_is_there_is_given_and_shown(icd):
    assert frame(icd, "type=1", "value=5") == "0500000000000040"
    assert frame(icd, "type=0") == "0" * 16
    (found,) = recognize(icd, "0500000000000040", "mux", "Choice")
    assert [(row.field.name, row.raw) for row in found.frame.rows] == [
        ("Value", 5),
        ("Type", 1),
    ]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (["type=1"], "no value for `Value`"),
        (["value=1"], "no value for `Type`"),
        (["type=2", "value=1"], "`Value` is absent: it is present only if Type is 1"),
    ],
)
def test_what_is_missing_or_not_there_is_said(icd, values, said):
    with pytest.raises(BadValue, match=said):
        frame(icd, *values)


def test_a_condition_is_shown_to_people_and_programs(icd):
    assert "only there if Flag is true and Mode is 1 or 3" in to_text(
        icd, ["mux", "Multiplexed"]
    )
    assert "only there if State is Idle or Stopped" in to_text(
        icd, ["mux", "Multiplexed"]
    )
    tree = to_json(icd)
    jsonschema_rs.validator_for(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    ).validate(tree)
    (fast,) = (
        one
        for one in tree["nodes"][0]["messages"][0]["fields"]
        if one["name"] == "Is Fast"
    )
    assert fast["when"] == {"Flag": [1], "Mode": [1, 3]}
