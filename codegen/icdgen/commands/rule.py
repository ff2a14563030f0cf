"""``icdgen rule``"""

from __future__ import annotations

import click

from icdgen.errors import UserError


@click.command()
@click.argument("code", required=False)
def rule(code: str | None) -> None:
    """Explain a rule with examples; without CODE, list all rules: of ICDs (ICD...) and of their changes (DIF...)."""
    from icdgen.icd import rules

    if code is None:
        from icdgen.diff.compare import RULES

        titles = [(one.code, one.title) for one in rules.ALL.values()]
        titles += [(one.code, one.title) for one in RULES.values()]
        for found, title in titles:
            click.echo(f"{found}  {title}")
        return
    code = code.upper()
    if code in rules.ALL:
        click.echo(rules.explain(code))
        return
    from icdgen.diff import rule
    from icdgen.diff.compare import RULES

    if code not in RULES:
        raise UserError(f"there is no rule {code}", "`icdgen rule` lists them all")
    click.echo(rule.explain(code))
