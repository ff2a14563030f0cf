"""Names of any language become identifiers that can be read."""

from __future__ import annotations

import pytest

from icdgen.naming import camel, latin, snake, words


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("Öffnungswinkel", "offnungswinkel"),
        (
            "O\u0308ffnungswinkel",
            "offnungswinkel",
        ),  # decomposed, as some editors write it
        ("Größe", "grosse"),
        ("GRÖSSE der Hülle", "grosse_der_hulle"),
        ("Straße 2 Süd", "strasse_2_sud"),
        ("STRAẞE", "strasse"),
        ("Température", "temperature"),
        ("Højde over Ærø", "hojde_over_aero"),
        ("ÆRA", "aera"),
        ("Længde", "laengde"),
        ("Œuvre", "oeuvre"),
        ("Łódź", "lodz"),
        ("20 Å", "20_a"),
        ("TemperaturÄußere", "temperatur_aussere"),
    ],
)
def test_a_letter_loses_its_mark_and_separates_no_words(name, identifier):
    assert snake(words(name)) == identifier


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("µV drift", "v_drift"),
        ("μV drift", "v_drift"),
        ("Δ pressure", "pressure"),
        ("Angle α of Sun", "angle_of_sun"),
        ("35 °C", "35_c"),
        ("½ turn", "1_2_turn"),
        ("Скорость", ""),
        ("速度 1", "1"),
    ],
)
def test_characters_without_a_latin_letter_separate_words(name, identifier):
    assert snake(words(name)) == identifier


def test_words_of_the_vocabulary_may_have_marks():
    assert words("ÖlDruckMax", ("ÖlDruck",)) == ("oldruck", "max")
    assert words("SRAMs Größe", ("SRAMs",)) == ("srams", "grosse")


def test_identifiers_of_names_with_marks_in_camel_case():
    assert camel(words("Öffnungswinkel der Hülle")) == "OffnungswinkelDerHulle"


def test_text_of_ascii_stays_as_it_is():
    assert latin("TcErrorReason 5%") == "TcErrorReason 5%"
