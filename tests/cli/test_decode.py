"""`icdgen decode` separates node, message and frame, and prints complete results."""

from __future__ import annotations

import io

import pytest

from icdgen.commands import decode as command
from icdgen.commands.decode import _content, _frames_in, _is_id, _split_arguments
from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.values.errors import NotFound
from tests.conftest import DEMO

FRAME = "e80301"
OTHER = DEMO.replace("name: demo,", "name: other,").replace("title: Demo", "title: Other")  # fmt: skip
CONSTANT = """\
  - name: Marked
    id: 150
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mark, type: uint, const: 7}
      - {at: 8, bits: 8, name: Level, type: uint}
  - {name: Empty, id: 151, kind: telecommand, length: 0}
"""


@pytest.fixture
def alone(demo):
    return load([demo]).icd


@pytest.fixture
def pair(demo):
    (demo.parent / "other.yaml").write_text(OTHER)
    return load([demo.parent]).icd


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("demo 146 e80301", ("demo", "146", "e80301")),
        ("DEMO 146 e8 03 01", ("demo", "146", "e8 03 01")),
        ("demo|Estimated Roll|e80301", ("demo", "Estimated Roll", "e80301")),
        ("146 e80301", ("demo", "146", "e80301")),
        ("Estimated Roll|e80301", ("demo", "Estimated Roll", "e80301")),
        ("demo e80301", ("demo", None, "e80301")),
        ("e80301", (None, None, "e80301")),
        ("e8 03 01", (None, None, "e8 03 01")),
        # Words of one to three digits are the bytes of one dump.
        ("146 232 3 1", (None, None, "146 232 3 1")),
        ("20 22 24", (None, None, "20 22 24")),
        ("demo 99 01", ("demo", None, "99 01")),
    ],
)
def test_the_first_words_are_a_node_and_a_message_if_they_exist(alone, words, expected):
    separate = words.split("|") if "|" in words else words.split()
    assert _split_arguments(alone, separate, None) == expected


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["other", "146", "e80301"], ("other", "146", "e80301")),
        (["other", "e80301"], ("other", None, "e80301")),
        (["14", "e803"], (None, None, "14 e803")),
    ],
)
def test_of_several_nodes_the_node_is_named(pair, words, expected):
    assert _split_arguments(pair, words, None) == expected


@pytest.mark.parametrize(
    ("words", "text", "help"),
    [
        (
            ["demo"],
            "there is no frame for demo",
            "give it after the node, or - for standard input",
        ),
        (
            ["demo", "Estimated Roll"],
            "there is no frame for Estimated Roll of demo",
            "give it after the message, or - for standard input",
        ),
        (
            ["demo", "1234567890", "010203040506"],
            "demo has no message `1234567890`",
            "a frame that begins so is given as one word",
        ),
    ],
)
def test_a_missing_frame_and_an_unknown_id_are_named(alone, words, text, help):
    with pytest.raises(UserError) as error:
        _split_arguments(alone, words, None)
    assert str(error.value).startswith(text)
    assert error.value.help.endswith(help)


def test_an_unknown_name_of_a_message_is_an_error(alone):
    for words in (["demo", "Rol", "e80301"], ["demo", "nonsense"]):
        with pytest.raises(NotFound):
            _split_arguments(alone, words, None)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["146", "e80301"], True),
        (["146", "e80301", "00"], True),
        (["1234567890", "e80301aa"], True),
        (["12345678901", "e80301aa"], False),
        (["14a", "e80301"], False),
        (["146"], False),
        (["146", "255"], False),
        (["146", "1"], False),
        (["146", "12"], False),
        (["1461", "1234"], False),
        (["1461", "12345"], True),
        (["1", "1234"], True),
    ],
)
def test_an_id_is_no_byte_of_a_dump(words, expected):
    assert _is_id(words) is expected


def test_files_and_standard_input_have_frames(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "frame.txt").write_bytes(b"e8 03 01\r\n")
    (tmp_path / "e803").write_bytes(b"01")
    (tmp_path / "raw.bin").write_bytes(b"\xe8\x03\x01")
    assert _content(["frame.txt"]) == _content(["@frame.txt"]) == "e8 03 01\r\n"
    assert _content(["raw.bin"]) == b"\xe8\x03\x01"
    # A file that is called like bytes needs the prefix.
    assert (_content(["e803"]), _content(["@e803"])) == ("e803", "01")
    assert _content(["frame.txt", "01"]) == "frame.txt 01"
    monkeypatch.setattr(command.sys, "stdin", io.TextIOWrapper(io.BytesIO(b"e80301")))
    assert _content(["-"]) == "e80301"
    monkeypatch.setattr(command.sys, "stdin", None)
    with pytest.raises(UserError, match="standard input is closed"):
        _content(["-"])
    with pytest.raises(UserError) as error:
        _content(["@missing"])
    assert error.value.help == "check the path after the @"


def test_printable_ascii_is_a_text_and_anything_else_are_bytes():
    for code in range(256):
        data = bytes((48, code))
        is_text = code in (9, 10, 13) or 32 <= code <= 126
        assert _frames_in(io.BytesIO(data), "x") == (data.decode() if is_text else data)


def test_an_input_has_at_most_a_million_bytes(monkeypatch):
    assert command._MOST == 1_000_000
    monkeypatch.setattr(command, "_MOST", 1000)
    for size in (999, 1000):
        assert len(_frames_in(io.BytesIO(b"\0" * size), "x")) == size
    with pytest.raises(UserError) as error:
        _frames_in(io.BytesIO(b"\0" * 1001), "big.bin")
    assert str(error.value) == "big.bin holds more than 1,000 bytes"
    assert error.value.help == (
        "give fewer frames; `icdgen log` takes recordings of any size"
    )


CSV = """\
frame,node,message,direction,id,field,raw,value,unit,remarks,time
0,demo,Estimated Roll,telemetry,146,Roll Angle,1000,10,deg,,
0,demo,Estimated Roll,telemetry,146,Mode,1,Run,,,
1,demo,Empty,telecommand,151,,,,,id 151 removed,
2,demo,Set Roll,request,20,,,,,,
"""


def test_csv_has_a_row_for_each_field_and_one_for_a_frame_without(icdgen, demo):
    demo.write_text(DEMO + CONSTANT)
    lines = "92 e8 03 01\n97\n"
    (demo.parent / "frames").write_text(lines)
    result = icdgen("decode", "--icd", demo, "--format", "csv", demo.parent / "frames")
    assert (result.status, result.err) == (0, "")
    assert result.out.splitlines() == CSV.splitlines()[:-1]


def test_frames_are_separated_by_a_blank_line(icdgen, demo):
    demo.write_text(DEMO + CONSTANT)
    (demo.parent / "frames").write_text("92 e8 03 01\n92\n")
    result = icdgen("decode", "--icd", demo, demo.parent / "frames")
    assert result.status == 0
    first, second = result.out.split("\n\nrequest for ")
    assert first.startswith("demo: Estimated Roll (telemetry 146), 3 bytes\ne8 03 01\n")
    assert second == (
        "`Estimated Roll` (telemetry 146) of demo\n\nnote: id 146 removed\n"
    )


@pytest.mark.parametrize(("mark", "status"), [("07", 0), ("08", 1)])
@pytest.mark.parametrize("form", ["text", "json", "csv"])
def test_a_wrong_constant_is_an_exit_status_in_each_format(
    icdgen, demo, mark, status, form
):
    demo.write_text(DEMO + CONSTANT)
    result = icdgen("decode", "--icd", demo, "--format", form, "150", f"{mark}01ff"[:4])
    assert result.status == status


def test_a_number_that_is_no_id_is_a_byte_with_a_remark(icdgen, demo):
    result = icdgen("decode", "--icd", demo, "demo", "20", "03", "01")
    note = "demo has no message 20: it is taken for the first byte of the frame"
    assert note not in result.out  # 20 is the id of a message
    result = icdgen("decode", "--icd", demo, "demo", "21", "03", "01")
    assert note.replace("20", "21") in result.out
