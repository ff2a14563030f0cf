"""The examples that `icdgen rule` prints break, or obey, exactly the rule they
illustrate.
"""

from __future__ import annotations

import pytest

from icdgen.icd import rules
from tests.icd.files import codes


@pytest.mark.parametrize("code", rules.ALL)
def test_the_wrong_example_breaks_this_rule_and_no_other(code, tmp_path):
    assert set(codes(tmp_path, rules.ALL[code].page.wrong)) == {code}


@pytest.mark.parametrize("code", rules.ALL)
def test_the_right_example_breaks_no_rule(code, tmp_path):
    assert codes(tmp_path, rules.ALL[code].page.right) == []
