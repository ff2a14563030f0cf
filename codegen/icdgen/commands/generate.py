"""Command ``icdgen generate``, also available as ``icdgen --lang ...``.

`icdgen.generation.generate` does the work; this module prints what was written.
`generate` combines the options with ``icdgen.toml`` to a `Job` and runs it. With
``--check`` it writes no file, and exits with 1 and a short diff if files are outdated.
After a successful run, `remember` stores the note that an equal command line prints.
"""

from __future__ import annotations

import sys
from pathlib import Path

import click

from icdgen.backends.packages import of_project
from icdgen.commands import progress
from icdgen.commands.common import (
    PATH,
    chosen,
    icd_arguments,
    known_languages,
    print_findings,
    say,
)
from icdgen.errors import UserError
from icdgen.generation.generate import GenerationOutcome, Job, remember, run


class _Languages(click.Option):
    """Option ``--lang``. It searches plug-ins only when the help is displayed."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        # The search imports the entry points of all installed packages.
        self.help = f"What to generate: {known_languages()}. Repeatable."
        return super().get_help_record(ctx)


@click.command(
    epilog="Example: icdgen --lang c --lang python --out generated icd/wheels.yaml"
)
@icd_arguments
@click.option("--lang", "-l", "languages", multiple=True, cls=_Languages)
@click.option(
    "--out", "-o", type=PATH, help="Folder to write to (default: generated/LANG)."
)
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing; exit 1 with a short diff if the output is not current.",
)
@click.option("--depfile", type=PATH, help="Also write a Make/Ninja dependency file.")
@click.option(
    "--templates",
    type=PATH,
    help="Folder of templates that replace shipped ones of the same name.",
)
@click.option(
    "--measured",
    type=PATH,
    help="Folder of measurements that go into the pack of `--lang assurance`.",
)
@click.option("--quiet", "-q", is_flag=True, help="Print nothing on success.")
@click.pass_obj
def generate(
    obj: dict[str, str],
    icds: tuple[Path, ...],
    languages: tuple[str, ...],
    out: Path | None,
    check: bool,
    depfile: Path | None,
    templates: Path | None,
    measured: Path | None,
    quiet: bool,
) -> None:
    """Generate code from ICDs: files or folders (default: the ICDs in icdgen.toml, or
    the shipped ones).
    """
    paths, config = chosen(icds)
    packages = of_project(config)
    languages_to_generate = list(languages) or config.lang
    if not languages_to_generate:
        raise UserError(
            "no language to generate",
            "for instance `icdgen --lang c`; or set `lang` in icdgen.toml",
        )
    if out is None:
        base = config.out or Path("generated")
        is_single = len(set(languages_to_generate)) == 1
        # A single language has its own folder; several languages get subfolders of
        # `base`.
        out = base / languages_to_generate[0] if is_single else base
    what = ", ".join(dict.fromkeys(languages_to_generate))
    with progress.items(what, "files") as watch:
        job = Job(
            languages=languages_to_generate,
            out=out,
            icds=paths,
            templates=templates or config.templates,
            depfile=depfile,
            check=check,
            measured=measured,
            packages=packages,
            configs=config.looked_at,
            watch=watch,
        )
        outcome = run(job)
    if outcome.loaded.findings:
        print_findings(outcome.loaded.findings, outcome.loaded.texts, "text", err=True)
    if not outcome.loaded.ok:
        sys.exit(1)
    if check and outcome.changes:
        from icdgen.generation.differences import short_diff

        say(short_diff(outcome.plans).rstrip("\n"))
        sys.exit(1)
    for plan in outcome.plans:
        for name in plan.edited:
            path = plan.out / name
            text = f"{path} is no longer generated, but was edited: kept"
            say(f"icdgen: warning: {text}", err=True)
    note = "" if quiet else _summary(job, outcome)
    if note:
        say(note)
    # The next run of the same command line then ends before it imports the generator.
    if not check or not outcome.changes:
        remember(
            (obj or {}).get("run", ""),
            "" if quiet else _current(job, outcome),
            job,
            outcome,
        )


def _summary(job: Job, outcome: GenerationOutcome) -> str:
    """Return the numbers of written and removed files in words."""
    written = sum(len(plan.write) for plan in outcome.plans)
    removed = sum(len(plan.remove) for plan in outcome.plans)
    if not written and not removed:
        return _current(job, outcome)
    total = sum(len(plan.files) for plan in outcome.plans)
    counts = f"{written} of {total} files written"
    if removed:
        counts += f", {removed} removed"
    languages = ", ".join(plan.language for plan in outcome.plans)
    return f"{job.out}: {counts} ({languages})"


def _current(job: Job, outcome: GenerationOutcome) -> str:
    total = sum(len(plan.files) for plan in outcome.plans)
    return f"{job.out}: all {total} files are current ({', '.join(plan.language for plan in outcome.plans)})"
