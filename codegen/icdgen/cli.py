"""Options in, one call, result out. Commands live in ``commands``; each is imported when it is named."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from keyword import iskeyword

import click

from icdgen import __version__
from icdgen.errors import UserError
from icdgen.reports.excerpt import shown
from icdgen.suggest import close_words

# Commands as `--help` groups them. Each is a module in ``icdgen.commands`` with a click command of the same name; the module
# of `import` is `import_`, as that is a keyword of Python.
_GROUPS = {
    "Describe a device": ("init", "check", "fmt", "show", "rule", "units", "schema"),
    "Generate": ("generate", "docs"),
    "Import and compare": ("import", "diff"),
    "Frames and logs": ("decode", "encode", "log"),
    "Talk to a device": ("sim", "monitor", "send"),
}
_COMMANDS = tuple(name for names in _GROUPS.values() for name in names)
_DEFAULT = "generate"
_FOLDERS = ("--cmake-dir", "--examples-dir")
_WHOLE = 10_000  # characters of a sentence


class _Commands(click.Group):
    """A group whose default command is ``generate``, so that a build step reads ``icdgen --lang c``."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in _COMMANDS:
            return None
        python = f"{name}_" if iskeyword(name) else name
        command: click.Command = getattr(import_module(f"icdgen.commands.{python}"), python)
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and args[0] not in (*_COMMANDS, "--help", "-h", "--version", *_FOLDERS):
            _refuse_mistyped(args[0])
            args = [_DEFAULT, *args]
        return super().parse_args(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the complete first sentence of each command: click cuts it off at the width of the terminal."""
        for title, names in _GROUPS.items():
            commands = ((name, self.get_command(ctx, name)) for name in names)
            rows = [(name, command.get_short_help_str(_WHOLE)) for name, command in commands if command is not None]
            with formatter.section(title):
                formatter.write_dl(rows)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        from icdgen.commands.common import known_languages

        formatter.write_paragraph()
        formatter.write_text(f"Languages: {known_languages()}.")
        super().format_epilog(ctx, formatter)

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except UserError as error:
            from icdgen.commands.common import beside_shipped

            raise beside_shipped(error, ctx) from None
        except BrokenPipeError:  # click would say 1, which means findings
            ctx.exit(141)


def _refuse_mistyped(word: str) -> None:
    """A word that is no option, and no file or folder, was meant as a command, and not as an ICD."""
    if not word.isidentifier() or os.path.lexists(word):
        return
    close = close_words(word, _COMMANDS)
    meant = "did you mean " + " or ".join(f"`{name}`" for name in close) + "?" if close else ""
    raise UserError(f"`{word}` is neither a command nor a file", meant or "`icdgen --help` lists the commands")


def _folder(name: str, what: str, place: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """The option that says where what is shipped lies, as the function ``place`` of `icdgen.shipped` knows."""

    def show(ctx: click.Context, option: click.Parameter, wanted: bool) -> None:
        if wanted:
            from icdgen import shipped

            click.echo(getattr(shipped, place)().as_posix())  # as CMake takes paths everywhere
            ctx.exit()

    help = f"Show the folder of {what}, and exit."
    return click.option(name, is_flag=True, expose_value=False, is_eager=True, callback=show, help=help)


@click.group(
    cls=_Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    epilog="`icdgen --lang c` is short for `icdgen generate --lang c`. `icdgen COMMAND --help` shows the options of a command "
    "and an example. Exit status: 0 success, 1 findings, 2 wrong usage.",
)
@click.version_option(__version__, prog_name="icdgen")
@_folder("--cmake-dir", "the CMake module, for CMAKE_MODULE_PATH", "cmake")
@_folder("--examples-dir", "the example programs and ICDs", "examples")
@click.pass_context
def icdgen(ctx: click.Context) -> None:
    """Generate code, golden vectors and documentation from checked ICDs of devices."""
    if ctx.invoked_subcommand is None:
        _generate_or_help(ctx)


def _generate_or_help(ctx: click.Context) -> None:
    """Generate what icdgen.toml names; without languages there, print the help and exit with the status of wrong usage."""
    from icdgen.commands.common import chosen

    command = icdgen.get_command(ctx, _DEFAULT)
    if command is not None and chosen(())[1].lang:
        ctx.invoke(command)
        return
    click.echo(ctx.get_help())
    ctx.exit(2)


def main(arguments: list[str], run: str = "") -> None:
    """Runs a command line and exits. ``run`` names the record under which a generation may be remembered."""
    try:
        _show_anything()
        status = _run(arguments, run)
    except UserError as error:
        status = _complain(str(error), error.help)
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        help = f"`{context.command_path} --help` lists the options" if context else ""
        status = _complain(error.format_message(), help)
    except (click.Abort, KeyboardInterrupt):
        _complain("interrupted")
        status = 130
    except BrokenPipeError:
        status = 141
    except OSError as error:
        place = error.filename or "the output cannot be written"
        status = _complain(f"{place}: {error.strerror}", "check the path and the free space of the disk")
    except RecursionError:
        status = _complain("the input is nested too deeply", "an ICD needs five levels, icdgen.toml two")
    except MemoryError:
        status = _complain("out of memory")
    if status != 0:
        _drop_unwritten_output()
    sys.exit(status)


def _show_anything() -> None:
    """Characters that the terminal's encoding lacks are shown as escapes. Raises OSError if the output is broken already."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _run(arguments: list[str], run: str) -> int:
    try:
        status = icdgen.main(arguments, prog_name="icdgen", standalone_mode=False, obj={"run": run})
    except SystemExit as end:
        status = end.code
    if sys.stdout is not None:
        sys.stdout.flush()
    return status if isinstance(status, int) else 0


def _drop_unwritten_output() -> None:
    """What could not be written is not tried again, with a traceback, when Python ends."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        sys.stdout = None


def _complain(message: str, help: str = "") -> int:
    """Says what is wrong, if there is anybody left to tell; the status of misuse."""
    lines = [f"icdgen: error: {line}" for line in message.split("\n")]
    lines += [f"  help: {line}" for line in help.split("\n") if line]
    with suppress(OSError):
        click.echo("\n".join(map(shown, lines)), err=True)
    return 2
