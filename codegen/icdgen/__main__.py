"""Entry point of ``icdgen``.

A build step without changes ends here, before any large module is imported.
"""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Run the command line and exit: 0 success, 1 findings, 2 wrong usage, 130
    interrupted.
    """
    try:
        _main()
    except KeyboardInterrupt:  # only while modules are imported; later `cli` handles it
        sys.exit(130)


def _main() -> None:
    """Print the note of a recorded run whose files are unchanged, or else run the
    command.
    """
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
    finally:
        # Otherwise the interpreter collects once more at its end, which takes a tenth
        # of the run.
        gc.freeze()


def _was_printed(note: str) -> bool:
    """Print a note; return whether that succeeded.

    If not, the run continues with `cli`, which reports the error.
    """
    try:
        print(note, end="\n" if note else "", flush=True)
    except (OSError, ValueError):
        return False
    return True


if __name__ == "__main__":
    main()
