"""Decoders accept exactly the lengths that a message can have."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from icdgen.describe import describe
from icdgen.describe.lengths import LengthTest, length_tests, length_tests_of_frame
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT


def passes(test: LengthTest, length: int) -> bool:
    match test.kind:
        case "equal":
            return length == test.value
        case "at least":
            return length >= test.value
        case "at most":
            return length <= test.value
    return (length - test.without) % test.value == 0


@given(st.integers(0, 20), st.integers(0, 20), st.integers(1, 9))
def test_a_decoder_accepts_exactly_the_lengths_of_a_message(least, more, step):
    lengths = range(least, least + more * step + 1, step)
    tests = length_tests_of_frame(lengths)
    for length in range(least + more * step + 20):
        assert all(passes(test, length) for test in tests) == (length in lengths)


@given(st.integers(0, 20), st.integers(0, 20), st.integers(1, 9))
def test_a_length_check_is_omitted_only_if_it_is_implied(minimum, more, step):
    lengths = range(minimum, minimum + more * step + 1, step)
    tests = length_tests(lengths, minimum)
    assert "at least" not in {test.kind for test in tests}
    for length in range(minimum, minimum + more * step + 20):
        assert all(passes(test, length) for test in tests) == (length in lengths)


def test_messages_with_parts_of_variable_length_accept_the_lengths_of_their_last_part():
    icd = read_unchecked(ROOT / "tests/conformance/odd_icds")
    messages = [
        message.model for node in describe(icd).nodes for message in node.messages
    ]
    single = [
        message.layout
        for message in messages
        if message.layout.parts and not message.layout.has_inner_gaps
    ]
    assert single
    for layout in single:
        tests = length_tests_of_frame(layout.lengths)
        accepted = [
            length
            for length in range(layout.longest + 9)
            if all(passes(test, length) for test in tests)
        ]
        assert accepted == list(layout.parts[0].possible_ends) == list(layout.lengths)


def test_a_decoder_accepts_exactly_the_counters_of_a_variable_part():
    icd = read_unchecked(ROOT / "tests/conformance/odd_icds")
    messages = [message for node in describe(icd).nodes for message in node.messages]
    parts = [
        part
        for message in messages
        for part in message.variable_parts
        if not part.is_rest
    ]
    assert parts
    for part in parts:
        low, high = part.model.low, part.model.high
        for value in {0, low - 1, low, high, high + 1, part.counter.storage.max}:
            if 0 <= value <= part.counter.storage.max:
                accepted = all(passes(test, value) for test in part.counter_tests)
                assert accepted == (
                    part.model.fewest <= value + part.model.plus <= part.model.most
                )
