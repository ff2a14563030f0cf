"""A Hypothesis strategy for values that are derived from the fields of a message."""

from __future__ import annotations

from hypothesis import strategies as st

from icdgen.icd.derived import parse
from icdgen.icd.formula import FormulaError
from icdgen.icd.roles import EXPONENT

_ALONE = ("count", "when", "bitfields", "struct", "up_to")


@st.composite
def derived(draw, fields: list[dict]) -> dict:
    """Draw the key ``derived`` for a message with these fields; empty if no field is a
    number.
    """
    numbers = [
        field
        for field in fields
        if field.get("type") in ("uint", "int", "float")
        and not any(k in field for k in _ALONE)
    ]
    if not numbers or draw(st.booleans()):
        return {}
    powers = [field["name"] for field in numbers if _is_exponent(field)]
    names = [field["name"] for field in numbers]
    identifiers = {
        part["name"]
        for field in fields
        for part in (field, *field.get("bitfields", ()))
    }
    rows: list[dict] = []
    for number in range(draw(st.integers(1, 4))):
        text, used = draw(_expression(names, powers))
        try:
            references = set(parse(text, identifiers | set(names)).fields)
        except FormulaError:
            # A name contains text with another meaning, or the formula divides by zero.
            continue
        if references == used:
            unit = draw(st.sampled_from(({}, {"unit": "deg"}, {"unit": "m/s"})))
            rows.append(
                {
                    "name": f"derived {number}",
                    "identifier": f"derived value {number}",
                    **unit,
                    "formula": text,
                }
            )
            names = [*names, f"derived {number}"]
    return {"derived": rows} if rows else {}


def _is_exponent(field: dict) -> bool:
    is_plain = (
        field["type"] != "float" and "formula" not in field and "points" not in field
    )
    return is_plain and field["bits"] <= EXPONENT.most_bits


@st.composite
def _expression(
    draw, names: list[str], powers: list[str], depth: int = 3
) -> tuple[str, set[str]]:
    """Draw a formula and the names in it."""
    kind = draw(st.integers(0, 6)) if depth else draw(st.integers(0, 1))
    if kind == 0:
        return (
            draw(
                st.sampled_from(
                    (
                        "0",
                        "1",
                        "0.01",
                        "2/3",
                        "1e-9",
                        "604800",
                        "2^-19",
                        "1e30",
                        "10^-3",
                    )
                )
            ),
            set(),
        )
    if kind == 1:
        name = draw(st.sampled_from(names))
        return name, {name}
    left, used = draw(_expression(names, powers, depth - 1))
    if kind == 2:
        name = draw(st.sampled_from(powers)) if powers and draw(st.booleans()) else ""
        return f"({left}) ^ {name or draw(st.integers(-5, 15))}", used | (
            {name} if name else set()
        )
    if kind == 3:
        return f"-({left})", used
    right, right_names = draw(_expression(names, powers, depth - 1))
    return f"({left}) {draw(st.sampled_from('+-*/'))} ({right})", used | right_names
