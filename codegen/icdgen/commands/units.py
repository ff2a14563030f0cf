"""Command ``icdgen units``: the built-in units."""

from __future__ import annotations

import sys

import click


@click.command(epilog="Example: icdgen units")
def units() -> None:
    """List the built-in units; declare others in the ICD under `units:`."""
    from icdgen import tables
    from icdgen.icd.units import SPELLINGS, STANDARD

    # SPELLINGS lists notations that the check rejects, with their correct symbol.
    spellings: dict[str, list[str]] = {}
    for spelling, symbol in SPELLINGS.items():
        spellings.setdefault(symbol, []).append(spelling)
    columns = [
        tables.Column(title) for title in ("unit", "in names", "quantity", "not")
    ]
    rows = [
        (u.symbol, u.identifier, u.quantity, ", ".join(spellings.get(u.symbol, [])))
        for u in STANDARD.values()
    ]
    click.echo(
        tables.render_table(columns, rows, tables.width_of(sys.stdout)), nl=False
    )
