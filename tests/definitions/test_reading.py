"""Steps of work are limited, and findings about fields list their messages once."""

from __future__ import annotations

import pytest

from icdgen.definitions.model import Definitions
from icdgen.definitions.reading import ReadingState, TooMuch
from tests.limits import assert_limits


class Steps(ReadingState):
    most_steps = 1500


def test_a_file_takes_at_most_the_steps_of_its_reader():
    def is_accepted(count):
        state = Steps(Definitions(""))
        state.step()
        try:
            state.step(count - 1)
        except TooMuch as error:
            assert str(error) == "with it the file says more than 1,500 things"
            return False
        return True

    assert_limits(is_accepted, most=1500)


def test_findings_about_a_subject_are_reported_once():
    state = Steps(Definitions("a.xml"))
    assert state.heard("x") is state.to and state.heard("x") is not state.to
    assert [state.is_new(what) for what in ("y", "x", "y")] == [True, False, False]


@pytest.mark.parametrize(
    ("names", "shown"),
    [
        (["A"], "message `A`"),
        (["A", "B", "A"], "messages `A`, `B`"),
        (["C", "B", "A"], "messages `C`, `B`, `A`"),
        (["A", "B", "C", "D"], "messages `A`, `B`, `C` and 1 more"),
        (["A", "B", "C", "D", "E"], "messages `A`, `B`, `C` and 2 more"),
    ],
)
def test_a_field_with_its_raw_value_only_lists_three_messages(names, shown):
    state = Steps(Definitions("a.xml"))
    for state.message in names:
        state.raw_only("`Speed`", "it is odd", "mend it")
    state.raw_only("`Load`", "it is odd", "mend it")
    state.report_raw_only()
    first, second = state.to.import_findings
    assert (first.code, first.severity, first.help) == ("IMP078", "warning", "mend it")
    assert first.message == f"`Speed` ({shown}): it is odd"
    assert second.message == f"`Load` (message `{names[-1]}`): it is odd"
