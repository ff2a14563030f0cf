"""Text fields are Python strings, in attributes, dictionaries and columns."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def texts(odd):
    return odd.module("odd").Texts


@pytest.mark.parametrize("text", ["x" * 31, "a\0b", b"bytes", None, 7])
def test_an_invalid_text_is_refused_and_the_value_stays_unchanged(odd, texts, text):
    message = texts(software=b"y" * 30)
    with pytest.raises(odd.module().RangeError) as caught:
        message.software_text = text
    assert caught.value.field == "software_text"
    assert message.software == b"y" * 30


def test_physical_values_of_a_message_include_its_texts(texts):
    message = texts.from_physical(software_text="1.2", raw_physical=6)
    physical = {
        "software_text": "1.2",
        "one_text": "",
        "hard_ware_text": "",
        "raw_physical": 6.0,
    }
    assert message.as_dict(physical=True) == physical


def test_tables_have_texts_as_strings(texts):
    frames = b"".join(
        texts.from_physical(software_text=text).to_bytes()
        for text in ("", "abc", "x" * 30)
    )
    table = texts.decode_table(frames)
    assert table["software_text"].to_pylist() == ["", "abc", "x" * 30]
    assert str(table.schema.field("software_text").type) == "string"
    assert texts.decode_table(frames, physical=False)["software"].to_pylist()[
        1
    ] == b"abc".ljust(30, b"\0")
