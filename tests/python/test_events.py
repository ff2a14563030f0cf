"""Events of a client give their data as a message of its class."""

from __future__ import annotations

import pytest
from icdgen_runtime._base import Message
from icdgen_runtime.wire.events import Arrived, Done, Refused


class Reading(Message):
    """Message that only stores its frame."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    @classmethod
    def from_bytes(cls, data):
        return cls(data)


class Other(Reading):
    """Another message."""


@pytest.mark.parametrize("data", [b"", b"\0", b"\1\2"])
@pytest.mark.parametrize(
    "event",
    [
        lambda data, type: Done(130, 1, data, type),
        lambda data, type: Refused(130, 1, data=data, type=type),
        lambda data, type: Arrived(130, data, {}, type),
    ],
    ids=["done", "refused", "arrived"],
)
def test_the_message_has_the_class_and_all_data_of_the_event_also_if_it_has_no_data(
    event, data
):
    received = event(data, Reading)
    assert type(received.message) is Reading and received.message.data == data
    assert event(data, None).message is None
    if not isinstance(received, Refused):
        assert received.of(Reading).data == data
        assert received.of(Other) is None
        assert event(data, None).of(Reading) is None
