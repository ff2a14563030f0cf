"""Functions that templates call are found by their bare names."""

from __future__ import annotations

import pytest

from icdgen.backends.template_functions import functions_by_name
from icdgen.describe.comments import words


def test_two_functions_of_one_name_are_refused():
    def other(text: str) -> str:
        return text

    other.__name__ = "words"
    assert functions_by_name((words, words)) == {"words": words}
    with pytest.raises(ValueError, match="two functions have the name `words`"):
        functions_by_name((words, other))
