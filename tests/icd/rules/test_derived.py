"""Derived values: an error is reported where it is, and not where its result is used."""

from __future__ import annotations

from icdgen.icd.rules import derived  # noqa: F401
from tests.icd.files import status
from tests.icd.rules.rows import rows


def test_values_that_use_a_wrong_value_are_not_reported(tmp_path):
    text = status(
        "at: 0, bits: 8, name: A, type: uint", "at: 8, bits: 8, name: B, type: uint"
    ) + (
        "    derived:\n"
        "      - {name: Sum, formula: A + B}\n"
        "      - {name: Twice, formula: Sum*2}\n"
        "      - {name: Wrong, formula: Sum + C}\n"
        "      - {name: Uses, formula: Wrong + A}\n"
        "      - {name: Uses it, formula: Uses + Wrong}\n"
        "      - {name: Own Fault, formula: Wrong + D}\n"
        "      - {name: Early, formula: Last + A}\n"
        "      - {name: Last, formula: A - B}\n"
    )
    assert rows(tmp_path, text, "ICD180") == [
        "14:32 `Wrong` cannot be derived by `Sum + C`: there is no field `C`",
        "17:36 `Own Fault` cannot be derived by `Wrong + D`: there is no field `D`",
        "18:32 `Early` cannot be derived by `Last + A`: `Last` is not derived before it",
    ]


def test_values_that_use_a_right_value_are_checked(tmp_path):
    """Also beside items that violate the schema."""
    text = status(
        "at: 0, bits: 8, name: A, type: uint",
        "at: 8, bits: 8, count: 2, name: Levels, type: uint",
        length=3,
    ) + (
        "    derived:\n"
        "      - {name: Sum, formula: A + A}\n"
        "      - {name: No Formula}\n"
        "      - {formula: A + Nothing}\n"
        "      - {name: [Listed], formula: A + Nothing}\n"
        "      - {name: Number, formula: 3}\n"
        "      - {name: Wrong, formula: Sum + Levels}\n"
    )
    assert rows(tmp_path, text, "ICD180") == [
        "17:32 `Wrong` cannot be derived by `Sum + Levels`: `Levels` is an array"
    ]
