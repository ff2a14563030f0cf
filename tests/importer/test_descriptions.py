"""Facts of a description, and the prose that is left."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.descriptions import Described, read_description
from icdgen.importer.words import table_number

WORDS = profile.load()
FORMULA = "(formatted value) [V] = RAWVAL*0.1"


@pytest.mark.parametrize(
    ("text", "described"),
    [
        ("", Described()),
        ("Speed of the wheel.", Described(prose="Speed of the wheel")),
        (f"Speed. {FORMULA}. Of it", Described("V", "raw*0.1", prose="Speed. Of it")),
        ("Speed (Unit of measure is [m/s]), averaged.",
        Described("m/s", prose="Speed, averaged")),
        ("Speed. Unit: rpm", Described("rpm", prose="Speed")),
        # The words announce the value that the formula does not give.
        (f"Raw value is obtained using the formula: {FORMULA}",
        Described("V", "raw*0.1", "raw")),
        (f"Physical value is obtained using the formula: {FORMULA}",
        Described("V", "raw*0.1")),
        # Formula and unit repeat each other, or differ.
        (f"{FORMULA}. Unit: V", Described("V", "raw*0.1")), (f"{FORMULA}. Unit: mV",
        Described("V", "raw*0.1", problems=["it gives two units: `V` and `mV`"])),
        ("Physical value is obtained using the formula above", Described(prose="above",
        problems=["a formula is there and cannot be read"])),
        ("Physical value is obtained using the formula",
        Described(problems=["a formula is there and cannot be read"])),
        ("Must be 90 (0x5A)", Described(const="0x5A", prose="Must be 90 (0x5A)")),
        ("Must be 90 (0x5B)",
         Described(prose="Must be 90 (0x5B)", problems=[
             "it gives the value in two ways that differ: 90 (0x5B)"])),
        ("Always 0.", Described(const="0", prose="Always 0")),
        ("Always 0.5", Described(prose="Always 0.5")),
        ("Must be 1, or 2. Always 7", Described(const="7", prose="Must be 1, or 2. Always 7")),
        # A range, with or without blanks, is no constant.
        ("Must be 1 – 5", Described(prose="Must be 1 – 5")),
        ("Must be 1-5", Described(prose="Must be 1-5")),
        ("Must be 1 .. 5", Described(prose="Must be 1 .. 5")),
        ("Must be 0x5A - the key",
        Described(const="0x5A", prose="Must be 0x5A - the key")),
        ("Must be 1 If on", Described(prose="Must be 1 If on")),
        ("Must be 1 Ordinary", Described(const="1", prose="Must be 1 Ordinary")),
    ],
)  # fmt: skip
def test_a_description_gives_its_facts_and_the_remaining_prose(text, described):
    assert read_description(text, WORDS) == described


@pytest.mark.parametrize(
    ("text", "prose"),
    [
        (f"Speed: {FORMULA}. Of it", "Speed. Of it"),
        (f"Speed. {FORMULA}: Of it", "Speed. Of it"), (f"Speed: {FORMULA}", "Speed"),
        # Dots of the text itself stay, such as those of a range.
        (f"From 1..5 {FORMULA}", "From 1..5"),
        ("From 1..5, 2 .. 3 and 4:5 ...", "From 1..5, 2 .. 3 and 4:5"),
        ("Speed , of it ; a . B", "Speed, of it; a. B"),
    ],
)  # fmt: skip
def test_marks_around_removed_phrases_are_joined(text, prose):
    assert read_description(text, WORDS).prose == prose


@pytest.mark.parametrize(
    ("text", "table", "title", "prose"),
    [
        ("Mode. Possible values are in Table 4-12: Pump Modes. More",
        "4-12", "Pump Modes", "Mode. More"), ("Mode (see Tab. 7)", "7", "", "Mode ()"),
        # Any other mention of a table; its words stay.
        ("Mode of Table 7 – Pump Modes (1)", "7", "Pump Modes", "Mode of Table 7 – Pump Modes (1)"),
        ("As TABLE 4.2 says", "4.2", "", "As TABLE 4.2 says"),
        ("Vegetable 7", None, "", "Vegetable 7"), ("Mode", None, "", "Mode"),
    ],
)  # fmt: skip
def test_an_enumeration_is_the_table_that_the_text_names(text, table, title, prose):
    described = read_description(text, WORDS, is_enum=True)
    number = table_number(table) if table else None
    assert described == Described(enum_table=number, enum_title=title, prose=prose)
    # Other fields do not refer to enumerations.
    other = read_description(text, WORDS)
    assert (other.enum_table, other.enum_title) == (None, "")


def test_a_phrase_can_name_the_title_of_an_enumeration():
    words = profile.load()
    words.data["phrases"]["enumeration"] = ["one of {title}", "see {table}"]
    described = read_description("Mode: one of Pump Modes. see Table 7", words, True)
    assert (described.enum_table, described.enum_title) == (None, "Pump Modes")
    assert described.prose == "Mode. see Table 7"
