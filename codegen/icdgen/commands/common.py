"""What several commands share: which ICDs are meant, and how findings are printed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import click

from icdgen import config, shipped
from icdgen.diagnostics import Finding
from icdgen.errors import UserError
from icdgen.icd.loaded import Loaded
from icdgen.reports.excerpt import printable

if TYPE_CHECKING:
    from icdgen.values.frame import Frame

Command = TypeVar("Command", bound=Callable[..., Any])


class _Path(click.Path):
    """A path; an empty one, such as an unset variable gives, is not the current folder."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("the path is empty", param, ctx)
        return super().convert(value, param, ctx)


_MEANT = "icdgen.meant"  # of a click context: the `Config` that says whose nodes are meant, as no ICD was given
PATH = _Path(path_type=Path)


class _Seconds(click.FloatRange):
    """Seconds, up to a day. That neither `nan` nor `inf` is a time, click's range does not notice."""

    name = "seconds"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        seconds: float = click.FLOAT.convert(value, param, ctx)
        if not 0 <= seconds <= 86400:
            self.fail(f"{value} is not in the range 0<=x<=86400.", param, ctx)
        return seconds


SECONDS = _Seconds(0, 86400)


def known_languages() -> str:
    """The words for ``--lang``: ours, then those of plug-ins with their packages."""
    from icdgen import backends

    named = ", ".join(backends.names())
    others = []
    for name, points in backends.plug_ins().items():
        packages = dict.fromkeys(point.dist.name for point in points if point.dist)
        others.append(f"{name} ({', '.join(packages)})")
    return f"{named}, and of other packages {', '.join(others)}" if others else named


def say(text: str, err: bool = False) -> None:
    """Prints lines in which a name may stand, so that no name can act upon a terminal."""
    click.echo("\n".join(printable(line) for line in text.split("\n")), err=err)


def icd_arguments(command: Command) -> Command:
    """``[ICD]...``: files or folders; without them what ``icdgen.toml`` names, else the shipped ones."""
    return click.argument("icds", nargs=-1, metavar="[ICD]...", type=PATH)(command)


def icd_option(command: Command) -> Command:
    """``--icd FILE`` (repeatable), for commands whose arguments are something else."""
    text = "ICD file or folder (default: the ICDs in icdgen.toml, or the shipped ones)."
    return click.option("--icd", "icds", multiple=True, type=PATH, help=text)(command)


def kind_option(command: Command) -> Command:
    """``--kind``, for commands that take the id of a message."""
    kinds = click.Choice(["telecommand", "telemetry", "configuration"])
    return click.option("--kind", type=kinds, help="Kind of the message, if an id is ambiguous.")(command)


def format_option(*forms: str) -> Callable[[Command], Command]:
    """``--format``, the first unless another is asked for."""
    return click.option("--format", "form", type=click.Choice(forms), default=forms[0], show_default=True)


def print_frame(frame: Frame) -> None:
    """Prints it as a table."""
    from icdgen import tables
    from icdgen.values.text import to_text

    click.echo(to_text(frame, tables.width_of(sys.stdout)), nl=False)


def chosen(icds: tuple[Path, ...]) -> tuple[list[Path], config.Config]:
    """The ICDs to work on, relative to the current folder where they lie in it, and the configuration."""
    try:
        found = config.find(Path.cwd())
    except FileNotFoundError:
        raise UserError("the current folder is no longer there", "change to another one") from None
    paths = list(icds) or found.icds or [shipped.icds()]
    context = click.get_current_context(silent=True)
    if context is not None and not icds:
        context.meta[_MEANT] = found
    return [_short(path) for path in paths], found


def beside_shipped(error: UserError, context: click.Context) -> UserError:
    """The error; if it is about a node, and those of the ICDs that were not meant are looked at, one that says so."""
    from icdgen.values.errors import NotFound

    found = context.meta.get(_MEANT)
    if found is None or not isinstance(error, NotFound):
        return error
    if not found.icds:
        if not error.help.startswith("nodes: "):
            return error
        return NotFound(str(error), f"{error.help}, which come with icdgen; name yours with --icd, or in icdgen.toml")
    path = found.path
    for file in sorted(shipped.icds().glob("*.yaml")):
        if f"`{file.stem}`" in str(error).lower():
            return NotFound(
                f"{error}: it is a node that comes with icdgen; {_short(path)} does not name it",
                f"give `--icd {shipped.icds()}`, or add that folder to `icds` in {_short(path)}",
            )
    return error


def _short(path: Path) -> Path:
    here = Path.cwd()
    return path.relative_to(here) if path.is_absolute() and path.is_relative_to(here) else path


def load_or_exit(icds: tuple[Path, ...]) -> Loaded:
    """Return the checked ICDs; print the findings and exit with 1 if one is an error.

    For commands that generate no code: names that clash in a language are not looked for.
    """
    from icdgen.model_cache import load_checked

    return right_or_exit(load_checked(chosen(icds)[0], languages=()))


def right_or_exit(loaded: Loaded) -> Loaded:
    """What was loaded; prints what is wrong and exits with 1 if anything is."""
    if not loaded.ok:
        print_findings(loaded.findings, loaded.texts, "text", err=True)
        sys.exit(1)
    return loaded


def in_colour(stream: TextIO | None) -> bool:
    """Whether whoever reads the stream sees colours."""
    return stream is not None and stream.isatty() and "NO_COLOR" not in os.environ


def write_file(path: Path, text: str, help: str) -> None:
    """Writes a whole file or nothing; a link stays one. Raises `UserError`."""
    from icdgen.generation.write import replace

    try:
        replace(Path(os.path.realpath(path)), text.encode("utf-8"))
    except OSError as error:
        raise UserError(f"cannot write {path}: {error.strerror}", help) from None


def print_findings(findings: list[Finding], texts: dict[str, str], form: str, err: bool = False) -> None:
    """Prints a report in one of ``reports.FORMATS``."""
    from icdgen import reports

    stream = sys.stderr if err else sys.stdout
    colour = form == "text" and in_colour(stream)
    findings, texts = _where_named(findings, texts)
    report = reports.get(form)
    text = report(findings, texts, colour=True) if colour else report(findings, texts)
    click.echo(text, err=err, nl=bool(text) and not text.endswith("\n"), color=colour or None)


def _where_named(findings: list[Finding], texts: dict[str, str]) -> tuple[list[Finding], dict[str, str]]:
    """The findings and texts; of ICDs that ``icdgen.toml`` names and that could not be read, the place is that in it."""
    context = click.get_current_context(silent=True)
    found: config.Config | None = context.meta.get(_MEANT) if context is not None else None
    if found is None or found.path is None:
        return findings, texts
    file = str(_short(found.path))
    places = {str(_short(icd)): found.place_of(icd)._replace(file=file) for icd in found.icds}
    told = []
    for one in findings:
        name = one.place.file
        if name in places and name not in texts:
            one = one._replace(message=f"`{name}`: {one.message}", place=places[name])
            texts = {**texts, file: found.text}
        told.append(one)
    return told, texts
