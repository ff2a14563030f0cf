"""A Hypothesis strategy for values that are derived from the fields of a message."""

from __future__ import annotations

from hypothesis import strategies as st

from icdgen.icd.derived import parse
from icdgen.icd.formula import FormulaError
from icdgen.icd.roles import EXPONENT

_ALONE = ("count", "when", "bitfields", "struct", "up_to")


@st.composite
def derived(draw, fields: list[dict]) -> dict:
    """The key ``derived`` of a message of these fields; none where there is no number."""
    numbers = [
        one
        for one in fields
        if one.get("type") in ("uint", "int", "float")
        and not any(k in one for k in _ALONE)
    ]
    if not numbers or draw(st.booleans()):
        return {}
    powers = [one["name"] for one in numbers if _is_exponent(one)]
    names = [one["name"] for one in numbers]
    taken = {
        part["name"] for one in fields for part in (one, *one.get("bitfields", ()))
    }
    rows: list[dict] = []
    for number in range(draw(st.integers(1, 4))):
        text, used = draw(_expression(names, powers))
        try:
            found = set(parse(text, taken | set(names)).fields)
        except FormulaError:
            continue  # a name has what reads as something else, or it divides by zero
        if found == used:
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
    """A formula, and the names in it."""
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
    right, others = draw(_expression(names, powers, depth - 1))
    return f"({left}) {draw(st.sampled_from('+-*/'))} ({right})", used | others
