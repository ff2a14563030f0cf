"""Messages are dataclasses for the standard library, pydantic, msgspec and JSON."""

from __future__ import annotations

import dataclasses
import inspect
import json

import msgspec
import pydantic
import pytest

from tests.python.reference import cases, frames


@pytest.fixture(scope="module")
def acp(shipped):
    return shipped.module("cubeacp")


def raw(message) -> dict:
    """Return the values of all fields, without overlay fields."""
    return {info.attribute: getattr(message, info.attribute) for info in message.FIELDS}


def test_dataclass_fields_have_the_defaults_of_a_new_message(package):
    for case in cases(package):
        message = case.cls()
        for field in dataclasses.fields(case.cls):
            assert field.default == getattr(message, field.name)
            assert field.kw_only and field.init


def test_patterns_match_by_position_and_by_name(acp):
    assert acp.EstimatedAttitudeAngles.__match_args__ == (
        "estimated_roll_angle", "estimated_pitch_angle", "estimated_yaw_angle",
    )  # fmt: skip
    match acp.EstimatedAttitudeAngles(estimated_pitch_angle=2):
        case acp.EstimatedAttitudeAngles(0, pitch, estimated_yaw_angle=0):
            assert pitch == 2
        case _:
            pytest.fail("nothing matched")


def test_the_signature_lists_raw_and_physical_names(acp):
    parameters = inspect.signature(acp.EstimatedAttitudeAngles).parameters
    assert [*parameters][:2] == ["estimated_roll_angle", "estimated_roll_angle_deg"]
    assert {parameter.kind for parameter in parameters.values()} == {
        inspect.Parameter.KEYWORD_ONLY
    }
    assert (
        parameters["estimated_roll_angle_deg"].default,
        parameters["estimated_roll_angle"].default,
    ) == (0.0, 0)


def test_a_subclass_has_the_signature_of_its_own_init(acp):
    class Mine(acp.EstimatedAttitudeAngles):
        __slots__ = ()

        def __init__(self, roll: float) -> None:
            super().__init__(estimated_roll_angle_deg=roll)

    assert [*inspect.signature(Mine).parameters] == ["roll"]
    assert Mine(1.5).estimated_roll_angle == 150


def test_a_message_is_created_from_raw_or_physical_values(acp):
    assert (
        acp.EstimatedAttitudeAngles(estimated_roll_angle_deg=1.5).estimated_roll_angle
        == 150
    )
    assert (
        acp.EstimatedAttitudeAngles.from_physical(
            estimated_roll_angle_deg=1.5
        ).estimated_roll_angle
        == 150
    )
    with pytest.raises(
        TypeError, match="takes estimated_roll_angle_deg, not estimated_roll_angle"
    ):
        acp.EstimatedAttitudeAngles.from_physical(estimated_roll_angle=1)


def test_values_are_replaced_raw_or_physical(acp):
    angles = acp.EstimatedAttitudeAngles(estimated_roll_angle=7, estimated_yaw_angle=1)
    assert dataclasses.replace(angles, estimated_roll_angle_deg=0.5).as_dict() == {
        "estimated_roll_angle": 50, "estimated_pitch_angle": 0, "estimated_yaw_angle": 1,
    }  # fmt: skip
    assert angles.estimated_roll_angle == 7


def test_messages_survive_a_round_trip_through_dictionaries_and_json(package):
    for case in cases(package):
        for frame in frames(case.message.length, 2):
            message = case.cls.from_bytes(frame)
            assert dataclasses.asdict(message) == raw(message)
            assert (
                case.cls.from_dict(message.as_dict()).to_bytes() == message.to_bytes()
            )
            if all(info.type != "float" for info in case.cls.FIELDS):  # NaN
                assert case.cls.from_json(message.to_json()) == message
        assert case.cls.from_dict({}) == case.cls.from_physical() == case.cls()
        if all(info.leads_back for info in case.cls.FIELDS):
            assert case.cls.from_dict(case.cls().as_dict(physical=True)) == case.cls()


def test_json_has_digits_for_bytes_and_numbers_for_enumerations(acp):
    state = acp.CurrentAdcsState(control_mode=acp.ConModeSelect(3))
    assert json.loads(state.to_json())["control_mode"] == 3
    assert acp.CurrentAdcsState.from_json(
        '{"control_mode": 3}'
    ).control_mode is acp.ConModeSelect(3)
    packet = acp.FileUploadPacket(file_bytes=bytes(range(20)))
    assert json.loads(packet.to_json())["file_bytes"] == bytes(range(20)).hex()
    assert acp.FileUploadPacket.from_json(packet.to_json()) == packet


@pytest.mark.parametrize(
    ("data", "message_text"),
    [
        ("[1]", "no object"),
        ("{", "no JSON"),
        ("[" * 100_000, "no JSON"),
        ('{"roll": 1}', "has no field 'roll'"),
        ('{"estimated_roll_angle": 40000}', "takes integers from -32768 to 32767"),
        ('{"estimated_roll_angle": "1"}', "takes integers from"),
        ('{"estimated_roll_angle_deg": 1e9}', "takes -327.68 to 327.67"),
        ('{"estimated_roll_angle_deg": null}', "takes -327.68 to 327.67"),
    ],
)
def test_invalid_json_is_refused(shipped, acp, data, message_text):
    with pytest.raises(shipped.module().IcdError, match=message_text):
        acp.EstimatedAttitudeAngles.from_json(data)


def test_pydantic_reads_and_checks_messages(package):
    for case in cases(package):
        message = case.cls.from_bytes(bytes(case.message.length))
        adapter = pydantic.TypeAdapter(case.cls)
        assert adapter.validate_python(raw(message)) == message
        assert adapter.dump_python(message) == raw(message)


def test_pydantic_refuses_other_types(acp):
    adapter = pydantic.TypeAdapter(acp.EstimatedAttitudeAngles)
    assert (
        adapter.validate_json('{"estimated_roll_angle": 5}').estimated_roll_angle == 5
    )
    with pytest.raises(pydantic.ValidationError):
        adapter.validate_json('{"estimated_roll_angle": "a"}')


@pytest.mark.parametrize(
    "name", ["shipped", "ordered"]
)  # msgspec has no enumerations of values above 2**63
def test_msgspec_reads_and_writes_messages(name, request):
    for case in cases(request.getfixturevalue(name)):
        message = case.cls.from_bytes(bytes(case.message.length))
        assert (
            msgspec.json.decode(msgspec.json.encode(message), type=case.cls) == message
        )
