"""Physical values are correctly rounded, and are set to the nearest raw value.

The reference codec computes the expected values with exact fractions.
"""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from icdgen import codec
from icdgen.icd.places import raw_fields_in
from tests.python.reference import cases


def distinct_fields(package, widest: int):
    """Return one field of each scale, type and width up to ``widest`` bits."""
    fields = {}
    for case in cases(package):
        for field in raw_fields_in(case.message.layout):
            if field.scale and field.bits <= widest:
                fields.setdefault((field.scale, field.type, field.bits), (case, field))
    return fields.values()


@pytest.mark.parametrize("name", ["odd", "ordered"])
def test_any_double_is_set_to_the_raw_value_of_the_reference_codec(name, request):
    package = request.getfixturevalue(name)
    range_error = package.module().RangeError
    for case, field in distinct_fields(package, 64):
        info = case.infos[field.name]
        message = case.cls()
        for value in doubles(field):
            try:
                expected = codec.raw_from_physical(field, value)
            except codec.CodecError:
                with pytest.raises(range_error) as caught:
                    setattr(message, info.physical, value)
                assert caught.value.field == info.physical
            else:
                setattr(message, info.physical, value)
                assert getattr(message, info.attribute) == expected, (
                    case.message.name,
                    field.name,
                    value,
                )


def doubles(field):
    """Doubles on, between and beyond the physical values of the field."""
    step = abs(field.scale.factor)
    for raw in (
        field.raw_min,
        field.raw_max,
        0,
        1,
        7,
        (field.raw_min + field.raw_max) // 3,
    ):
        exact = field.scale.physical(raw)
        for part in (
            0,
            Fraction(1, 2),
            Fraction(-1, 2),
            Fraction(49, 100),
            Fraction(3, 2),
            -1,
        ):
            near = float(exact + part * step)
            yield from (
                near,
                math.nextafter(near, math.inf),
                math.nextafter(near, -math.inf),
            )
    yield from (0.0, -0.0, 5e-324, 1e308, -1e308, math.nan, math.inf, -math.inf)


def test_ties_go_to_the_even_raw_value_of_the_exact_quotient(shipped):
    angles = shipped.module("cubeacp").EstimatedAttitudeAngles()
    for value, raw in (
        (0.005, 1),
        (0.015, 1),
        (0.125, 12),
        (0.375, 38),
        (-0.125, -12),
        (327.67, 32767),
        (Fraction(1, 200), 0),
    ):
        angles.estimated_roll_angle_deg = value
        assert angles.estimated_roll_angle == raw


def test_a_physical_value_that_is_not_a_number_is_refused(shipped):
    angles = shipped.module("cubeacp").EstimatedAttitudeAngles()
    for value in ("1", None, b"", 1j, [], 10**400):
        with pytest.raises(shipped.module().RangeError):
            angles.estimated_roll_angle_deg = value


def test_the_error_about_a_physical_value_in_a_raw_attribute_names_the_physical_one(
    shipped,
):
    angles = shipped.module("cubeacp").EstimatedAttitudeAngles(
        estimated_roll_angle=12.5
    )
    message_text = r"^estimated_roll_angle takes integers .* \(estimated_roll_angle_deg takes physical values\), not 12\.5$"
    with pytest.raises(shipped.module().RangeError, match=message_text):
        angles.to_bytes()


def physical_name(info) -> str:
    return info.physical or info.attribute


def test_messages_are_created_from_physical_values(package):
    for case in cases(package):
        if not any(field.scale for field in case.message.fields):
            continue
        message = case.cls.from_bytes(bytes(case.message.length))
        values = message.as_dict(physical=True)
        rebuilt = case.cls.from_physical(
            **{name: values[name] for name in map(physical_name, case.cls.FIELDS)}
        )
        assert rebuilt == message
        assert case.cls.from_physical() == case.cls()


def test_integers_of_a_smaller_unit_are_exact_and_survive_a_round_trip(package):
    seen = 0
    for case, field in distinct_fields(package, 64):
        info = case.infos[field.name]
        if not info.whole:
            continue
        message = case.cls()
        for raw in {
            field.raw_min,
            field.raw_max,
            field.raw_min // 2,
            (field.raw_min + field.raw_max) // 3,
        }:
            setattr(message, info.attribute, raw)
            parts, exact = getattr(message, info.whole), field.scale.physical(raw)
            assert isinstance(parts, int) and parts in (exact * 1000, exact * 1_000_000)
            setattr(message, info.attribute, 0)
            setattr(message, info.whole, parts)
            assert getattr(message, info.attribute) == raw
            seen += 1
    assert seen > 10 or package.name == "ordered_messages"


def test_integers_of_a_smaller_unit_are_set_to_the_nearest_raw_value(shipped):
    angles = shipped.module("cubeacp").EstimatedAttitudeAngles()
    for value, raw in ((15, 2), (25, 2), (-327685, -32768), (327674, 32767)):
        angles.estimated_roll_angle_mdeg = value
        assert angles.estimated_roll_angle == raw
    for value in (-327686, 327675, "1", None):
        with pytest.raises(
            shipped.module().RangeError,
            match=r"_mdeg takes -327680 to 327670 \(-327\.68 to 327\.67 deg\), not",
        ):
            angles.estimated_roll_angle_mdeg = value
