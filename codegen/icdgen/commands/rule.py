"""Command ``icdgen rule``: the explanation of a rule of ICDs or of the diff."""

from __future__ import annotations

import click

from icdgen.errors import UserError


@click.command(epilog="Example: icdgen rule ICD055")
@click.argument("code", required=False)
def rule(code: str | None) -> None:
    """Explain the rule CODE with examples; without CODE, list all rules of ICDs,
    comparisons and imports.
    """
    from icdgen.diff import rule as of_changes
    from icdgen.diff.compare import RULES
    from icdgen.icd import rules
    from icdgen.importer import findings

    if code is None:
        # The three kinds of rules have separate registries.
        titles = [(icd_rule.code, icd_rule.title) for icd_rule in rules.ALL.values()]
        titles += [(diff_rule.code, diff_rule.title) for diff_rule in RULES.values()]
        titles += [(name, page.title) for name, page in findings.pages().items()]
        for rule_code, title in titles:
            click.echo(f"{rule_code}  {title}")
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
