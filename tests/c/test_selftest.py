"""The C self-test expects the result of the reference codec for every frame."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from icdgen import backends
from icdgen.render import Renderer
from tests.icd.files import loaded

MESSAGES = """\
messages:
  - name: Start
    id: 5
    kind: telecommand
    shares_id: true
    length: 1
    fields: [{{at: 0, bits: 8, name: Action, type: uint, const: 1}}]
  - name: Stop
    id: 5
    kind: telecommand
    shares_id: true
    length: {length}
    fields: [{{at: 0, bits: 8, name: Action, type: uint, const: 2}}]
"""
START, STOP = ("ICD_OK", '"Start"'), ("ICD_OK", '"Stop"')
UNKNOWN, LENGTH = ("ICD_ERROR_UNKNOWN_ID", "NULL"), ("ICD_ERROR_LENGTH", "NULL")


def rows_of_frames(folder: Path, icd: str) -> dict[bytes, tuple[str, str]]:
    """Return the frames of the shared id 5 with the expected status and message."""
    backend = backends.get("c-selftest")
    files = backend.files(loaded(folder, icd).icd, Renderer.of_backend(backend))
    (text,) = (text for path, text in files if path.parent.name == "nodes")
    rows = re.findall(
        r"^ *\{5u, (\d+)u, (?:NULL|\(const uint8_t\[\]\)\{(.*)\}), (\w+), (.*)\},$",
        text,
        re.MULTILINE,
    )
    frames = {
        bytes(int(byte, 16) for byte in data.split(", ") if byte): (status, name)
        for _, data, status, name in rows
    }
    assert [int(length) for length, *_ in rows] == [len(frame) for frame in frames]
    return frames


@pytest.mark.parametrize(
    ("length", "frames"),
    [
        (1, {"": LENGTH, "00": UNKNOWN, "0000": LENGTH, "01": START, "02": STOP}),
        # Messages of different lengths have no length that a frame could miss.
        (2, {"": UNKNOWN, "00": UNKNOWN, "000000": UNKNOWN, "01": START, "0200": STOP}),
    ],
    ids=["of one length", "of two lengths"],
)
def test_frames_of_a_shared_id_have_their_message_or_the_error_of_the_decoder(
    tmp_path, length, frames
):
    rows = rows_of_frames(tmp_path, MESSAGES.format(length=length))
    expected = {bytes.fromhex(frame): result for frame, result in frames.items()}
    # All other frames are of a possible length and have another constant.
    assert rows == dict.fromkeys(rows, UNKNOWN) | expected
    assert len(rows) > 2 * len(frames)
