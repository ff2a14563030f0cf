"""Print the commands of Markdown pages as one shell script, in the order of the pages.

Usage::

    bash <(python3 scripts/page_commands.py README.md)

The program needs only Python's standard library, so that it runs on a bare machine. The
script stops at the first failing command. Before each command it prints a line with
MARK and the number of the command.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

MARK = "@@@"
_BLOCK = re.compile(r"^```(console|sh)\n(.*?)^```", re.MULTILINE | re.DOTALL)


class Step(NamedTuple):
    """Command of a page with the shown output."""

    command: str
    shown: str


def steps(page: str) -> Iterator[Step]:
    """Yield the commands of the `sh` and `console` blocks of a page; only `console`
    blocks show output.
    """
    for language, block in _BLOCK.findall(page):
        # A line of an `sh` block that ends in a backslash goes on in the next one.
        parts = (
            re.split(r"(?<!\\)\n", block)
            if language == "sh"
            else re.split(r"^\$ ", block, flags=re.MULTILINE)
        )
        for part in filter(str.strip, parts):
            command, _, shown = (
                (part, "", "") if language == "sh" else part.partition("\n")
            )
            command = re.sub(r"(?:^|\s+)# .*", "", command).strip()
            if command:
                yield Step(command, shown.strip())


def script(commands: list[str]) -> str:
    """Return a shell script that runs the commands in one shell."""
    lines = ["set -e"]
    for number, command in enumerate(commands):
        lines += [f"echo '{MARK} {number}'", command]
        if command.endswith("&"):
            lines.append("sleep 3")  # until the server listens
    return "\n".join([*lines, f"echo '{MARK} {len(commands)}'"]) + "\n"


def main() -> None:
    pages = "".join(Path(name).read_text("utf-8") for name in sys.argv[1:])
    print(script([step.command for step in steps(pages)]), end="")


if __name__ == "__main__":
    main()
