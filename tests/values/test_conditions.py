"""Optional fields on the command line."""

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


def test_only_present_fields_are_given_and_shown(icd):
    assert frame(icd, "type=1", "value=5") == "0500000000000040"
    assert frame(icd, "type=0") == "0" * 16
    (decoded,) = recognize(icd, "0500000000000040", "mux", "Choice")
    assert [(row.field.name, row.raw) for row in decoded.frame.rows] == [
        ("Value", 5),
        ("Type", 1),
    ]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (["type=1"], "no value for `Value`"),
        (["value=1"], "no value for `Type`"),
        (["type=2", "value=1"], "`Value` is absent: it is present only if Type is 1"),
    ],
)
def test_missing_and_absent_fields_are_reported(icd, values, expected):
    with pytest.raises(BadValue, match=expected):
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
        field
        for field in tree["nodes"][0]["messages"][0]["fields"]
        if field["name"] == "Is Fast"
    )
    assert fast["when"] == {"Flag": [1], "Mode": [1, 3]}
