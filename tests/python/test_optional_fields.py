"""Messages with optional fields can be compared, and converted to JSON and columns.

`tests/every_language/optional_fields.py` tests what all languages have in common.
"""

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


def test_a_message_equals_the_one_decoded_from_its_frame(
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


@pytest.mark.parametrize("mode", [0, 2, 7])
def test_a_dictionary_without_an_optional_field_gives_its_initial_value(messages, mode):
    message = messages.Multiplexed.from_dict({"mode": mode})
    assert message == messages.Multiplexed(mode=mode)
    absent = {0: "angle speed", 2: "rate speed", 7: "rate angle turned"}[mode]
    assert {getattr(message, name) for name in absent.split()} == {None}


def test_columns_are_masked_where_a_field_is_absent(messages):
    frames = b"".join(messages.Multiplexed(mode=mode).to_bytes() for mode in (0, 1, 7))
    columns = messages.Multiplexed.decode_many(frames, physical=True)
    assert columns["rate_deg_per_s"].tolist() == [0.0, None, None]
    assert columns["mode"].tolist() == [0, 1, 7]
    table = messages.Multiplexed.decode_table(frames)
    assert table["angle_deg"].to_pylist() == [None, 0.0, None]
    assert table["speed"].to_pylist() == [None, None, 0.0]
