"""``icdgen rule``"""

from __future__ import annotations

import click

from icdgen.errors import UserError


@click.command()
@click.argument("code", required=False)
def rule(code: str | None) -> None:
    """Explain a rule with examples; without CODE, list all rules: of ICDs (ICD...), of their changes (DIF...) and of
    importing manuals (IMP...)."""
    from icdgen.diff import rule as of_changes
    from icdgen.diff.compare import RULES
    from icdgen.icd import rules
    from icdgen.importer import findings

    if code is None:
        for one in (*rules.ALL.values(), *RULES.values()):
            click.echo(f"{one.code}  {one.title}")
        for name, page in findings.pages().items():
            click.echo(f"{name}  {page.title}")
        return
    code = code.upper()
    if code in rules.ALL:
        click.echo(rules.explain(code))
    elif code in RULES:
        click.echo(of_changes.explain(code))
    elif code in findings.pages():
        click.echo(findings.explain(code))
    else:
        raise UserError(f"there is no rule {code}", "`icdgen rule` lists them all")
