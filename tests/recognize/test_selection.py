"""The message and the kind that a user names select readings of a frame."""

from __future__ import annotations

import pytest

from icdgen.recognize import match
from icdgen.recognize.reading import FrameReading, endpoint_of
from icdgen.recognize.selection import Selection, selection_of
from icdgen.values.errors import Ambiguous, NotFound
from tests.features.outputs import icd_of
from tests.recognize.test_asked import PACK


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory):
    icd = icd_of(PACK, tmp_path_factory.mktemp("pack"))
    return endpoint_of(icd, icd.node("pack"))


def select(endpoint, key: str | None = None, kind: str | None = None) -> Selection:
    return selection_of(endpoint.icd, endpoint.node, key, kind)


def readings(endpoint, body: str) -> list[FrameReading]:
    return match.by_id([endpoint], bytes.fromhex(body))


def kept(endpoint, selection: Selection, body: str) -> list[str]:
    return [
        f"{each.what} {each.message.name}"
        for each in readings(endpoint, body)
        if selection.fits(each)
    ]


def test_without_a_name_and_a_kind_every_reading_fits(endpoint):
    for selection in (select(endpoint), selection_of(endpoint.icd, None, "Rate", None)):
        assert selection == Selection()
        assert kept(endpoint, selection, "01010000") == [
            "telecommand Set Limit",
            "telemetry Limit",
        ]
        assert not any(map(selection.is_of, readings(endpoint, "01010000")))
        assert not selection.can_have_length(b"\0\0")
        assert selection.names == ""


@pytest.mark.parametrize(
    ("key", "kind", "expected"),
    [
        (None, "telecommand", ["telecommand Set Limit"]),
        (None, "telemetry", ["telemetry Limit"]),
        (None, "configuration", []),
        ("Limit", None, ["telemetry Limit"]),
        ("257", "telecommand", ["telecommand Set Limit"]),
        ("Poll", None, []),
    ],
)
def test_the_name_and_the_kind_select_readings(endpoint, key, kind, expected):
    assert kept(endpoint, select(endpoint, key, kind), "01010000") == expected


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (None, ["telecommand Rate", "telemetry Rate"]),
        ("telecommand", ["telecommand Rate"]),
        ("telemetry", ["telemetry Rate"]),
        ("configuration", ["telecommand Rate", "telemetry Rate"]),
    ],
)
def test_a_kind_is_that_of_the_reading_or_of_its_message(endpoint, kind, expected):
    for key in (None, "Rate"):
        assert kept(endpoint, select(endpoint, key, kind), "010307") == expected


def test_a_request_has_the_kind_of_its_message(endpoint):
    (request,) = readings(endpoint, "0103")
    assert request.what == "request"
    for kind, expected in (
        ("request", True),
        ("configuration", True),
        ("telemetry", False),
        ("telecommand", False),
    ):
        assert Selection(kind=kind).fits(request) is expected


def test_messages_that_share_an_id_are_selected_together(endpoint):
    selection = select(endpoint, "260")
    assert [message.name for message in selection.messages] == ["Low", "High"]
    assert selection.names == "`Low` or `High`"
    assert kept(endpoint, selection, "010402") == ["telemetry High"]
    assert selection.can_have_length(b"\0") and not selection.can_have_length(b"")
    assert select(endpoint, "Low").names == "`Low`"


def test_a_length_of_any_selected_message_is_possible(endpoint):
    log = select(endpoint, "Log")
    assert [log.can_have_length(bytes(size)) for size in (0, 40, 41)] == [
        True,
        True,
        False,
    ]


def test_an_id_of_both_directions_and_an_unknown_name_are_errors(endpoint):
    with pytest.raises(Ambiguous):
        select(endpoint, "257")
    with pytest.raises(NotFound):
        select(endpoint, "No such message")
    with pytest.raises(NotFound):
        select(endpoint, "Limit", "telecommand")


def test_matching_readings_are_preferred_to_all(endpoint):
    both = readings(endpoint, "01010000")
    limit = select(endpoint, "Limit")
    assert [e.message.name for e in limit.matching_or_all(both)] == ["Limit"]
    assert select(endpoint, "Poll").matching_or_all(both) == both
    assert limit.matching_or_all([]) == []
