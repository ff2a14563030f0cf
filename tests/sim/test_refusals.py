"""Reasons of refusals are named by a member of the enumeration or by a number."""

from __future__ import annotations

from icdgen_runtime.wire.packet_formats import NumberPlace, Response

from icdgen.sim.refusals import first_refusal_code, refusal_code, refusal_names
from tests.limits import assert_limits

PLACE = NumberPlace(1, 1, 0, 4, True)
OTHER = NumberPlace(0, 1, 0, 8, True)
REASONS = ((0, "Good"), (1, "Wait"), (2, "Bad"), (3, "Bad"), (4, "Later"), (16, "Wide"))
MEANINGS = ((0, "ack"), (1, "progress"), (4, "again"))


def response(status: NumberPlace | None, reason: NumberPlace | None) -> Response:
    return Response(1, "nak", (), status, MEANINGS, reason, REASONS)


def test_a_status_names_only_what_refuses_or_defers():
    status = response(PLACE, PLACE)
    assert refusal_names(status) == ("Bad", "Later")
    assert first_refusal_code(status) == 2
    assert [
        refusal_code(status, text) for text in ("Bad", "Later", "Good", "Wait")
    ] == [
        2,
        4,
        None,
        None,
    ]
    assert refusal_code(status, "0x0F") == 15 and refusal_code(status, "0") is None


def test_a_reason_beside_the_status_may_be_each_value():
    beside = response(OTHER, PLACE)
    assert refusal_names(beside) == ("Good", "Wait", "Bad", "Later")
    assert first_refusal_code(beside) == 0
    assert refusal_code(beside, "Good") == 0
    assert_limits(lambda n: refusal_code(beside, str(n)) == n, least=0, most=15)


def test_a_name_that_does_not_fit_and_an_unknown_name_have_no_number():
    beside = response(OTHER, PLACE)
    assert refusal_code(beside, "Wide") is None
    assert refusal_code(beside, "Unknown") is None


def test_without_the_place_of_a_reason_there_is_none():
    without = response(PLACE, None)
    assert refusal_names(without) == ()
    assert first_refusal_code(without) is None
    assert refusal_code(without, "2") is None
