"""The statements of methods that give derived values."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.lines import STEP
from icdgen.backends.rust.names import RESERVED
from icdgen.backends.rust.physical import raw_value
from icdgen.backends.rust.text import assigned, double
from icdgen.describe import FieldDescription
from icdgen.describe.derived import derived

_TAKEN = RESERVED | {"power", "quiet", "whole"}


def derived_statements(field: FieldDescription) -> Iterator[str]:
    """The body of the method of a derived value."""
    found = derived(field, _TAKEN)
    for name, one in found.fields:
        yield assigned(f"let {name} =", _as_double(one), ";", STEP * 2)
    for name, operator, *both in found.statements:
        left, right = (one if isinstance(one, str) else double(one) for one in both)
        value = f"power({left}, {right})" if operator == "^" else f"{left} {operator} {right}"
        yield assigned(f"let {name} =", value, ";", STEP * 2)
    yield f"{STEP * 2}quiet({found.result})"


def _is_long(field: FieldDescription) -> bool:
    """Whether it is a whole number that a double may have to round."""
    return not field.is_scaled and field.storage.bits == 64 and field.model.type != "float"


def _as_double(field: FieldDescription) -> str:
    if field.is_scaled:
        return f"self.{field.physical_name}()"
    raw = raw_value(field)
    if _is_long(field):
        return f"whole({raw})"
    return raw if field.storage.bits == 64 else f"f64::from({raw})"
