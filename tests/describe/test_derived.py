"""Statements of derived values compute them with names that are free."""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.derived import computation_of
from tests.icd.files import loaded, status


def derived(folder, formula, first="A", second="B"):
    fields = (
        f"at: 0, bits: 8, name: {first}, type: uint",
        f"at: 8, bits: 8, name: {second}, type: uint, formula: raw*0.5",
    )
    text = status(*fields) + (
        f'    derived:\n      - {{name: Sum, formula: "{formula}"}}\n'
    )
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    (field,) = describe(result.icd).nodes[0].messages[0].derived
    return field


def evaluated(computation, values):
    """Return the value of statements as Python executes them."""
    names = dict(values)
    for name, text in computation.expressions(repr, "pow({}, {})"):
        names[name] = eval(text, {"pow": pow}, dict(names))
    return names[computation.result]


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("A - B", lambda a, b: a - b),
        ("B - A", lambda a, b: b - a),
        ("A / B", lambda a, b: a / b),
        ("2*A + B^3 - 7", lambda a, b: 2 * a + b**3 - 7),
        ("(A - 2)*(B + 3)/4", lambda a, b: (a - 2) * (b + 3) / 4),
    ],
)
def test_statements_compute_the_formula(tmp_path, formula, expected):
    computation = computation_of(derived(tmp_path, formula))
    for a, b in ((6.0, 4.0), (1.0, 0.5)):
        assert evaluated(computation, {"a": a, "b": b}) == expected(a, b)
    assert [field.name for _, field in computation.fields] == [
        name for name, _ in computation.fields
    ]


def test_a_power_is_a_call_and_other_operators_are_written(tmp_path):
    computation = computation_of(derived(tmp_path, "A^2 + B"))
    assert list(computation.expressions("{:.1f}".format, "pow({}, {})")) == [
        ("step_1", "pow(a, 2.0)"),
        ("step_2", "step_1 + b"),
    ]
    assert computation.result == "step_2"


def test_names_of_variables_are_free_and_different(tmp_path):
    field = derived(tmp_path, "Step 1 + B - 2", first="Step 1")
    computation = computation_of(field, {"b", "b_"})
    assert [name for name, _ in computation.fields] == ["step_1", "b__"]
    assert [each.name for each in computation.statements] == ["step_1_", "step_2"]
    values = {"step_1": 5.0, "b__": 4.0}
    assert evaluated(computation, values) == 7.0
