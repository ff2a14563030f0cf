"""Messages that share an id: a frame becomes the message that it matches, or an error
says why there is none.
"""

from __future__ import annotations

import pytest
from icdgen_runtime._base import Message
from icdgen_runtime._errors import LengthError, UnknownIdError
from icdgen_runtime._shared import shared

# Candidates: name, lengths, and byte, mask and value of each constant.
SAME_LENGTH = (
    ("Exact", range(4, 5), ((0, 0xFF, 1), (3, 0xFF, 9))),
    ("First", range(4, 5), ((0, 0xFF, 1),)),
    ("Second", range(4, 5), ((0, 0x0F, 2),)),
)
ENDS_EARLY = (
    ("Short", range(1, 5), ((0, 0xFF, 1), (3, 0xF0, 0))),
    ("Long", range(2, 9, 2), ((0, 0xFF, 1),)),
)
OTHER_LENGTHS = (
    ("Two", range(2, 3), ((0, 0xFF, 1),)),
    ("Four", range(4, 5), ((0, 0xFF, 1),)),
)


class Decoded(Message):
    """Message that only stores its frame."""

    @classmethod
    def from_bytes(cls, data):
        return cls.NAME, data


def class_of(candidates):
    return shared(
        "wheel", "telemetry", 7, candidates, lambda name: type(name, (Decoded,), {"NAME": name})
    )  # fmt: skip


@pytest.mark.parametrize(
    ("candidates", "frame", "name"),
    [
        (SAME_LENGTH, "01 00 00 09", "Exact"),
        (SAME_LENGTH, "01 00 00 08", "First"),
        (SAME_LENGTH, "f2 00 00 09", "Second"),
        (ENDS_EARLY, "01", "Short"),
        (ENDS_EARLY, "01 00 00 0f", "Short"),
        (ENDS_EARLY, "01 00 00 10", "Long"),
        (ENDS_EARLY, "01 00 00 00 00 00", "Long"),
        (OTHER_LENGTHS, "01 00", "Two"),
        (OTHER_LENGTHS, "01 00 00 00", "Four"),
    ],
)
def test_length_and_constants_select_the_message_of_a_frame(candidates, frame, name):
    data = bytearray.fromhex(frame)
    assert class_of(candidates).from_bytes(data) == (name, bytes(data))


@pytest.mark.parametrize(
    ("candidates", "frame", "error", "text"),
    [
        # All messages have one length.
        (SAME_LENGTH, "01 00 00", LengthError, "{} has 4 bytes, 3 given"),
        (SAME_LENGTH, "01 00 00 09 00", LengthError, "{} has 4 bytes, 5 given"),
        (SAME_LENGTH, "03 00 00 09", UnknownIdError, "wheel has no telemetry 7: the frame is no {}"),
        # Their lengths differ.
        (ENDS_EARLY, "", UnknownIdError, "wheel has no telemetry 7: the frame is no {}"),
        (ENDS_EARLY, "01 00 00 10 00", UnknownIdError, "wheel has no telemetry 7: the frame is no {}"),
        (OTHER_LENGTHS, "01 00 00", UnknownIdError, "wheel has no telemetry 7: the frame is no {}"),
    ],
)  # fmt: skip
def test_a_frame_that_no_message_matches_is_refused_with_the_reason(
    candidates, frame, error, text
):
    names = " or ".join(name for name, _, _ in candidates)
    with pytest.raises(error) as raised:
        class_of(candidates).from_bytes(bytes.fromhex(frame))
    assert str(raised.value) == text.format(names)


def test_only_one_of_the_messages_can_be_made():
    with pytest.raises(TypeError, match="Two or Four are several messages: make one"):
        class_of(OTHER_LENGTHS)(level=1)
