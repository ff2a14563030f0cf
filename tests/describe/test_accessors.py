"""Every language has the same accessors of physical values, as far as its types allow."""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.accessors import accessors_of
from tests.icd.files import loaded, status

ALL = ("text", "double", "single", "integer", "long integer")


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("bits: 16, type: uint", {}),
        ("bits: 16, type: text", {"text": "rate_text"}),
        (
            "bits: 8, type: uint, formula: raw / 3",
            {"double": "rate_physical", "single": "rate_physical_f32"},
        ),
        ("bits: 8, type: uint, formula: raw^2", {"double": "rate_physical"}),
        (
            "bits: 16, type: int, unit: deg/s, formula: raw / 1000",
            {
                "double": "rate_deg_per_s",
                "single": "rate_deg_per_s_f32",
                "integer": "rate_mdeg_per_s",
            },
        ),
        (
            "bits: 64, type: uint, unit: m, formula: raw * 5",
            {"double": "rate_m", "single": "rate_m_f32", "long integer": "rate_mm"},
        ),
    ],
)
def test_a_field_has_accessors_for_the_types_that_can_store_its_values(
    tmp_path, field, expected
):
    result = loaded(tmp_path, status(f"at: 0, name: Rate, {field}", length=8))
    (rate,) = describe(result.icd).nodes[0].messages[0].members
    assert {
        accessor.kind: accessor.name for accessor in accessors_of(rate, *ALL)
    } == expected
    assert {
        accessor.kind for accessor in accessors_of(rate, *ALL) if accessor.is_settable
    } == {*expected} - {"single"}
    assert [accessor.kind for accessor in accessors_of(rate, "single")] == [
        "single"
    ] * ("single" in expected)


def test_an_overlay_field_has_no_setters(tmp_path):
    fields = (
        "at: 0, name: Rate, bits: 16, type: uint",
        "at: 0, name: Low, bits: 8, type: uint, view: true, formula: raw * 2",
    )
    message = (
        describe(loaded(tmp_path, status(*fields, length=2)).icd).nodes[0].messages[0]
    )
    (low,) = message.overlays
    kinds = {
        accessor.kind: accessor.is_settable for accessor in accessors_of(low, *ALL)
    }
    assert kinds == {"double": False, "single": False, "integer": False}


@pytest.mark.parametrize(
    ("field", "comments"),
    [
        (
            "bits: 16, type: int, unit: V, formula: raw / 1000, min: 0",
            [
                "Rate in V: -32.768 to 32.767. Must be at least 0 V, which setters do not check.",
                "Rate in V, the nearest float of 32 bits.",
                "Rate in mV, exact: -32768 to 32767.",
            ],
        ),
        (
            "bits: 8, type: uint, formula: raw / 3",
            [
                "Rate, as a physical value: 0 to 85.",
                "Rate, as a physical value, the nearest float of 32 bits.",
            ],
        ),
        (
            "bits: 16, type: text",
            ["Rate as text: up to 2 ASCII characters, ending at the first NUL."],
        ),
    ],
)
def test_the_comment_of_an_accessor_states_its_unit_and_its_range(
    tmp_path, field, comments
):
    result = loaded(tmp_path, status(f"at: 0, name: Rate, {field}", length=8))
    (rate,) = describe(result.icd).nodes[0].messages[0].members
    assert [accessor.comment for accessor in accessors_of(rate, *ALL)] == comments


def test_a_language_without_a_kind_still_has_the_kinds_after_it(tmp_path):
    field = "at: 0, name: Rate, bits: 8, type: uint, unit: V, formula: raw / 1000"
    (rate,) = (
        describe(loaded(tmp_path, status(field, length=1)).icd)
        .nodes[0]
        .messages[0]
        .members
    )
    assert [accessor.kind for accessor in accessors_of(rate, "integer")] == ["integer"]
    assert list(accessors_of(rate, "text", "long integer")) == []
    (integer,) = accessors_of(rate, "integer")
    assert integer.integer_access == rate.arithmetic.integer_access
