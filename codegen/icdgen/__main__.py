"""``icdgen`` on the command line. A build step that has nothing to do ends here, before anything heavy is imported."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Runs the command line and exits: 0 clean, 1 findings, 2 misuse."""
    from icdgen import memo

    arguments = sys.argv[1:]
    try:
        name = memo.key("run", os.getcwd(), *arguments)
        note = memo.holds("runs", name)
    except OSError:
        name, note = "", None
    if note is not None:
        print(note)
        sys.exit(0)
    from icdgen import cli

    cli.main(arguments, name)


if __name__ == "__main__":
    main()
