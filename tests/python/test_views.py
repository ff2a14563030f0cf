"""Fields that read bits of others."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def views(odd):
    return odd.module("odd").Views


def test_a_view_says_what_its_bits_hold_and_follows_the_fields_that_have_them(
    odd, views
):
    message = views.from_bytes(bytes.fromhex("0dff 0000c03f 8000000000ff"))
    assert (message.narrow, message.rest, message.across, message.across_v) == (
        1,
        -513,
        223,
        111.5,
    )
    assert (message.property, message.real, message.within) == (True, 1.5, 3)
    message.narrow, message.word, message.octets = (
        0b11100,
        0,
        b"\x20" + bytes(4) + b"\x40",
    )
    assert (message.property, message.real, message.within) == (
        False,
        0.0,
        (0x20 << 34 & (1 << 40) - 1) | 0x40 >> 6,
    )
    assert message.top is odd.module("odd").Signed(-1)


def test_a_view_is_not_set(views):
    message = views()
    with pytest.raises(AttributeError):
        message.across = 1
    with pytest.raises(AttributeError):
        message.across_v = 1.0
    with pytest.raises(TypeError):
        views(across=1)


def test_views_stand_behind_the_fields_of_a_message(views):
    message = views(narrow=31)
    own, seen = (
        ["narrow", "rest", "word", "octets"],
        [
            "across",
            "property",
            "top",
            "real",
            "within",
        ],
    )
    assert [info.attribute for info in views.FIELDS] == own
    assert [info.attribute for info in views.VIEWS] == seen
    assert list(message.as_dict()) == own + seen
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


def test_a_message_that_makes_no_frame_has_no_views_and_can_be_shown(odd, views):
    message = views(narrow=32)
    with pytest.raises(odd.module().RangeError) as caught:
        message.across  # noqa: B018
    assert caught.value.field == "narrow"
    assert "narrow=32" in repr(message) and message != views()


def test_tables_have_views_as_columns(views):
    frames = [bytes(range(start, start + 12)) for start in range(0, 240, 7)]
    columns = views.decode_many(b"".join(frames))
    for name, column in columns.items():
        expected = [getattr(views.from_bytes(frame), name) for frame in frames]
        if name != "octets":
            assert column.tolist() == expected, name
