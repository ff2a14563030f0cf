"""Test a limit at, below and above its value.

A limit is off by one in two ways: it refuses its own value, or it accepts the next
one. A test that tries only a value far outside finds neither. ``assert_limits`` tries
both sides of each end::

    assert_limits(lambda bits: is_valid(bits), least=1, most=64)
"""

from __future__ import annotations

from collections.abc import Callable


def assert_limits(
    is_accepted: Callable[[int], bool],
    *,
    least: int | None = None,
    most: int | None = None,
    step: int = 1,
) -> None:
    """Assert that ``least`` and ``most`` are accepted, and that the next value outside
    is rejected.

    The next value inside each end is also tested. Give one end or both. ``step`` is the
    distance of neighbouring values: 8 for bits of whole bytes.
    """
    assert least is not None or most is not None, "give `least`, `most` or both"
    expected: dict[int, bool] = {}
    if least is not None:
        expected |= {least - step: False, least: True}
        if most is None or least + step <= most:
            expected[least + step] = True
    if most is not None:
        expected |= {most: True, most + step: False}
        if least is None or most - step >= least:
            expected[most - step] = True
    wrong = [
        f"{value} is {'refused' if accepted else 'accepted'}"
        for value, accepted in sorted(expected.items())
        if is_accepted(value) != accepted
    ]
    ends = [f"at least {least}"] * (least is not None)
    ends += [f"at most {most}"] * (most is not None)
    assert not wrong, f"{', '.join(wrong)}; the limit is {' and '.join(ends)}"
