"""Command line of icdgen.

The commands are modules of ``icdgen.commands``, each imported only when it is used.
`main` runs a list of arguments, prints errors with their help to standard error, and
ends the process with the exit status. Arguments without the name of a command belong to
``generate``. ``__main__`` calls `main`, unless it can repeat the note of an equal run.
"""

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
from icdgen.suggest import close_words, question

# Commands in the groups of `--help`. Each is a module of ``icdgen.commands`` with a
# click command of the same name. The module of `import` is `import_`, because `import`
# is a keyword of Python.
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
_UNLIMITED = 10_000  # characters of a sentence in `--help`


class _Commands(click.Group):
    """A group whose default command is ``generate``, so that a build step reads
    ``icdgen --lang c``.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import a command; return None if there is no such command."""
        if name not in _COMMANDS:
            return None
        python = f"{name}_" if iskeyword(name) else name
        command: click.Command = getattr(
            import_module(f"icdgen.commands.{python}"), python
        )
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse arguments; insert the default command unless they begin with a command
        or an option of the group.
        """
        if args and args[0] not in (*_COMMANDS, "--help", "-h", "--version", *_FOLDERS):
            _refuse_mistyped(args[0])
            args = [_DEFAULT, *args]
        return super().parse_args(ctx, args)

    def format_commands(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        """Write the commands in groups, with the complete first sentence of each.

        Click would truncate it.
        """
        for title, names in _GROUPS.items():
            commands = ((name, self.get_command(ctx, name)) for name in names)
            rows = [
                (name, command.get_short_help_str(_UNLIMITED))
                for name, command in commands
                if command is not None
            ]
            with formatter.section(title):
                formatter.write_dl(rows)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the available languages and the epilog."""
        from icdgen.commands.common import known_languages

        formatter.write_paragraph()
        formatter.write_text(f"Languages: {known_languages()}.")
        super().format_epilog(ctx, formatter)

    def invoke(self, ctx: click.Context) -> object:
        """Run the command.

        Errors get the context of the shipped ICDs; a closed pipe has the exit status of
        SIGPIPE.
        """
        try:
            return super().invoke(ctx)
        except UserError as error:
            from icdgen.commands.common import beside_shipped

            raise beside_shipped(error, ctx) from None
        except BrokenPipeError:  # click would exit with 1, which means findings
            ctx.exit(141)


def _refuse_mistyped(word: str) -> None:
    """Raise `UserError` for a first argument that looks like a command but is neither a
    command nor a file or folder.
    """
    if not word.isidentifier() or os.path.lexists(word):
        return
    help = question(close_words(word, _COMMANDS))
    help = help or "`icdgen --help` lists the commands"
    raise UserError(f"`{word}` is neither a command nor a file", help)


def _folder(
    name: str, what: str, place: str
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return an option that prints a shipped folder and exits.

    ``place`` is a function of `icdgen.shipped`.
    """

    def show(ctx: click.Context, option: click.Parameter, is_set: bool) -> None:
        if is_set:
            from icdgen import shipped

            # CMake expects slashes, also on Windows
            click.echo(getattr(shipped, place)().as_posix())
            ctx.exit()

    help = f"Show the folder of {what}, and exit."
    # Eager: it is evaluated before arguments that would be errors.
    return click.option(
        name, is_flag=True, expose_value=False, is_eager=True, callback=show, help=help
    )


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
    """Generate the languages of icdgen.toml; if it names none, print the help and exit
    with status 2.
    """
    from icdgen.commands.common import chosen

    command = icdgen.get_command(ctx, _DEFAULT)
    if command is not None and chosen(())[1].lang:
        ctx.invoke(command)
        return
    click.echo(ctx.get_help())
    ctx.exit(2)


def main(arguments: list[str], run: str = "") -> None:
    """Run a command line and exit.

    ``run`` is the name of the cache record of this command line.
    """
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
        status = 130  # 128 + SIGINT, as shells report it
    except BrokenPipeError:
        status = 141  # 128 + SIGPIPE
    except OSError as error:
        place = error.filename or "the output cannot be written"
        status = _complain(
            f"{place}: {error.strerror}",
            "check the path and the free space of the disk",
        )
    except RecursionError:
        status = _complain(
            "the input is nested too deeply",
            "an ICD needs five levels, icdgen.toml two",
        )
    except MemoryError:
        status = _complain("out of memory")
    if status != 0:
        _drop_unwritten_output()
    sys.exit(status)


def _show_anything() -> None:
    """Make the standard streams print escapes for characters that the encoding of the
    terminal lacks.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A name from an ICD such as `I²C` must not end a command on a terminal in
            # ASCII.
            stream.reconfigure(errors="backslashreplace")


def _run(arguments: list[str], run: str) -> int:
    """Run a command line; return its exit status."""
    try:
        # Otherwise click prints errors in a form of its own and exits.
        status = icdgen.main(
            arguments, prog_name="icdgen", standalone_mode=False, obj={"run": run}
        )
    except SystemExit as end:
        status = end.code
    if sys.stdout is not None:
        sys.stdout.flush()
    return status if isinstance(status, int) else 0


def _drop_unwritten_output() -> None:
    """Discard output that cannot be written.

    Otherwise Python tries again at its end and prints a traceback.
    """
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        sys.stdout = None


def _complain(message: str, help: str = "") -> int:
    """Print an error and its help, unless the error stream is closed; return the exit
    status 2.
    """
    lines = [f"icdgen: error: {line}" for line in message.split("\n")]
    lines += [f"  help: {line}" for line in help.split("\n") if line]
    with suppress(OSError):
        click.echo("\n".join(map(shown, lines)), err=True)
    return 2
