"""Types, units, enumerations and invalid values of MAVLink become keys of fields."""

from __future__ import annotations

import pytest

from icdgen.definitions.mavlink import MavLink2


def read(fields, enums=""):
    """Return the fields by name without position, the enumerations and the findings."""
    enums = f"<enums>{enums}</enums>" if enums else ""
    text = (
        f"<mavlink>{enums}<messages><message id='1' name='M'>"
        f"{fields}</message></messages></mavlink>"
    )
    definitions = MavLink2().read("a.xml", text.encode())
    (network,) = definitions.networks
    (message,) = network.messages
    items = {
        field["name"]: {key: field[key] for key in field if key not in ("at", "name")}
        for field in message["fields"]
    }
    return items, network.enums, [each.message for each in definitions.import_findings]


def field_of(type_, more="", enums=""):
    items, _, findings = read(f"<field type='{type_}' name='x' {more}/>", enums)
    assert findings == []
    return items["x"]


@pytest.mark.parametrize(
    ("type_", "expected"),
    [
        *((f"int{bits}_t", ("int", bits)) for bits in (8, 16, 32, 64)),
        *((f"uint{bits}_t", ("uint", bits)) for bits in (8, 16, 32, 64)),
        ("float", ("float", 32)), ("double", ("float", 64)), ("char[9]", ("text", 72)),
        ("char", ("text", 8)), ("uint16", ("uint", 16)), ("array[3]", ("int", 8)),
    ],
)  # fmt: skip
def test_a_type_has_its_width(type_, expected):
    field = field_of(type_)
    assert (field["type"], field["bits"]) == expected
    assert field.get("count") == (3 if type_ == "array[3]" else None)


@pytest.mark.parametrize(
    ("type_", "more", "keys"),
    [
        ("uint8_t", "units='cV'", {"unit": "V", "formula": "raw*0.01"}),
        ("float", "units='cV'", {"unit": "cV"}),
        ("float", "units='m/s/s'", {"unit": "m/s^2"}),
        ("int8_t", "multiplier='1E-2'", {"formula": "raw*1e-2"}),
        ("int8_t", "multiplier='1E-2/3'", {"formula": "raw*1e-2/3"}),
        ("int8_t", "units='dm' multiplier='5'", {"unit": "m", "formula": "raw*0.1*5"}),
        ("int8_t", "multiplier='1'", {}),
        ("int8_t", "multiplier='x'", {}),
        ("int8_t", "multiplier='1.2.3'", {}),
    ],
)
def test_a_unit_with_a_factor_is_a_formula_of_integers(type_, more, keys):
    field = field_of(type_, more)
    assert {key: field[key] for key in ("unit", "formula") if key in field} == keys


@pytest.mark.parametrize(
    ("type_", "text", "value"),
    [
        ("uint16_t", "UINT16_MAX", 0xFFFF), ("int16_t", "INT16_MAX", 0x7FFF),
        ("uint8_t", "UINT16_MAX", None), ("int8_t", "-128", -128),
        ("int8_t", "-129", None), ("uint8_t", "0", 0), ("uint8_t", "0xFF", 255),
        ("uint8_t[2]", "[UINT8_MAX:]", 255), ("float", "NaN", "nan"),
        ("float[2]", "[NaN, ]", "nan"), ("float", "-1000", -1000),
        ("uint8_t", "NaN", None), ("uint8_t", "", None), ("uint8_t", "1&lt;&lt;3", 8),
        ("uint8_t", "2**3", 8), ("uint8_t", "3 ** 2", 9), ("uint8_t", "010", 10),
    ],
)  # fmt: skip
def test_an_invalid_value_is_special(type_, text, value):
    expected = None if value is None else [{"value": value, "meaning": "not known"}]
    assert field_of(type_, f"invalid='{text}'").get("special") == expected


def enum(name, *entries):
    listed = "".join(f"<entry {more} name='{label}'/>" for label, more in entries)
    return f"<enum name='{name}'>{listed}</enum>"


def test_members_lose_common_words_and_continue_from_the_highest_value():
    entries = [("A_MODE_OFF", ""), ("A_MODE_ON", "value='7'"), ("A_MOVE", "value='3'"),
               ("A_LAST", "")]  # fmt: skip
    fields = "<field type='uint8_t' name='x' enum='A' invalid='3'/>"
    items, (declared,), findings = read(fields, enum("A", *entries))
    assert findings == []
    assert declared == {
        "name": "A",
        "members": [
            {"value": 1, "name": "MODE_OFF"},
            {"value": 3, "name": "MOVE"},
            {"value": 7, "name": "MODE_ON"},
            {"value": 8, "name": "LAST"},
        ],
    }
    # The invalid value has a name already.
    assert items["x"] == {"bits": 8, "type": "enum", "enum": "A"}


@pytest.mark.parametrize(
    ("labels", "names"),
    [
        (["A_ON"], ["ON"]),
        (["B_ON"], ["B_ON"]),
        (["B_C_ON", "B_C_OFF"], ["ON", "OFF"]),
        (["B_C", "B_C_OFF"], ["C", "C_OFF"]),
        (["B_", "B_OFF"], ["B_", "OFF"]),
    ],
)
def test_a_prefix_ends_at_an_underscore_and_leaves_a_name(labels, names):
    entries = [(label, f"value='{value}'") for value, label in enumerate(labels)]
    fields = "<field type='uint8_t' name='x' enum='A'/>"
    _, (declared,), _ = read(fields, enum("A", *entries))
    assert [member["name"] for member in declared["members"]] == names


def test_names_of_values_that_a_field_cannot_have_make_no_enumeration():
    entries = [
        ("A_ON", "value='255'"),
        ("A_FAR", "value='256'"),
        ("A_BAD", "value='x'"),
    ]
    fields = "<field type='uint8_t' name='x' enum='A'/>"
    items, _, findings = read(fields, enum("A", *entries, ("A_TWO", "value='255'")))
    assert items["x"]["special"] == [{"value": 255, "meaning": "ON"}]
    assert findings == [
        "enumeration `A`: `A_BAD` has the value `x`",
        "enumeration `A`: 255 is `A_ON` and `A_TWO`",
        "message `M`, `x`: it never has the value 256 of `A`",
    ]
