"""Rows of the tables of framed links have the member order of the runtime."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.stream_rows import (
    field_row,
    message_row,
    number_place,
    only_id,
    verdict_mask,
)
from icdgen.icd.responses import AGAIN, KINDS
from icdgen.protocol.packet_formats import REQUESTED

FIELD = {
    "role": "constant", "in_trailer": False, "at": 3, "size": 2, "shift": 1, "bits": 9,
    "little": True, "values": (4, 0x1F), "id_shift": 5, "plus": 0, "unit": 1,
}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, "{ICD_FIELD_CONSTANT, false, 3u, 2u, 1u, 9u, true, {0x4u, 0x1fu}},"),
        (
            {"role": "id", "in_trailer": True, "little": False},
            "{ICD_FIELD_ID, true, 3u, 2u, 1u, 9u, false, {0x5u, 0x5u}},",
        ),
        (
            {"role": "length", "plus": -6, "unit": 4},
            "{ICD_FIELD_LENGTH, false, 3u, 2u, 1u, 9u, true, {0xfffffffau, 0x4u}},",
        ),
        (
            {"role": "response_length", "plus": 6},
            "{ICD_FIELD_RESPONSE_LENGTH, false, 3u, 2u, 1u, 9u, true, {0x6u, 0x1u}},",
        ),
    ],
)
def test_a_field_has_place_order_and_its_two_numbers(changes, text):
    assert str(field_row(SimpleNamespace(**{**FIELD, **changes}))) == text


def test_a_place_is_behind_the_bytes_in_front_of_it():
    place = SimpleNamespace(at=3, size=2, shift=1, bits=9, little=True)
    assert number_place(place) == "{3u, 2u, 1u, 9u, true}"
    assert number_place(place, 4) == "{7u, 2u, 1u, 9u, true}"
    assert number_place(None, 4) == "{0u, 0u, 0u, 0u, false}"


def test_a_mask_has_the_bit_of_each_verdict():
    def mask(verdict, *meanings):
        rows = tuple(enumerate(meanings))
        return int(
            verdict_mask(SimpleNamespace(verdict=verdict, meanings=rows))[:-1], 16
        )

    verdicts = (*KINDS, AGAIN)
    assert [mask(verdict) for verdict in verdicts] == [
        1 << n for n in range(len(verdicts))
    ]
    assert mask(KINDS[1], KINDS[1], AGAIN) == 2 | 1 << len(KINDS)


ROW = {
    "name": "Reset */", "id": 26, "least": 2, "most": 9, "seed": 7, "packet": 0,
    "requests": None, "cuts_zeros": False, "repeats": False, "is_requested": False,
}  # fmt: skip


def stream(*contents, rows=()):
    packets = [SimpleNamespace(content=content) for content in contents]
    return SimpleNamespace(packets=packets, rows=lambda direction: rows)


@pytest.mark.parametrize(
    ("content", "changes", "exchange", "values"),
    [
        ("data", {}, None, "0u, 7u, 0u, 0x0u, NULL"),
        (
            "data",
            {"requests": 27, "cuts_zeros": True},
            "&reset",
            "CUTS_ZEROS | REQUESTS, 7u, 0u, 0x1bu, &reset",
        ),
        (
            "data",
            {"requests": 0, "repeats": True},
            None,
            "REPEATS | REQUESTS, 7u, 0u, 0x0u, NULL",
        ),
        (
            REQUESTED,
            {"is_requested": True},
            None,
            "REQUESTED | NAMELESS, 7u, 0u, 0x0u, NULL",
        ),
    ],
)
def test_a_message_has_its_lengths_flags_and_request(
    content, changes, exchange, values
):
    row = message_row(stream(content), SimpleNamespace(**{**ROW, **changes}), exchange)
    assert row.value.replace("ICD_STREAM_", "") == f"{{0x1au, 2u, 9u, {values}}}"
    assert "*/" not in row.text and row.text.startswith("Reset ")


def test_a_packet_has_the_smallest_id_of_its_messages_only():
    rows = [
        SimpleNamespace(id=id, packet=packet) for id, packet in ((9, 0), (4, 0), (3, 1))
    ]
    form = stream("data", "data", "data", REQUESTED, rows=rows)
    assert [only_id(form, packet, "telemetry") for packet in range(3)] == [4, 3, 0]
    nameless = [SimpleNamespace(id=8, packet=3)]
    assert only_id(stream(*["data"] * 3, REQUESTED, rows=nameless), 3, "telemetry") == 0
