"""The record lists exactly the violations of MISRA C:2012 that cppcheck finds.

Each entry has a reason. `tests.c.misra` finds the violations and compares them.
"""

from __future__ import annotations

import copy

import pytest

from tests.c import misra

VERDICTS = {"deviation", "false positive"}
CATEGORIES = {
    "required",
    "advisory",
}  # the standard allows no deviation from mandatory rules


@pytest.fixture(scope="module")
def now():
    return misra.current_places(is_complete=False)


def test_the_record_is_what_cppcheck_finds(now):
    differences = misra.differences(misra.record(), now)
    assert differences == [], (
        "mend the code, or give the reason in runtime/c/misra.yaml: python -m tests.c.misra"
    )


def test_the_runtime_and_every_template_are_checked(now):
    assert now["15.5"]["runtime"].keys() >= {
        "wire/client.c",
        "wire/procedure.c",
        "support/wide.h",
    }
    assert set(now["2.5"]["generated"]) | set(now["15.5"]["generated"]) == {
        "client.h.j2", "enums.h.j2", "link.c.j2", "link.h.j2", "message.h.j2", "node.h.j2", "procedures.h.j2",
    }  # fmt: skip


def test_every_entry_has_a_verdict_and_a_reason():
    for entry in misra.record():
        assert entry["verdict"] in VERDICTS and entry["category"] in CATEGORIES, entry[
            "rule"
        ]
        assert len(entry["reason"].split()) > 4 and entry["reason"].endswith("."), (
            entry["rule"]
        )


def test_a_new_violation_is_reported(tmp_path):
    source = tmp_path / "generated" / "demo" / "state.h"
    source.parent.mkdir(parents=True)
    source.write_text(
        "static int f(int n);\nstatic int f(int n)\n{\n    int r = n;\n    r = f(n - 1);\n    return r;\n}\n"
    )
    program = tmp_path / "nodes.c"
    program.write_text(f'#include "{source}"\n')
    places = misra.places(misra.findings(program), tmp_path)
    assert places["17.2"] == {"runtime": {}, "generated": ["message.h.j2"]}
    assert "17.2: message.h.j2 is not in the record" in misra.differences(
        misra.record(), places
    )


def test_an_entry_without_a_violation_is_reported():
    recorded = misra.record()
    places = {entry["rule"]: copy.deepcopy(entry) for entry in recorded}
    assert misra.differences(recorded, places) == []
    del places["19.2"]
    places["15.5"]["runtime"]["wire/uart.c"] -= 1
    assert [line.split(":")[0] for line in misra.differences(recorded, places)] == [
        "15.5",
        "19.2",
    ]
