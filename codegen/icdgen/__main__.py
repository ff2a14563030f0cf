"""``icdgen`` on the command line. A build step that has nothing to do ends here, before anything heavy is imported."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Runs the command line and exits: 0 clean, 1 findings, 2 misuse."""
    try:
        _main()
    except KeyboardInterrupt:  # while modules are still being loaded; later `cli` says more
        sys.exit(130)


def _main() -> None:
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

    gc.disable()  # a short run that makes many small objects: the collector doubles its time and frees nothing
    from icdgen import cli

    try:
        cli.main(arguments, name)
    except SystemExit as end:
        _leave(end.code)
        raise
    finally:
        gc.freeze()  # nor does it free anything that matters when the interpreter ends


def _leave(status: object) -> None:
    """Ends a generation at once: its files are written, and to take Python apart, object by object, is a thirtieth of a run.

    Not where others may still have something to do: a plug-in, or whoever traces the run or asked to be called at its end.
    """
    import atexit

    ours = "icdgen.commands.generate" in sys.modules and "icdgen.backends.plug_in" not in sys.modules
    if not ours or not isinstance(status, int) or sys.gettrace() or sys.getprofile() or atexit._ncallbacks():
        return
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):
        return
    os._exit(status)


def _was_printed(note: str) -> bool:
    """Whether the note, if there is one, could be printed; the way through `cli` knows what to say if not."""
    try:
        print(note, end="\n" if note else "", flush=True)
    except (OSError, ValueError):
        return False
    return True


if __name__ == "__main__":
    main()
