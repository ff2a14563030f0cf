"""Messages behave as dataclasses with slots."""

from __future__ import annotations

import copy
import dataclasses
import pickle

import pytest

from tests.python.reference import cases


@pytest.fixture(scope="module")
def acp(shipped):
    return shipped.module("cubeacp")


def test_messages_are_dataclasses_with_slots(package):
    for case in cases(package):
        assert [field.name for field in dataclasses.fields(case.cls)] == [
            info.attribute for info in case.cls.FIELDS
        ]
        assert not hasattr(case.cls(), "__dict__")


def test_copies_are_equal(package):
    for case in cases(package):
        message = case.cls.from_bytes(b"\x01" * case.message.length)
        for other in (
            copy.copy(message),
            copy.deepcopy(message),
            pickle.loads(pickle.dumps(message)),
            dataclasses.replace(message),
        ):
            assert other == message
            assert other.to_bytes() == message.to_bytes()


def test_messages_are_equal_when_all_values_are(acp):
    angles = acp.EstimatedAttitudeAngles(estimated_roll_angle=1)
    assert angles == acp.EstimatedAttitudeAngles(estimated_roll_angle=1)
    assert angles != acp.EstimatedAttitudeAngles(estimated_roll_angle=2)
    assert angles != acp.EstimatedAngularRates.from_bytes(angles.to_bytes())
    assert repr(angles).startswith("EstimatedAttitudeAngles(estimated_roll_angle=1, ")
    with pytest.raises(TypeError):
        hash(angles)


def test_a_misspelt_field_is_refused(acp):
    with pytest.raises(TypeError):
        acp.EstimatedAttitudeAngles(roll=1)
    with pytest.raises(AttributeError):
        acp.EstimatedAttitudeAngles().roll = 1


def test_fields_are_given_by_name_only(acp):
    with pytest.raises(TypeError):
        acp.EstimatedAttitudeAngles(1, 2, 3)


def test_dictionaries_have_raw_or_physical_values(acp):
    angles = acp.EstimatedAttitudeAngles(estimated_roll_angle=-1234)
    assert angles.as_dict() == {
        "estimated_roll_angle": -1234,
        "estimated_pitch_angle": 0,
        "estimated_yaw_angle": 0,
    }
    assert angles.as_dict(physical=True) == {
        "estimated_roll_angle_deg": -12.34,
        "estimated_pitch_angle_deg": 0.0,
        "estimated_yaw_angle_deg": 0.0,
    }


def test_subclasses_decode_to_themselves(acp):
    class Mine(acp.EstimatedAttitudeAngles):
        __slots__ = ()

    assert type(Mine.from_bytes(bytes(6))) is Mine


def test_dispatch_finds_the_message_of_an_id(shipped):
    for node in shipped.icd.nodes:
        module = shipped.module(node.name)
        for message in shipped.icd.messages_of(node):
            if message.telecommand_id is not None:
                decoded = module.decode_telecommand(
                    message.telecommand_id, bytes(message.length)
                )
                assert (message.name, message.node) == (decoded.NAME, decoded.NODE)
            if message.telemetry_id is not None:
                decoded = module.decode_telemetry(
                    message.telemetry_id, bytes(message.length)
                )
                assert (message.name, message.node) == (decoded.NAME, decoded.NODE)


@pytest.mark.parametrize("id", [-1, 256, 10**30, "146", None, [], 1.5])
def test_dispatch_refuses_unknown_ids(shipped, acp, id):
    with pytest.raises(shipped.module().UnknownIdError) as caught:
        acp.decode_telemetry(id, bytes(6))
    assert (caught.value.node, caught.value.kind, caught.value.id) == (
        "cubeacp",
        "telemetry",
        id,
    )


def test_all_errors_derive_from_icd_error_and_can_be_pickled(shipped):
    package = shipped.module()
    for error in (
        package.LengthError("A", 6, 5),
        package.RangeError("a", "0 to 3", 5),
        package.UnknownIdError("n", "telemetry", 1),
    ):
        assert isinstance(error, package.IcdError)
        copied_error = pickle.loads(pickle.dumps(error))
        assert str(copied_error) == str(error)
        assert vars(copied_error) == vars(error)
