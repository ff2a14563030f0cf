"""Overlay fields are read-only attributes, and values in dictionaries and columns."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def views(odd):
    return odd.module("odd").Views


def test_an_overlay_field_cannot_be_set(views):
    message = views()
    with pytest.raises(AttributeError):
        message.across = 1
    with pytest.raises(AttributeError):
        message.across_v = 1.0
    with pytest.raises(TypeError):
        views(across=1)


def test_overlay_fields_follow_the_fields_of_a_message(views):
    message = views(narrow=31)
    fields, overlays = (
        ["narrow", "rest", "word", "octets"],
        [
            "across",
            "property",
            "top",
            "real",
            "within",
        ],
    )
    assert [info.attribute for info in views.FIELDS] == fields
    assert [info.attribute for info in views.VIEWS] == overlays
    assert list(message.as_dict()) == fields + overlays
    assert list(message.as_dict(physical=True))[4] == "across_v"
    assert (
        views.from_dict(message.as_dict())
        == views.from_json(message.to_json(physical=True))
        == message
    )
    assert views.from_physical(**message.as_dict(physical=True)) == message
    assert "across" not in repr(message) and message == views(narrow=31) != views(
        narrow=30
    )


def test_a_message_with_a_value_out_of_range_has_no_overlay_values_but_can_be_printed(
    odd, views
):
    message = views(narrow=32)
    with pytest.raises(odd.module().RangeError) as caught:
        message.across  # noqa: B018
    assert caught.value.field == "narrow"
    assert "narrow=32" in repr(message) and message != views()


def test_tables_have_overlay_fields_as_columns(views):
    frames = [bytes(range(start, start + 12)) for start in range(0, 240, 7)]
    columns = views.decode_many(b"".join(frames))
    for name, column in columns.items():
        expected = [getattr(views.from_bytes(frame), name) for frame in frames]
        if name != "octets":
            assert column.tolist() == expected, name
