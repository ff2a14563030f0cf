"""Shared parts of the commands: selection of the ICDs, options, and output of findings.

Without ICDs in the arguments, a command uses those of ``icdgen.toml``, and without a
configuration the ICDs that are shipped with icdgen (`chosen`).
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import click

from icdgen import config, reports, shipped
from icdgen.diagnostics import Finding
from icdgen.errors import UserError
from icdgen.icd.loaded import Loaded
from icdgen.reports.excerpt import printable
from icdgen.wording import listing

if TYPE_CHECKING:
    from icdgen.values.frame import DecodedFrame

Command = TypeVar("Command", bound=Callable[..., Any])


class _Path(click.Path):
    """Path argument.

    An empty path, for instance of an unset variable, is an error and not the current
    folder.
    """

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        if value == "":
            self.fail("the path is empty", param, ctx)
        return super().convert(value, param, ctx)


# Key in a click context: `Config` that selected the ICDs, if the user gave none
_CONFIG_KEY = "icdgen.config"
PATH = _Path(path_type=Path)


class _Seconds(click.FloatRange):
    """Duration in seconds, up to a day.

    The range check of click accepts `nan`, so the comparison is repeated here.
    """

    name = "seconds"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        seconds: float = click.FLOAT.convert(value, param, ctx)
        if not 0 <= seconds <= 86400:
            self.fail(f"{value} is not in the range 0<=x<=86400.", param, ctx)
        return seconds


SECONDS = _Seconds(0, 86400)


def known_languages() -> str:
    """Return the values of ``--lang``: built-in languages, then plug-ins with their
    packages.
    """
    from icdgen import backends

    named = ", ".join(backends.names())
    plug_in_names = []
    for name, points in backends.plug_ins().items():
        # Several packages can provide a language of the same name, which is an error
        # only if it is used.
        packages = dict.fromkeys(point.dist.name for point in points if point.dist)
        plug_in_names.append(f"{name} ({', '.join(packages)})")
    if plug_in_names:
        return f"{named}, and of other packages {', '.join(plug_in_names)}"
    return named


def say(text: str, err: bool = False) -> None:
    """Print lines that may contain names from an ICD, without their control characters."""
    # A name with escape sequences could otherwise control the terminal.
    click.echo("\n".join(printable(line) for line in text.split("\n")), err=err)


def icd_arguments(command: Command) -> Command:
    """Argument ``[ICD]...``: files or folders.

    The default is the ICDs in ``icdgen.toml``, otherwise the shipped ICDs.
    """
    return click.argument("icds", nargs=-1, metavar="[ICD]...", type=PATH)(command)


def icd_option(command: Command) -> Command:
    """Option ``--icd FILE`` (repeatable) of commands with other arguments."""
    text = "ICD file or folder (default: the ICDs in icdgen.toml, or the shipped ones)."
    return click.option("--icd", "icds", multiple=True, type=PATH, help=text)(command)


def kind_option(command: Command) -> Command:
    """Option ``--kind`` of commands that take the id of a message."""
    kinds = click.Choice(["telecommand", "telemetry", "configuration"])
    return click.option(
        "--kind", type=kinds, help="Kind of the message, if an id is ambiguous."
    )(command)


def format_option(*forms: str) -> Callable[[Command], Command]:
    """Option ``--format``; the first format is the default."""
    return click.option(
        "--format",
        "form",
        type=click.Choice(forms),
        default=forms[0],
        show_default=True,
    )


def print_frame(frame: DecodedFrame) -> None:
    """Print a frame as a table."""
    from icdgen import tables
    from icdgen.values.text import to_text

    click.echo(to_text(frame, tables.width_of(sys.stdout)), nl=False)


def chosen(
    icds: tuple[Path, ...], prefers_folder: bool = False
) -> tuple[list[Path], config.Config]:
    """Return the selected ICDs, relative to the current folder if possible, and the
    configuration.

    If ``icds`` is empty, the first of these sources with ICDs is selected: the
    configuration, the current folder (only with ``prefers_folder``), and the ICDs that
    are shipped with icdgen.
    """
    try:
        configuration = config.find(Path.cwd())
    except FileNotFoundError:
        raise UserError(
            "the current folder is no longer there", "change to another one"
        ) from None
    paths = list(icds) or configuration.icds
    if not paths and prefers_folder:
        from icdgen.icd.folders import icds_of_project

        paths = icds_of_project(Path.cwd())
    paths = paths or [shipped.icds()]
    # Functions of this module also run outside of a command, in tests.
    context = click.get_current_context(silent=True)
    if context is not None and not icds:
        context.meta[_CONFIG_KEY] = configuration
    return [_short(path) for path in paths], configuration


def say_default(paths: list[Path], verb: str) -> None:
    """Print to standard error which ICDs a command used that the user did not name."""
    context = click.get_current_context()
    configuration = context.meta.get(_CONFIG_KEY)
    if configuration is None or configuration.icds:
        return
    names = listing(str(path) for path in paths)
    if paths == [_short(shipped.icds())]:
        text = f"no ICD is in the current folder, so icdgen {verb} its shipped ICDs: {names}"
    else:
        text = f"{verb} {names}"
    command = context.command_path
    help = f"`{command} FILE` takes another one, as does `icds = [...]` in icdgen.toml"
    say(f"icdgen: {text}\n  help: {help}", err=True)


def beside_shipped(error: UserError, context: click.Context) -> UserError:
    """Return the error, with additional help if its node exists in the shipped ICDs."""
    from icdgen.values.errors import NotFound

    configuration = context.meta.get(_CONFIG_KEY)
    if configuration is None or not isinstance(error, NotFound):
        return error
    if not configuration.icds:
        # Only the help of an unknown node that resembles no other lists the nodes.
        if not error.help.startswith("nodes: "):
            return error
        return NotFound(
            str(error),
            f"{error.help}, which come with icdgen; name yours with --icd, or in icdgen.toml",
        )
    path = configuration.path
    for file in sorted(shipped.icds().glob("*.yaml")):
        # The message of the error names the missing node.
        if f"`{file.stem}`" in str(error).lower():
            return NotFound(
                f"{error}: it is a node that comes with icdgen; {_short(path)} does not name it",
                f"give `--icd {shipped.icds()}`, or add that folder to `icds` in {_short(path)}",
            )
    return error


def _short(path: Path) -> Path:
    """Return a path relative to the current folder if it is in it."""
    here = Path.cwd()
    if path.is_absolute() and path.is_relative_to(here):
        return path.relative_to(here)
    return path


def load_or_exit(icds: tuple[Path, ...]) -> Loaded:
    """Return the checked ICDs. Print the findings and exit with status 1 if one of them
    is an error.

    For commands that generate no code: name conflicts in generated code are not
    checked.
    """
    from icdgen.model_cache import load_checked

    return right_or_exit(load_checked(chosen(icds)[0], languages=()))


def right_or_exit(loaded: Loaded) -> Loaded:
    """Return the loaded ICDs.

    Print the findings and exit with status 1 if one of them is an error.
    """
    if not loaded.ok:
        print_findings(loaded.findings, loaded.texts, "text", err=True)
        sys.exit(1)
    return loaded


def in_colour(stream: TextIO | None) -> bool:
    """Return whether the output is a terminal with colors."""
    # See https://no-color.org
    return stream is not None and stream.isatty() and "NO_COLOR" not in os.environ


def write_file(path: Path, text: str, help: str) -> None:
    """Write a file completely or not at all; a symbolic link is preserved.

    Raises `UserError`.
    """
    from icdgen.generation.write import replace

    try:
        # Replacing the link itself would detach it from its target.
        replace(Path(os.path.realpath(path)), text.encode("utf-8"))
    except OSError as error:
        raise UserError(f"cannot write {path}: {error.strerror}", help) from None


def print_findings(
    findings: list[Finding], texts: dict[str, str], form: str, err: bool = False
) -> None:
    """Print findings in one of ``reports.FORMATS``."""
    # Commands with their own output print findings to standard error.
    stream = sys.stderr if err else sys.stdout
    colour = form == "text" and in_colour(stream)
    findings, texts = _where_named(findings, texts)
    report = reports.get(form)
    text = report(findings, texts, colour=True) if colour else report(findings, texts)
    click.echo(
        text, err=err, nl=bool(text) and not text.endswith("\n"), color=colour or None
    )


def _where_named(
    findings: list[Finding], texts: dict[str, str]
) -> tuple[list[Finding], dict[str, str]]:
    """Return findings and texts.

    For an unreadable ICD that ``icdgen.toml`` names, the place is the entry in
    ``icdgen.toml``.
    """
    context = click.get_current_context(silent=True)
    configuration: config.Config | None = None
    if context is not None:
        configuration = context.meta.get(_CONFIG_KEY)
    if configuration is None or configuration.path is None:
        return findings, texts
    file = str(_short(configuration.path))
    places = {
        str(_short(icd)): configuration.place_of(icd)._replace(file=file)
        for icd in configuration.icds
    }
    placed_findings = []
    for finding in findings:
        name = finding.place.file
        # A file with a text was read: its findings have places in it.
        if name in places and name not in texts:
            finding = finding._replace(
                message=f"`{name}`: {finding.message}", place=places[name]
            )
            texts = {**texts, file: configuration.text}
        placed_findings.append(finding)
    return placed_findings, texts
