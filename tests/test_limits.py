"""The helper for limits reports each way in which a limit can be off by one."""

from __future__ import annotations

import pytest

from tests.limits import assert_limits


def test_a_limit_that_is_right_passes():
    assert_limits(lambda value: 2 <= value <= 5, least=2, most=5)
    assert_limits(lambda value: value == 2, least=2, most=2)
    assert_limits(lambda bits: bits in (8, 16), least=8, most=16, step=8)


@pytest.mark.parametrize(
    ("is_accepted", "message"),
    [
        (lambda value: 1 <= value <= 5, "1 is accepted; the limit is at least 2"),
        (lambda value: 2 < value <= 5, "2 is refused; the limit is at least 2"),
        (lambda value: 2 <= value < 5, "5 is refused; the limit is at least 2 and"),
        (lambda value: 2 <= value <= 6, "6 is accepted; the limit is at least 2 and"),
        (lambda value: value in (2, 5), "3 is refused, 4 is refused"),
    ],
)
def test_a_limit_that_is_off_by_one_is_reported(is_accepted, message):
    with pytest.raises(AssertionError, match=message):
        assert_limits(is_accepted, least=2, most=5)
