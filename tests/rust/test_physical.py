"""Physical values in generated Rust are computed by exactly these expressions."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.accessors import (
    accessors,
    curve_of,
    field_row,
    scale_of,
    texts,
)
from icdgen.backends.rust.physical import big_parts, derived_statements, has_constant
from icdgen.describe import describe
from tests.icd.files import loaded, status


def message_of(folder, *fields, length=16, more=""):
    result = loaded(folder, status(*fields, length=length) + more)
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0]


def member_of(folder, field):
    """Return the description of a field `Rate` behind a flag."""
    flag = "at: 127, bits: 1, name: Flag, type: bool"
    return message_of(folder, flag, f"at: 0, name: Rate, {field}").members[-1]


DOUBLES = [
    ("bits: 16, type: int, formula: raw*0.01", "f64::from(self.rate) / 100.0"),
    ("bits: 16, type: int, formula: raw*2", "f64::from(self.rate) * 2.0"),
    ("bits: 32, type: int, formula: raw*0.3", "(f64::from(self.rate) * 3.0) / 10.0"),
    ("bits: 8, type: uint, formula: raw*-1", "0.0 - f64::from(self.rate)"),
    ("bits: 8, type: uint, formula: raw*-3 + 40", "40.0 - f64::from(self.rate) * 3.0"),
    ("bits: 8, type: uint, formula: raw + 5", "f64::from(self.rate) + 5.0"),
    ("bits: 8, type: uint, formula: raw - 5", "f64::from(self.rate) - 5.0"),
    (
        "bits: 8, type: uint, formula: raw/8 + 0.5",
        "(f64::from(self.rate) + 4.0) / 8.0",
    ),
    (
        "bits: 8, type: uint, formula: raw/-8 - 0.5",
        "(-4.0 - f64::from(self.rate)) / 8.0",
    ),
    ("bits: 33, type: uint, formula: raw*0.1", "RATE.physical(self.rate)"),
    (
        "bits: 8, type: uint, count: 2, formula: raw*0.5",
        "f64::from(raw) / 2.0",
    ),
    (
        "bits: 8, type: uint, when: {Flag: true}, formula: raw*0.5",
        "f64::from(raw) / 2.0",
    ),
    (
        "bits: 8, type: uint, identifier: Type, formula: raw*0.5",
        "f64::from(self.r#type) / 2.0",
    ),
]


@pytest.mark.parametrize(("field", "value"), DOUBLES)
def test_a_double_is_rounded_once(tmp_path, field, value):
    getter = accessors(member_of(tmp_path, field))[0]
    assert (getter.type, getter.value) == ("f64", value)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("bits: 16, type: uint, formula: raw*0.01", "f32::from(self.rate) / 100.0"),
        ("bits: 17, type: uint, formula: raw*0.01", "RATE.single(self.rate)"),
    ],
)
def test_a_single_is_exact_for_raw_values_of_16_bits(tmp_path, field, value):
    _, single, *_ = accessors(member_of(tmp_path, field))
    assert (single.name, single.type) == ("rate_physical_f32", "f32")
    assert (single.value, single.raw, single.what) == (value, "", "")


INTEGERS = [
    (
        "bits: 16, type: uint, unit: deg, formula: raw*0.01",
        ("rate_mdeg", "i32", "i32::from(self.rate) * 10"),
        "RATE.whole(value.into(), 10, 0)",
    ),
    (
        "bits: 32, type: int, unit: V, formula: raw*0.001",
        ("rate_mv", "i64", "i64::from(self.rate)"),
        "RATE.whole(value, 1, 0)",
    ),
    (
        "bits: 32, type: int, unit: V, formula: raw*0.01 - 273",
        ("rate_mv", "i64", "i64::from(self.rate) * 10 - 273_000"),
        "RATE.whole(value, 10, -273_000)",
    ),
    (
        "bits: 8, type: uint, unit: V, formula: raw*-0.002 + 5",
        ("rate_mv", "i32", "i32::from(self.rate) * -2 + 5_000"),
        "RATE.whole(value.into(), -2, 5_000)",
    ),
]


@pytest.mark.parametrize(("field", "getter", "raw"), INTEGERS)
def test_an_integer_has_whole_parts_of_the_unit(tmp_path, field, getter, raw):
    accessor = accessors(member_of(tmp_path, field))[-1]
    assert (accessor.name, accessor.type, accessor.value) == getter
    assert (accessor.raw, accessor.refused) == (raw, "if it does not fit.")


def test_a_setter_says_what_it_sets_and_refuses(tmp_path):
    scaled = "bits: 8, type: uint, unit: V, formula: raw*0.5"
    (double, _, integer) = accessors(member_of(tmp_path, scaled))
    assert (double.name, double.raw) == ("rate_v", "RATE.raw(value)")
    assert double.what == "Set Rate in V to the nearest raw value, ties to even"
    assert double.refused == "if it does not fit or is not finite."
    assert integer.what == ("Set Rate in mV to the nearest raw value, ties to even")
    (double, *_) = accessors(member_of(tmp_path, f"{scaled}, count: 2"))
    assert double.what == (
        "Set an element of Rate in V to the nearest raw value, ties to even"
    )
    assert double.refused == (
        "if it does not fit or is not finite, or if there is no such element."
    )


POINTS = "points: [[0, 1], [10, 3], [20, 10]], outside: refuse"


@pytest.mark.parametrize(
    ("field", "value", "raw"),
    [
        (
            f"bits: 8, type: uint, {POINTS}",
            "RATE__CURVE.physical(f64::from(self.rate))",
            "RATE__CURVE.raw(value)",
        ),
        (
            "bits: 32, type: float, formula: raw*2 + 1",
            "RATE__CURVE.physical(f64::from(self.rate))",
            "RATE__CURVE.single(value)",
        ),
        (
            "bits: 64, type: float, formula: raw*2 + 1",
            "RATE__CURVE.physical(self.rate)",
            "RATE__CURVE.number(value)",
        ),
    ],
)
def test_a_calibration_is_computed_by_its_constant(tmp_path, field, value, raw):
    (accessor,) = accessors(member_of(tmp_path, field))
    assert (accessor.type, accessor.value, accessor.raw) == ("f64", value, raw)
    assert accessor.refused == "if it is beyond the values of the field, or not finite."


def test_a_calibration_of_many_digits_has_a_getter_only(tmp_path):
    (accessor,) = accessors(member_of(tmp_path, f"bits: 64, type: uint, {POINTS}"))
    assert (accessor.value, accessor.raw) == ("RATE__CURVE.whole(self.rate)", "")
    assert (accessor.what, accessor.refused) == ("", "")


def test_the_constant_of_a_calibration_has_its_ends_and_pieces(tmp_path):
    assert curve_of(member_of(tmp_path, f"bits: 8, type: uint, {POINTS}")) == (
        "#[rustfmt::skip]\n"
        'const RATE__CURVE: Curve = Curve::new("Rate", "1.0 to 10.0", (0, 20), &[\n'
        "    (0.0, &[]),\n"
        "    (0.0, &[1.0, 0.2]),\n"
        "    (10.0, &[3.0, 0.7]),\n"
        "    (20.0, &[10.0]),\n"
        "    (20.000_000_000_000_004, &[]),\n"
        "]);"
    )


@pytest.mark.parametrize(
    ("field", "terms"),
    [
        # Without an inverse and for floats, no raw value is searched for.
        ("bits: 16, type: int, formula: raw*raw*2 + 1", "1.0, 0.0, 2.0"),
        ("bits: 32, type: float, formula: raw*2 + 1", "1.0, 2.0"),
    ],
)
def test_a_calibration_of_one_piece_is_on_one_line(tmp_path, field, terms):
    text = curve_of(member_of(tmp_path, field))
    assert text.endswith(f", (0, 0), &[(0.0, &[{terms}])]);")
    assert text.count("\n") == 1


SCALES = [
    (
        "bits: 8, type: uint, formula: raw*-3/4 + 40",
        'const RATE: Scale = Scale::new("Rate", "-151.25 to 40", (0, 255), (-3, 160, 4));',
    ),
    (
        "bits: 4, type: int",
        'const RATE: Scale = Scale::new("Rate", "-8 to 7", (-8, 7), (1, 0, 1));',
    ),
]


@pytest.mark.parametrize(("field", "constant"), SCALES)
def test_the_constant_of_a_scale_has_limits_and_terms(tmp_path, field, constant):
    assert scale_of(member_of(tmp_path, field)) == constant


ROWS = [
    ("bits: 8, type: uint", '("Rate", 0, 8)'),
    ("bits: 8, type: uint, count: 3", '("Rate", 0, 8).array(3)'),
    ("bits: 16, type: text", '("Rate", 0, 16).text()'),
    ("bits: 8, type: uint, unit: V", '("Rate", 0, 8).unit("V")'),
    (
        "bits: 8, type: int, min: -3, below: 4",
        '("Rate", 0, 8).limits(&[("min", -3.0), ("below", 4.0)])',
    ),
    ("bits: 8, type: uint, formula: raw*0.5", '("Rate", 0, 8).scale(&RATE)'),
    (f"bits: 8, type: uint, {POINTS}", '("Rate", 0, 8).curve(&RATE__CURVE)'),
    (
        "bits: 64, type: uint, formula: raw*0.1234567890123456789012345",
        '("Rate", 0, 64).wide_scale(&RATE)',
    ),
]


@pytest.mark.parametrize(("field", "row"), ROWS)
def test_a_field_as_data_has_its_place_and_properties(tmp_path, field, row):
    assert field_row(member_of(tmp_path, field)) == row


def test_a_long_row_of_a_field_is_broken_before_its_properties(tmp_path):
    def row(count, unit):
        field = f"at: 0, bits: 8, type: uint, name: {'a' * count}, unit: {unit}"
        (member,) = message_of(tmp_path, field, length=1).members
        return field_row(member)

    count = 36
    line = f'("{"a" * count}", 0, 8).unit("V")'
    assert len(f"    {'a' * count}: {line},") == 99
    assert row(count, "V") == line
    assert row(count, "mV") == line.replace("V", "mV")
    name = "a" * (count + 1)
    assert row(count + 1, "V") == f'("{name}", 0, 8)\n        .unit("V")'


@pytest.mark.parametrize(
    ("field", "needed"),
    [
        ("bits: 8, type: uint", False),
        ("bits: 7, type: uint", True),
        ("bits: 8, type: uint, formula: raw*0.5", True),
        (f"bits: 8, type: uint, {POINTS}", False),
    ],
)
def test_only_code_that_uses_a_scale_declares_it(tmp_path, field, needed):
    assert has_constant(member_of(tmp_path, field)) == needed


@pytest.mark.parametrize(
    ("bits", "needed"), [(7, False), (16, False), (17, True), (33, True)]
)
def test_the_scale_of_an_overlay_is_declared_unless_floats_compute_it(
    tmp_path, bits, needed
):
    fields = (
        "at: 0, bits: 64, name: Word, type: uint",
        f"at: 0, bits: {bits}, name: Rate, type: uint, view: true, formula: raw*0.5",
    )
    (overlay,) = message_of(tmp_path, *fields, length=8).overlays
    assert has_constant(overlay) == needed
    value = accessors(overlay)[0].value
    assert value == {
        33: "RATE.physical(self.rate())",
    }.get(bits, "f64::from(self.rate()) / 2.0")
    assert all(not accessor.raw for accessor in accessors(overlay))


def test_a_term_of_a_wide_scale_has_parts_of_64_bits():
    assert big_parts(9) == ["9", "0", "0", "0"]
    ten = "0x0000_0000_0000_000a"
    assert big_parts(10) == [ten, "0", "0", "0"]
    assert big_parts((3 << 64) + 10) == [ten, "3", "0", "0"]
    assert big_parts(1 << 255) == ["0", "0", "0", "0x8000_0000_0000_0000"]


DERIVED = """\
    derived:
      - {name: Power, formula: Voltage*Level + Count - Ratio}
      - {name: Square, formula: Quiet*Quiet}
"""


def test_a_derived_value_is_computed_in_doubles(tmp_path):
    power, square = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Voltage, type: uint, unit: V, formula: raw*0.5",
        "at: 8, bits: 16, name: Level, type: int",
        "at: 24, bits: 64, name: Count, type: uint",
        "at: 88, bits: 64, name: Ratio, type: float",
        "at: 152, bits: 8, name: Quiet, type: uint",
        length=20,
        more=DERIVED,
    ).derived
    assert list(derived_statements(power)) == [
        "        let voltage = self.voltage_v();",
        "        let level = f64::from(self.level);",
        "        let count = whole(self.count);",
        "        let ratio = self.ratio;",
        "        let step_1 = voltage * level;",
        "        let step_2 = step_1 + count;",
        "        let step_3 = step_2 - ratio;",
        "        quiet(step_3)",
    ]
    # A variable has another name than the functions of the support module.
    first, *_, last = derived_statements(square)
    assert first == "        let quiet_ = f64::from(self.quiet);"
    assert last.startswith("        quiet(")


def test_accessors_of_arrays_of_texts_come_first(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 16, name: Label, type: text",
        "at: 16, bits: 8, name: Level, type: uint, formula: raw*0.5",
        "at: 24, bits: 16, name: Words, type: text, count: 2",
        "at: 56, bits: 8, name: End, type: text",
        length=8,
    )
    names = [accessor.field.model.name for accessor in texts(message)]
    assert names == ["Words", "Label", "End"]
    assert accessors(message.members[0]) == []


def test_a_long_constant_has_a_line_for_each_of_its_values(tmp_path):
    def constant(count):
        name = "a" * count
        field = f"at: 0, bits: 7, type: uint, name: {name}"
        (member,) = message_of(tmp_path, field, length=1).members
        return name, scale_of(member)

    # `    Scale::new(...);` of 100 columns is the longest line.
    fixed = len('    Scale::new("", "0 to 127", (0, 127), (1, 0, 1));')
    name, text = constant(100 - fixed)
    call = f'Scale::new("{name}", "0 to 127", (0, 127), (1, 0, 1));'
    assert text == f"const {name.upper()}: Scale =\n    {call}"
    name, text = constant(101 - fixed)
    assert text == (
        f"const {name.upper()}: Scale = Scale::new(\n"
        f'    "{name}",\n'
        '    "0 to 127",\n'
        "    (0, 127),\n"
        "    (1, 0, 1),\n"
        ");"
    )


def test_a_calibration_of_two_pieces_has_a_line_for_each(tmp_path):
    points = "points: [[0, 0], [10, 10]], outside: extrapolate"
    text = curve_of(member_of(tmp_path, f"bits: 8, type: uint, {points}"))
    assert text.splitlines()[2:] == [
        "    (0.0, &[0.0, 1.0]),",
        "    (10.0, &[10.0, 1.0]),",
        "]);",
    ]


def test_a_struct_as_data_has_its_fields(tmp_path):
    structs = (
        "structs:\n  - {name: Point, length: 1, fields: ["
        "{at: 0, bits: 8, name: X, type: uint}]}\n"
    )
    field = "at: 0, name: Points, struct: Point, count: 2"
    result = loaded(tmp_path, structs + status(field, length=2))
    ((member,),) = (each.members for each in describe(result.icd).nodes[0].messages)
    row = '("Points", 0, 8).array(2).fields(super::Point::FIELDS)'
    assert field_row(member) == row
