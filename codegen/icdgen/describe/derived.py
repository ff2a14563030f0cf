"""Derived values as statements.

Each statement computes a local variable by one operation on two operands.
`computation_of` converts the steps of a field (`icdgen.icd.derived`) to such
statements, with names that are free in the generated function. The C and Rust
generators print them with `DerivedComputation.expressions`. The Python generator uses
only the operands: the runtime executes the steps.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

from icdgen.describe.description import FieldDescription
from icdgen.frozen import NamedTuple

Operand = str | float  # a local variable, or a number


class Statement(NamedTuple):
    """``name = left operator right``, rounded to a double."""

    name: str
    operator: str  # one of + - * / ^
    left: Operand
    right: Operand


class DerivedComputation(NamedTuple):
    """Computation of a derived value.

    ``fields`` are local variables with the physical values of fields as doubles;
    without a scale the raw values.
    """

    fields: tuple[tuple[str, FieldDescription], ...]
    statements: tuple[Statement, ...]
    result: str  # the local variable with the derived value

    def expressions(
        self, number: Callable[[float], str], power: str
    ) -> Iterator[tuple[str, str]]:
        """List the variables of the statements with their expressions in a language.

        ``number`` spells a number; ``power`` is the call of a function of two operands.
        """
        for name, operator, *operands in self.statements:
            left, right = (
                operand if isinstance(operand, str) else number(operand)
                for operand in operands
            )
            # `^` is the exclusive or in C and Rust, which have no operator for powers.
            is_power = operator == "^"
            yield (
                name,
                (
                    power.format(left, right)
                    if is_power
                    else f"{left} {operator} {right}"
                ),
            )


def computation_of(
    field: FieldDescription, taken: Collection[str] = ()
) -> DerivedComputation:
    """Return the computation of a derived value.

    No local variable has a name of ``taken``.
    """
    how = field.model.derived
    assert how is not None
    members = {member.model.name: member for member in field.message.declared_members}
    names: list[str] = []
    for name in how.fields:
        names.append(_free(members[name].name, {*taken, *names}))
    fields = tuple(
        (name, members[of]) for name, of in zip(names, how.fields, strict=True)
    )
    # Steps name their operands by index: the fields, then the numbers, then the results
    # of the steps before.
    row: list[Operand] = [*names, *how.numbers]
    statements = []
    for number, (operator, left, right) in enumerate(how.steps, 1):
        statements.append(
            Statement(_free(f"step_{number}", names), operator, row[left], row[right])
        )
        row.append(statements[-1].name)
    result = row[-1]
    assert isinstance(result, str)
    return DerivedComputation(fields, tuple(statements), result)


def _free(name: str, taken: Collection[str]) -> str:
    return _free(f"{name}_", taken) if name in taken else name
