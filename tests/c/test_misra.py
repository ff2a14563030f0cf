"""Every violation of MISRA C:2012 that cppcheck finds is in the record, with a reason,
and nothing else is.
"""

from __future__ import annotations

import copy

import pytest

from tests.c import misra

VERDICTS = {"deviation", "false positive"}
CATEGORIES = {"required", "advisory"}  # nobody may deviate from what is mandatory


@pytest.fixture(scope="module")
def now():
    return misra.found(whole=False)


def test_the_record_is_what_cppcheck_finds(now):
    differences = misra.differences(misra.record(), now)
    assert differences == [], (
        "mend the code, or give the reason in runtime/c/misra.yaml: python -m tests.c.misra"
    )


def test_the_runtime_and_every_template_were_looked_at(now):
    assert now["15.5"]["runtime"].keys() >= {
        "wire/client.c",
        "wire/procedure.c",
        "support/wide.h",
    }
    assert set(now["2.5"]["generated"]) | set(now["15.5"]["generated"]) == {
        "client.h.j2", "enums.h.j2", "link.c.j2", "link.h.j2", "message.h.j2", "node.h.j2", "procedures.h.j2",
    }  # fmt: skip


def test_every_entry_says_why_it_stays():
    for one in misra.record():
        assert one["verdict"] in VERDICTS and one["category"] in CATEGORIES, one["rule"]
        assert len(one["reason"].split()) > 4 and one["reason"].endswith("."), one[
            "rule"
        ]


def test_a_violation_that_is_new_is_noticed(tmp_path):
    source = tmp_path / "made" / "demo" / "state.h"
    source.parent.mkdir(parents=True)
    source.write_text(
        "static int f(int n);\nstatic int f(int n)\n{\n    int r = n;\n    r = f(n - 1);\n    return r;\n}\n"
    )
    program = tmp_path / "nodes.c"
    program.write_text(f'#include "{source}"\n')
    found = misra.places(misra.findings(program), tmp_path)
    assert found["17.2"] == {"runtime": {}, "generated": ["message.h.j2"]}
    assert "17.2: message.h.j2 is not in the record" in misra.differences(
        misra.record(), found
    )


def test_an_entry_that_nothing_breaks_any_more_is_noticed():
    recorded = misra.record()
    found = {one["rule"]: copy.deepcopy(one) for one in recorded}
    assert misra.differences(recorded, found) == []
    del found["19.2"]
    found["15.5"]["runtime"]["wire/uart.c"] -= 1
    assert [line.split(":")[0] for line in misra.differences(recorded, found)] == [
        "15.5",
        "19.2",
    ]
