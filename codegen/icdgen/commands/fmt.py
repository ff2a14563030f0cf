"""``icdgen fmt``"""

from __future__ import annotations

import sys
from pathlib import Path

import click

from icdgen.commands.common import chosen, icd_arguments, print_findings
from icdgen.diagnostics import Findings
from icdgen.errors import UserError


@click.command()
@icd_arguments
@click.option("--check", is_flag=True, help="Write nothing; exit 1 and name the files that are not in the canonical layout.")
def fmt(icds, check) -> None:
    """Write ICD files and errata overlays in the canonical layout; comments are kept."""
    from icdgen.generation.write import replace
    from icdgen.icd.fmt import format_text

    status = 0
    for path in _files(chosen(icds)[0]):
        try:
            text = path.read_bytes().decode("utf-8")
            formatted = format_text(text, str(path))
        except OSError as error:
            raise UserError(f"{path}: {error.strerror}", "check the path") from None
        except UnicodeDecodeError:
            from icdgen.icd import source

            try:
                source.read(path)
            except Findings as error:
                print_findings(error.findings, {}, "text", err=True)
            status = 1
            continue
        except Findings as error:
            print_findings(error.findings, {str(path): text}, "text", err=True)
            status = 1
            continue
        if formatted == text:
            continue
        if check:
            status = 1
            click.echo(f"{path}: not in the canonical layout")
            continue
        try:
            replace(path, formatted.encode("utf-8"))
        except OSError as error:
            raise UserError(f"cannot write {path}: {error.strerror}") from None
        click.echo(f"{path}: formatted")
    sys.exit(status)


def _files(paths: list[Path]) -> list[Path]:
    found: list[Path] = []
    for path in paths:
        found += sorted([*path.glob("*.yaml"), *path.glob("errata/*.yaml")]) if path.is_dir() else [path]
    return found
