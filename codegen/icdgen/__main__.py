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
    finally:
        gc.freeze()  # nor does it free anything that matters when the interpreter ends


def _was_printed(note: str) -> bool:
    """Whether the note, if there is one, could be printed; the way through `cli` knows what to say if not."""
    try:
        print(note, end="\n" if note else "", flush=True)
    except (OSError, ValueError):
        return False
    return True


if __name__ == "__main__":
    main()
