"""Command ``icdgen fmt``: write ICDs in the canonical layout (`icdgen.icd.fmt`).

`fmt` takes files or folders; the errata files next to the ICDs of a folder belong to
them. It overwrites each file whose layout differs. With ``--check`` it writes nothing,
and the exit status is 1 if a file differs. Files that cannot be parsed remain
unchanged.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from icdgen.commands.common import (
    chosen,
    icd_arguments,
    print_findings,
    say,
    say_default,
    write_file,
)
from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from icdgen.wording import count


@click.command(epilog="Example: icdgen fmt icd/")
@icd_arguments
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing; name the files that are not in the canonical layout and exit with 1.",
)
def fmt(icds: tuple[Path, ...], check: bool) -> None:
    """Write ICDs and errata files in the canonical layout; comments are preserved.

    Without arguments, these are the ICDs of icdgen.toml; else the ICD files in the
    current folder, and its folder icd; else the ICDs that come with icdgen.
    """
    from icdgen.icd import source
    from icdgen.icd.fmt import format_text

    status = changed = unchanged = 0
    paths = chosen(icds, prefers_folder=True)[0]
    for path in _files(paths):
        text = ""
        try:
            data = source.contents(path, str(path))
            text = data.decode("utf-8", "replace")
            # Formatting must not replace invalid bytes silently.
            if text.encode("utf-8") != data:
                # Raises a finding that shows the invalid byte
                source.parse(data, str(path))
            formatted = format_text(text, str(path))
        except Findings as error:
            print_findings(
                error.findings, {str(path): text} if text else {}, "text", err=True
            )
            status = 1
            continue
        if formatted == text:
            unchanged += 1
            continue
        changed += 1
        if check:
            status = 1
            say(f"{path}: not in the canonical layout")
            continue
        write_file(path, formatted, "make it writable, or use --check")
        say(f"{path}: formatted")
    if changed or unchanged:
        say(_summary(changed, unchanged, check))
    say_default(paths, "checked" if check else "formatted")
    sys.exit(status)


def _summary(changed: int, unchanged: int, check: bool) -> str:
    """Count of files per outcome: ``1 file formatted, 2 files unchanged``."""
    outcomes = {
        "not in the canonical layout" if check else "formatted": changed,
        "unchanged": unchanged,
    }
    parts = [
        f"{count(number, 'file')} {outcome}"
        for outcome, number in outcomes.items()
        if number
    ]
    return ", ".join(parts)


def _files(paths: list[Path]) -> list[Path]:
    """Return the named files; for a folder, its ICDs with their errata overlays."""
    from icdgen.icd import folders

    files_to_format: list[Path] = []
    for path in paths:
        if not os.path.isdir(path):
            files_to_format.append(path)
            continue
        result = folders.search(path)
        homes = {icd.parent for icd in result.icds}
        # Errata overlays next to an ICD belong to it, even if the folder search skips
        # them.
        errata = [overlay for home in homes for overlay in home.glob("errata/*.yaml")]
        files = sorted({*result.icds, *result.overlays, *errata})
        if not files:
            raise UserError(f"{path} has no ICD", "name another folder, or a file")
        files_to_format += files
    return files_to_format
