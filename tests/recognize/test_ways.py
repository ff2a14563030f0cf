"""All forms in which a frame can be pasted give the same result."""

from __future__ import annotations

import json

import pytest

from icdgen.recognize import read_pasted, recognize
from icdgen.values.errors import Ambiguous, BadHex, BadLength, NotFound
from tests.recognize.ways import BARE, DATA, WHOLE


@pytest.mark.parametrize("way", BARE)
def test_data_in_any_spelling_are_the_same_frame(shipped, way):
    (decoded,) = recognize(shipped, BARE[way], "cubeacp", "146")
    assert (decoded.data, decoded.message.name) == (
        DATA,
        "Estimated Attitude Angles",
    ) and decoded.frame.rows[0].text == "-12.34"


@pytest.mark.parametrize("way", WHOLE)
def test_a_frame_with_an_id_needs_no_name(shipped, way):
    interpretations = [
        recognize(shipped, WHOLE[way], *names)
        for names in [(), ("cubeacp",), ("cubeacp", "146")]
    ]
    assert {
        (decoded.endpoint.node.name, decoded.message.id, decoded.what, decoded.data)
        for (decoded,) in interpretations
    } == {("cubeacp", 146, "telemetry", DATA)}


def test_several_frames_of_a_stream_are_separated(shipped):
    text = "1F 7F 92 1F FF 1F 7F 92 2E FB 0A 00 00 00 1F FF 1F 7F 11 05 1F FF"
    request, reply, acknowledge = recognize(shipped, text)
    assert [frame.what for frame in (request, reply, acknowledge)] == [
        "request",
        "telemetry",
        "acknowledge",
    ]
    assert "error 5" in acknowledge.title and acknowledge.to_json()["error"] == 5
    assert [frame.what for frame in recognize(shipped, bytes.fromhex(text))] == [
        "request",
        "telemetry",
        "acknowledge",
    ]


def test_a_line_may_be_a_frame(shipped):
    text = "92 2E FB 0A 00 00 00\n92 00 00 00 00 00 00\n"
    assert [frame.data for frame in recognize(shipped, text, "cubeacp")] == [
        DATA,
        bytes(6),
    ]


def test_the_packets_of_a_long_message_are_joined_and_a_missing_one_is_named(shipped):
    message = shipped.messages_of(shipped.node("cubeacp"))
    long = next(m for m in message if m.telemetry_id and m.length > 21)
    data = bytes(range(long.length))
    pieces = [data[at : at + 7].ljust(7, b"\0") for at in range(0, len(data), 7)]
    lines = [
        f"can0 08{long.telemetry_id:02X}0201#{piece.hex()}{len(pieces) - 1 - number:02x}"
        for number, piece in enumerate(pieces)
    ]
    (decoded,) = recognize(shipped, "\n".join(lines))
    assert (decoded.message, decoded.data) == (long, data)
    with pytest.raises(BadLength, match=f"1 of {len(pieces)} packets .* are missing"):
        recognize(shipped, "\n".join(lines[1:]), "cubeacp")


@pytest.mark.parametrize(
    ("text", "names", "error", "says"),
    [
        ("2E FB 0A 00 00 00", ("cubeacp",), Ambiguous, "without an id can be `"),
        ("1F 7F 92 2E FB", (), BadLength, "end of the message is missing"),
        ("1F 7F 92 2E 1F 02 1F FF", (), BadLength, "followed by neither"),
        (
            "1F 7F 92 2E FB 1F FF",
            (),
            BadLength,
            "has 6 bytes, 2 given after the id 146",
        ),
        (
            "1F 7F 8D 2E FB 0A 00 00 00 1F FF",
            ("cubeacp", "146"),
            NotFound,
            "is not `Estimated Attitude Angles` but",
        ),
        (
            "1F 7F 92 2E FB 0A 00 00 00 07 1F FF",
            ("cubeacp",),
            BadLength,
            "as CRC after them",
        ),
        ("2E FB 0A 00 00 00 07", ("cubeacp", "146"), BadLength, "as CRC after them"),
        ("can0 123 [1] 00", (), NotFound, "11-bit"),
        ("can0 1F920201 [1] 00", (), NotFound, "unknown type"),
        ("2exb01", (), BadHex, "`x`"),
    ],
)
def test_invalid_and_ambiguous_input_is_reported(shipped, text, names, error, says):
    with pytest.raises(error, match=says):
        recognize(shipped, text, *names)


def test_a_checksum_is_checked_and_removed(shipped):
    with pytest.raises(BadLength, match="as CRC") as wrong:
        recognize(shipped, "2E FB 0A 00 00 00 CC", "cubeacp", "146")
    right = str(wrong.value).split("them ")[1][:2]
    data = f"2E FB 0A 00 00 00 {right}"
    for text in (data, f"92 {data}", f"1F 7F 92 {data} 1F FF"):
        (decoded,) = recognize(shipped, text, "cubeacp", "146")
        assert decoded.data == DATA and "CRC is right" in decoded.frame.remarks
    (decoded,) = recognize(shipped, f"92 {data}")
    assert (decoded.message.id, decoded.data) == (146, DATA)


@pytest.mark.parametrize(
    ("text", "data"),
    [
        (
            "[46, 25, 10]",
            "462510",
        ),  # digits in pairs are hexadecimal, even where they could be decimal
        ("deadbeef", "deadbeef"),  # and are no base64
        ("00000000: 00", "00"),
        ("0000 0001 0002", "000000010002"),  # an address must be consecutive
    ],
)
def test_text_that_can_be_hexadecimal_is_read_as_hexadecimal(text, data):
    assert read_pasted(text).data.hex() == data


@pytest.mark.parametrize(
    "text",
    [
        "{300, 0, 1}",
        "0000000: 00 00\n0000008: 00",
        "can0 05920201 [7] 00",
        "=",
        "x",
        "(1)][",
    ],
)
def test_text_that_only_looks_like_bytes_is_refused(text):
    with pytest.raises(BadHex):
        read_pasted(text)


def test_json_names_the_direction(shipped):
    (decoded,) = recognize(shipped, WHOLE["UART"])
    assert json.loads(json.dumps(decoded.to_json()))["direction"] == "telemetry"
