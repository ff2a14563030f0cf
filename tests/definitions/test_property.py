"""Properties of the import that hold for every signal and every table of values."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from icdgen.definitions import frames, wording
from icdgen.definitions.enumerations import Enumerations, members
from icdgen.definitions.model import Definitions
from icdgen.icd.formula import parse
from icdgen.icd.layout import integer_range

PLACES = st.builds(
    frames.FrameBits,
    st.integers(0, 480),
    st.integers(1, 32),
    st.sampled_from([frames.LITTLE, frames.BIG]),
)


@given(PLACES)
def test_both_ways_to_count_bits_give_the_same_bits(place):
    other = place.counted(frames.BIG if place.order == frames.LITTLE else frames.LITTLE)
    assert other.mask == place.mask and place.mask.bit_count() == place.bits
    assert (other.order != place.order) == place.is_within_byte


@given(
    st.dictionaries(
        st.integers(-4, 40),
        st.sampled_from(["Off", "On", "Spare", "", "Off 3", "Déjà\n vu"]),
    )
)
def test_each_named_value_has_one_member_and_member_names_are_unique(
    choices,
):
    drawn_members = members(choices, 0, 31, "here", Definitions(""))
    values = [
        value
        for member in drawn_members
        for value in range(member["value"], member.get("to", member["value"]) + 1)
    ]
    assert values == sorted(
        value for value, name in choices.items() if 0 <= value <= 31 and name
    )
    names = [member["name"] for member in drawn_members]
    assert len(set(names)) == len(names) and all(names)


@given(
    st.integers(1, 6), st.booleans(), st.dictionaries(st.integers(-32, 63), st.sampled_from(["Off", "On", "SNA"])),
    st.sampled_from([{}, {"unit": "km/h"}]), st.sampled_from([{}, {"formula": "raw*0.1"}]),
    st.dictionaries(st.sampled_from(["min", "max"]), st.integers(-8, 8)),
)  # fmt: skip
def test_named_values_keep_the_sign_unit_limits_and_formula(
    bits, is_signed, choices, unit, formula, limits
):
    kind = "int" if is_signed else "uint"
    field, enums, notes = (
        {"type": kind, **unit, **formula, **limits},
        Enumerations(),
        Definitions(""),
    )
    enums.assign_value_names(
        field, bits, choices, "Gear", "Status", "message `Status`, `Gear`", notes
    )
    declared = {enum["name"]: enum["members"] for enum in enums.declared()}
    first, last = integer_range(bits, is_signed)
    possible = {value for value in choices if first <= value <= last}
    if field["type"] == "enum":
        named = [
            value
            for member in declared["Gear"]
            for value in range(member["value"], member.get("to", member["value"]) + 1)
        ]
        assert is_signed == any(value < 0 for value in named), (
            "the sign of an enumeration is that of its values"
        )
        low, high = (
            max(first, limits.get("min", first)),
            min(last, limits.get("max", last)),
        )
        assert not formula and (
            not (unit or limits) or set(range(low, high + 1)) <= set(named)
        )
    else:
        assert (
            field["type"] == kind
            and field.items() >= (unit | formula | limits).items()
            and not declared
        )
        named = [value["value"] for value in field.get("special", ())]
        is_covered = (
            possible
            and not formula
            and not unit
            and not limits
            and is_signed == any(v < 0 for v in possible)
        )
        assert not is_covered, "names without a unit are an enumeration"
    assert sorted(named) == sorted(possible), (
        "each value that the field can have keeps its name"
    )
    assert len(choices) == len(possible) or any(
        finding.code == "IMP074" for finding in notes.import_findings
    )


NUMBERS = st.floats(-1e9, 1e9).filter(lambda number: abs(number) > 1e-12)


@given(NUMBERS, st.just(0.0) | NUMBERS, st.integers(-(2**31), 2**31))
def test_a_formula_equals_its_factor_and_offset(factor, offset, raw):
    formula = wording.formula(wording.printed(factor), wording.printed(offset)).get(
        "formula", "raw"
    )
    assert parse(formula).physical(Fraction(raw)) == Fraction(
        str(factor)
    ) * raw + Fraction(str(offset))


@given(st.text(max_size=30), st.text(max_size=30))
def test_names_of_nodes_are_valid_and_texts_have_one_line(name, text):
    import re

    assert re.fullmatch("[a-z][a-z0-9_]{0,39}", wording.node_name(name))
    assert "\n" not in wording.line(text) and wording.line(text) == wording.line(
        wording.line(text)
    )
