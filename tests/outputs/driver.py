"""Run command lines of the icdgen on the import path and write digests of their
outputs.

python driver.py COMMANDS.json DIGESTS.json PART PARTS

This file has no imports from the repository, because it runs with the sources of other
revisions.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path


def digests_of(arguments: list[str]) -> dict[str, str]:
    """Run one command in a process of its own.

    Return digests by output file, and of the text and the exit status.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        out, text = folder / "out", folder / "text"
        # A command can change global state, and a fork is faster than a new process.
        child = os.fork()
        if not child:
            _run([argument.replace("{out}", str(out)) for argument in arguments], text)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        digests = {
            "status": str(status),
            "text": _digest(text.read_bytes().replace(str(out).encode(), b"OUT")),
        }
        for path in sorted(out.rglob("*")) if out.exists() else ():
            if path.is_file():
                digests[str(path.relative_to(out))] = _digest(path.read_bytes())
        shutil.rmtree(out, ignore_errors=True)
        return digests


def _run(arguments: list[str], text: Path) -> None:
    """Run a command in this process, with standard output and error in a file.

    Never returns.
    """
    stream = os.open(text, os.O_WRONLY | os.O_CREAT)
    os.dup2(stream, 1)
    os.dup2(stream, 2)
    from icdgen import cli

    try:
        cli.main(arguments)
    except SystemExit as end:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)
    except BaseException:
        import traceback

        traceback.print_exc()
        sys.stderr.flush()
    # EX_SOFTWARE of sysexits.h: icdgen itself failed.
    os._exit(70)


def _digest(content: bytes) -> str:
    """SHA-256 of an output, with the version of icdgen left out."""
    from icdgen import __version__

    return hashlib.sha256(
        re.sub(re.escape(__version__.encode()), b"VERSION", content)
    ).hexdigest()


def main() -> None:
    commands, digests, part, parts = sys.argv[1:]
    # Both revisions would otherwise share cached models.
    os.environ["ICDGEN_CACHE"] = "off"
    from icdgen import (  # noqa: F401
        cli,
    )

    results = {}
    for number, (name, arguments) in enumerate(
        json.loads(Path(commands).read_text("utf-8"))
    ):
        if number % int(parts) == int(part):
            results[name] = digests_of(arguments)
    Path(digests).write_text(json.dumps(results), "utf-8")


if __name__ == "__main__":
    main()
