"""Symbols of units: the standard ones, other spellings, and suggestions."""

from __future__ import annotations

import pytest

from icdgen.icd import units
from icdgen.icd.units import STANDARD, Unit, similar_unit


@pytest.mark.parametrize(
    "unit",
    [
        Unit("deg/s^2", "deg_per_s2", "angular acceleration"),
        Unit("C", "c", "temperature (degrees Celsius)"),
        Unit("%", "percent", "ratio"),
        Unit("bit/s", "bit_per_s", "data rate"),
    ],
)
def test_a_standard_unit_has_symbol_identifier_and_quantity(unit):
    assert STANDARD[unit.symbol] == unit


def test_units_have_different_identifiers():
    assert len({unit.identifier for unit in STANDARD.values()}) == len(STANDARD)


@pytest.mark.parametrize(
    ("sign", "symbol"),
    [
        ("°C", "C"),
        ("\u2103", "C"),
        ("\u03a9", "ohm"),
        ("\u2126", "ohm"),
        ("\u00b5s", "us"),
        ("\u03bcs", "us"),
        ("\u00b5N.m", "uN.m"),
        ("\u03bcT", "uT"),
    ],
)
def test_an_importer_replaces_signs_that_mean_one_standard_unit(sign, symbol):
    assert units.SIGNS[sign] == symbol
    assert similar_unit(sign, ()) == symbol


def test_other_spellings_stand_for_standard_units():
    assert set(units.SPELLINGS.values()) <= set(STANDARD)
    assert not STANDARD.keys() & units.SPELLINGS.keys()
    assert {"degree", "bits"}.isdisjoint(units.SIGNS)


@pytest.mark.parametrize(
    ("symbol", "declared", "similar"),
    [
        ("degrees", (), "deg"),
        ("m²", (), "m^2"),
        ("A·m²", (), "A.m^2"),
        ("A*m**2", (), "A.m^2"),
        ("m / s^2", (), "m/s^2"),
        ("deg/s2", (), "deg/s^2"),
        ("meters/sec", (), "m/s"),
        ("N m", (), "N.m"),
        ("mNm", (), "mN.m"),
        ("Deg/s", (), "deg/s"),
        ("kHZ", (), "kHz"),
        ("ticks", (), ""),
        ("tick", ("ticks",), "ticks"),
        ("kticks", ("ticks",), ""),
        ("kg·furlong", ("kg.furlong",), "kg.furlong"),
        ("kgfurlong", ("kg.furlong",), "kg.furlong"),
        ("kg.m2/s", ("kg.m^2/s",), "kg.m^2/s"),
        ("kV", (), ""),
        ("ml/s", (), ""),
        ("m^3", (), ""),
        ("m/s/s", (), ""),
        ("", (), ""),
    ],
)
def test_an_unknown_symbol_is_compared_with_units_of_the_same_size(
    symbol, declared, similar
):
    assert similar_unit(symbol, declared) == similar


def test_imported_units_have_identifiers_that_differ_from_all_others():
    symbols = ["V", "kV", "KV", "\u00b5g", "W/m\u03a9", "°", "", "%%", "kV", "s_per"]
    assert units.declared(symbols) == [
        {"symbol": symbol, "identifier": identifier, "quantity": "not stated"}
        for symbol, identifier in (
            ("kV", "kv"),
            ("KV", "kv_"),
            ("\u00b5g", "ug"),
            ("W/m\u03a9", "w_mohm"),
            ("°", "deg_"),
            ("", "unit"),
            ("%%", "unit_"),
            ("s_per", "s_per"),
        )
    ]
