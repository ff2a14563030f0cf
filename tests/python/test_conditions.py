"""Fields that are not always there: None where they are not."""

from __future__ import annotations

import pytest

from tests.conformance import odd
from tests.python import packages


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mux")
    return packages.write(
        packages.read(odd.FOLDER / "mux.yaml"), folder, "mux_messages"
    )


@pytest.fixture(scope="module")
def messages(package):
    return package.module("mux")


def test_what_is_not_there_is_none_and_what_is_has_its_value(messages):
    message = messages.Multiplexed.from_bytes(
        bytes([1, 0x04, 0xE2, 0, 0, 0x80, 0, 0, 0])
    )
    assert (message.angle, message.angle_deg, message.flag, message.is_fast) == (
        1250,
        12.5,
        True,
        False,
    )
    assert (
        message.rate,
        message.rate_deg_per_s,
        message.speed,
        message.turned,
        message.slow,
    ) == (None,) * 5
    assert message.to_bytes() == bytes([1, 0x04, 0xE2, 0, 0, 0x80, 0, 0, 0])


def test_a_new_message_has_what_is_there_while_all_others_are_zero(messages):
    message = messages.Multiplexed()
    assert (
        message.rate,
        message.rest,
        message.slow,
        message.angle,
        message.on_count,
    ) == (0, 5, 0, None, None)
    assert message == messages.Multiplexed.from_bytes(message.to_bytes())


def test_a_message_of_another_alternative_is_equal_to_what_its_frame_is_decoded_to(
    messages,
):
    message = messages.Multiplexed(mode=2, angle_deg=1.25, turned=3, flag=True)
    assert message.rate is None
    assert messages.Multiplexed.from_bytes(message.to_bytes()) == message
    assert messages.Multiplexed.from_json(message.to_json()) == message
    choice = messages.Choice(type=2, longer_physical=1.5)
    assert (
        choice.longer == 15
        and messages.Choice.from_json(choice.to_json(physical=True)) == choice
    )


def test_what_must_be_there_is_demanded_and_what_is_not_there_is_not_looked_at(
    package, messages
):
    message = messages.Multiplexed()
    message.mode = 1
    with pytest.raises(
        package.module("_errors").RangeError,
        match="angle takes integers from 0 to 65535, not None",
    ):
        message.to_bytes()
    message.angle, message.rate = 7, 1 << 20
    assert message.to_bytes()[1:3] == bytes([0, 7])


def test_columns_are_masked_where_a_field_is_not_there(messages):
    frames = b"".join(messages.Multiplexed(mode=mode).to_bytes() for mode in (0, 1, 7))
    columns = messages.Multiplexed.decode_many(frames, physical=True)
    assert columns["rate_deg_per_s"].tolist() == [0.0, None, None]
    assert columns["mode"].tolist() == [0, 1, 7]
    table = messages.Multiplexed.decode_table(frames)
    assert table["angle_deg"].to_pylist() == [None, 0.0, None]
    assert table["speed"].to_pylist() == [None, None, 0.0]
