"""Constants of fields: the only valid value, raw values with a meaning, and limits.

`constants_of_field` gives each a name in snake case, a value and a comment. A backend
spells them as macros, class attributes or associated constants.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from icdgen import naming
from icdgen.describe.bounds import bounds_of_limits
from icdgen.describe.comments import sentence, words
from icdgen.frozen import NamedTuple
from icdgen.icd.places import NodePlace

MOST_WORDS = 5
"""Number of words up to which a meaning becomes the name of its constant."""


class Constant(NamedTuple):
    """Constant of a field.

    Its name in snake case is unique in the message: ``timeout_no_timeout``,
    ``rate_deg_per_s_below``.
    """

    key: str  # "const" | "special" | the key of a limit
    name: str
    value: int | Fraction
    # A raw value (an int); else a physical value, or a limit beyond the raw type.
    is_raw: bool
    comment: str
    # of a float with the bits ``value``: `nan`, `inf`, `-inf`, or a decimal
    number: str = ""

    @property
    def double(self) -> float:
        """Double nearest to the physical value."""
        return self.value.numerator / self.value.denominator


def constants_of_field(
    field: NodePlace, name: str, physical_name: str, vocabulary: tuple[str, ...]
) -> Iterator[Constant]:
    """List the constants of a field with these names of its raw and physical value."""
    title = words(field.name)
    if field.const is not None:
        yield Constant(
            "const",
            f"{name}_const",
            field.const,
            True,
            f"{title}: the only valid raw value.",
        )
    taken = set()
    for special in field.special:
        meaning = naming.words(special.meaning, vocabulary)
        end = naming.snake(meaning)
        # Two values can have the same meaning, such as `reserved`: the later ones are
        # named after their value.
        if not 0 < len(meaning) <= MOST_WORDS or end in taken:
            end = (
                # A name can have neither a sign nor a point.
                f"special_{special.number or special.value}".replace("-", "minus_")
                .replace(".", "_")
                .replace("+", "")
            )
        taken.add(end)
        comment = f"{title}: {sentence(special.meaning)}"
        yield Constant(
            "special", f"{name}_{end}", special.value, True, comment, special.number
        )
    unit = f" in {words(field.unit.symbol)}" if field.unit else ""
    for bound in bounds_of_limits(field.limits):
        value, has_raw = bound.value, not field.has_formula and field.type != "float"
        # A limit can be between two raw values or beyond the raw type. It then has no
        # literal of that type.
        is_raw = (
            has_raw
            and value.denominator == 1
            and field.raw_min <= value <= field.raw_max
        )
        end = f"{physical_name if field.has_formula else name}_{bound.key}"
        yield Constant(
            bound.key,
            end,
            int(value) if is_raw else value,
            is_raw,
            f"{title}{unit}: {bound.kind.title}.",
        )
