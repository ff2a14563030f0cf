"""Entry point of ``icdgen``. A build step without changes ends here, before any large module is imported."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Run the command line and exit: 0 success, 1 findings, 2 wrong usage, 130 interrupted."""
    try:
        _main()
    except KeyboardInterrupt:  # only while modules are imported; later `cli` handles it
        sys.exit(130)


def _main() -> None:
    """Print the note of a recorded run whose files are unchanged, or else run the command."""
    from icdgen import cache

    arguments = sys.argv[1:]
    try:
        name = cache.key("run", os.getcwd(), *arguments)
        note = cache.recall("runs", name)
    except OSError:
        name, note = "", None
    if note is not None and _was_printed(note.decode("utf-8", "surrogateescape")):
        sys.exit(0)
    import gc

    # A short run makes many small objects. The garbage collector doubles its time and
    # frees nothing.
    gc.disable()
    from icdgen import cli

    try:
        cli.main(arguments, name)
    except SystemExit as end:
        _leave(end.code)
        raise
    finally:
        # Otherwise the interpreter collects once more at its end.
        gc.freeze()


def _leave(status: object) -> None:
    """End a generation at once, without destroying all objects, which takes a thirtieth of a run.

    Only if no other code has to run at the end: a plug-in, a tracer, a profiler or a function registered with `atexit`.
    """
    import atexit

    is_plain_run = "icdgen.commands.generate" in sys.modules and "icdgen.backends.plug_in" not in sys.modules
    if not is_plain_run or not isinstance(status, int) or sys.gettrace() or sys.getprofile() or atexit._ncallbacks():
        return
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):
        return
    os._exit(status)


def _was_printed(note: str) -> bool:
    """Print a note; return whether that succeeded. If not, the run continues with `cli`, which reports the error."""
    try:
        print(note, end="\n" if note else "", flush=True)
    except (OSError, ValueError):
        return False
    return True


if __name__ == "__main__":
    main()
