"""Messages of variable length work with texts, JSON, errors and columns.

`tests/conformance` compares their frames with the reference codec, and
`tests/every_language/variable_length.py` tests what all languages have in common.
"""

from __future__ import annotations

import pytest

from tests.conformance import odd
from tests.python import packages


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("open")
    return packages.write(
        packages.read(odd.FOLDER / "open.yaml"), folder, "open_messages"
    )


@pytest.fixture(scope="module")
def messages(package):
    return package.module("open")


def test_a_count_field_must_match_the_number_of_elements(package, messages):
    errors = package.module("_errors")
    gauges = messages.Gauges(gauges=(300, 1))
    with pytest.raises(
        errors.RangeError, match="gauges_count takes 2, as many as gauges has, not 0"
    ):
        gauges.to_bytes()
    gauges.gauges_count = 2
    assert gauges.to_bytes() == bytes([2, 0, 1, 44, 0, 1])
    with pytest.raises(errors.LengthError, match="has 8 bytes, 4 given"):
        messages.Gauges.from_bytes(bytes([3, 0, 0, 1]))


def test_a_count_may_include_the_bytes_before_the_data(package, messages):
    errors, sized = package.module("_errors"), messages.SizedWithItsHead
    assert sized().octets_count == 4 and sized().to_bytes() == bytes([0, 0, 4, 0])
    message = sized(number=-1, data=b"abc", octets_count=7)
    assert (
        message.to_bytes() == b"\xff\xff\7\0abc"
        and sized.from_bytes(message.to_bytes()) == message
    )
    with pytest.raises(
        errors.RangeError,
        match="octets_count takes 7, as many as data has, of which there are 3, not 3",
    ):
        sized(data=b"abc", octets_count=3).to_bytes()
    for counted, expected in ((3, 3), (0, 0), (6, 6)):
        with pytest.raises(errors.LengthError, match=f"has {expected} bytes, 4 given"):
            sized.from_bytes(bytes([0, 0, counted, 0]))


def test_texts_may_form_an_array(package, messages):
    rows = messages.Rows()
    rows.words_text = ("a", "", "four", "12345678")
    assert rows.words == (
        b"a".ljust(8, b"\0"),
        bytes(8),
        b"four".ljust(8, b"\0"),
        b"12345678",
    )
    rows.pairs = (b"ab", b"cd", b"ef")
    decoded = messages.Rows.from_bytes(rows.to_bytes())
    assert decoded == rows and decoded.words_text == ("a", "", "four", "12345678")
    assert messages.Rows.from_json(rows.to_json()) == rows
    error = package.module("_errors").RangeError
    with pytest.raises(error, match=r"words_text\[1\] takes up to 8 ASCII"):
        rows.words_text = ("", "123456789", "", "")
    with pytest.raises(error, match="words_text takes 4 values"):
        rows.words_text = ("", "")
    with pytest.raises(error, match=r"pairs\[2\] takes 2 bytes"):
        messages.Rows(pairs=(b"ab", b"cd", b"e")).to_bytes()
    opened = messages.WideRows.from_bytes(
        b"\1" + b"one".ljust(40, b"\0") + b"two".ljust(40, b"\0")
    )
    assert opened.extensions_text == ("one", "two") and len(opened.extensions) == 2
    with pytest.raises(error, match=r"extensions\[0\] takes 40 bytes"):
        messages.WideRows(extensions=(b"one",)).to_bytes()


def test_columns_store_arrays_of_texts(messages):
    rows, none = messages.Rows(pairs=(b"ab", b"cd", b"ef")), messages.Rows()
    rows.words_text = ("a", "", "four", "12345678")
    frames = rows.to_bytes() + none.to_bytes()
    columns = messages.Rows.decode_many(frames, physical=True)
    assert columns["words_text"].tolist() == [["a", "", "four", "12345678"], [""] * 4]
    assert columns["pairs"][0].tolist() == [[97, 98], [99, 100], [101, 102]]
    table = messages.Rows.decode_table(frames)
    assert table["words_text"].to_pylist() == [["a", "", "four", "12345678"], [""] * 4]
    assert table["pairs"].to_pylist() == [[b"ab", b"cd", b"ef"], [b"\0\0"] * 3]
    assert (
        messages.Rows.decode_table(frames, physical=False)["words"].to_pylist()[0][2]
        == b"four\0\0\0\0"
    )
    opened = [b"\1" + b"one".ljust(40, b"\0"), b"\2"]
    assert messages.WideRows.decode_table(opened)["extensions_text"].to_pylist() == [
        ["one"],
        [],
    ]
    raw = messages.WideRows.decode_table(opened, physical=False)[
        "extensions"
    ].to_pylist()
    assert raw == [[b"one".ljust(40, b"\0")], []]


def test_elements_beyond_the_maximum_are_refused(package, messages):
    error = package.module("_errors").RangeError
    with pytest.raises(error, match="samples takes up to 5 values"):
        messages.Narrow(samples=(0,) * 6).to_bytes()
    with pytest.raises(error, match=r"samples\[1\] takes integers"):
        messages.Narrow(samples=(0, 1 << 23)).to_bytes()
    with pytest.raises(error):
        messages.Payload(data=bytes(256)).to_bytes()


def test_trailing_zeros_of_a_frame_may_be_omitted(package, messages):
    complete = messages.CutOff.from_bytes(b"\xff\xe5\x3f\x80" + bytes(19))
    cut = messages.CutOff.from_bytes(b"\xff\xe5\x3f\x80")
    assert cut == complete and (cut.input, cut.value, cut.words_text) == (-2, 1.0, "")
    assert (
        len(cut.to_bytes()) == 23 and messages.Two.from_bytes(b"\0") == messages.Two()
    )
    for size, expected in ((0, 1), (24, 23)):
        with pytest.raises(
            package.module("_errors").LengthError,
            match=f"has {expected} byte.*, {size} given",
        ):
            messages.CutOff.from_bytes(bytes(size))
    frames = [b"\0\5\x3f\x80", bytes(23)]
    assert messages.CutOff.decode_many(frames)["value"].tolist() == [1.0, 0.0]
    assert messages.CutOff.decode_many(bytes(46))["value"].tolist() == [0.0, 0.0]


def test_columns_store_the_elements_of_each_frame(package, messages):
    frames = [
        messages.Narrow(samples=values).to_bytes() for values in ((), (1, -1), (7,))
    ]
    column = messages.Narrow.decode_many(frames)["samples"]
    assert [row.tolist() for row in column] == [[], [1, -1], [7]]
    assert messages.Narrow.decode_table(frames, physical=False)[
        "samples"
    ].to_pylist() == [[], [1, -1], [7]]
    texts = messages.Text.decode_table([b"\0\1hi", b"\0\2"])
    assert texts["match_text"].to_pylist() == ["hi", ""]
    assert messages.Payload.decode_table([b"ab", b""])["data"].to_pylist() == [
        b"ab",
        b"",
    ]
    assert messages.Narrow.decode_table([], physical=False)["samples"].to_pylist() == []
    with pytest.raises(package.module("_errors").IcdError, match="give them as a list"):
        messages.Narrow.decode_many(b"\0")


def test_columns_of_fields_behind_a_variable_length_part_are_numbers(tmp_path):
    icd = packages.read(odd.FOLDER / "behind.yaml")
    packet = packages.write(icd, tmp_path, "behind_messages").module("behind").Packet
    frames = [b"\0\1" + bytes(size) + b"\5\0" for size in (3, 0, 2)]
    columns = packet.decode_many(frames)
    assert columns["crc"].tolist() == [5, 5, 5]
    assert list(columns["payload"]) == [bytes(3), b"", bytes(2)]


def test_a_variable_length_array_of_structs_extends_to_the_end_of_the_frame(
    package, messages
):
    inner = messages.Inner(type=-2, gauge=300, text_text="x")
    message = messages.TurnedStructs(inners=(inner, messages.Inner()))
    frame = message.to_bytes()
    assert len(frame) == 10 and messages.TurnedStructs.from_bytes(frame) == message
    assert (
        messages.TurnedStructs.from_bytes(b"").inners
        == ()
        == messages.TurnedStructs().inners
    )
    assert messages.TurnedStructs.from_json(message.to_json(physical=True)) == message
    errors = package.module("_errors")
    inner.type = 1 << 11
    with pytest.raises(errors.RangeError, match=r"inners\[0\].type takes integers"):
        message.to_bytes()
    with pytest.raises(errors.RangeError, match="inners takes up to 3 values"):
        messages.TurnedStructs(inners=(messages.Inner(),) * 4).to_bytes()
    with pytest.raises(errors.LengthError):
        messages.TurnedStructs.from_bytes(bytes(7))


def test_columns_of_a_variable_length_array_of_structs_are_lists(messages):
    frames = [
        messages.TurnedStructs(
            inners=tuple(messages.Inner(type=n) for n in range(count))
        ).to_bytes()
        for count in (2, 0, 3)
    ]
    columns = messages.TurnedStructs.decode_many(frames, physical=True)
    assert [row.tolist() for row in columns["inners.type_v"]] == [
        [-3.0, -2.75],
        [],
        [-3.0, -2.75, -2.5],
    ]
    assert [row.tolist() for row in columns["inners.flags[1]"]] == [
        [False] * 2,
        [],
        [False] * 3,
    ]
    table = messages.TurnedStructs.decode_table(frames, physical=False)
    assert table["inners.type"].to_pylist() == [[0, 1], [], [0, 1, 2]]
    assert table["inners.text"].to_pylist() == [[b"\0"] * 2, [], [b"\0"] * 3]
    assert messages.TurnedStructs.decode_table(frames, physical=True)[
        "inners.text_text"
    ].to_pylist() == [
        ["", ""],
        [],
        ["", "", ""],
    ]
