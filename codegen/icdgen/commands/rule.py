"""``icdgen rule``"""

from __future__ import annotations

import click

from icdgen.errors import UserError


@click.command()
@click.argument("code", required=False)
def rule(code) -> None:
    """Explain a rule with a wrong and a right example; without CODE, list all rules."""
    from icdgen.icd import rules

    if code is None:
        for one in rules.ALL.values():
            click.echo(f"{one.code}  {one.title}")
        return
    if code.upper() not in rules.ALL:
        raise UserError(f"there is no rule {code}", "`icdgen rule` lists them all")
    click.echo(rules.explain(code.upper()))
