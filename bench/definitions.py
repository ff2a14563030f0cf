"""Measure time and memory of `icdgen import` for definition files, of the check, and of
the generated C code.

Usage::

    python bench/definitions.py FILE ... [--times 1 2 4]

With --times, a DBC file is enlarged first: its messages are repeated with other ids and
names. Times are processor times; memory is the maximum of the process.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

_OF_ID = re.compile(
    r'^(\s*(?:BO_|VAL_|SIG_VALTYPE_|SG_MUL_VAL_|CM_ (?:BO_|SG_)|BA_ "\w+" (?:BO_|SG_)) )(\d+)',
    re.MULTILINE,
)
_NAME = re.compile(r"^(\s*BO_ \d+ \w+?)(?=\s*:)", re.MULTILINE)
_EXTENDED = 1 << 31


def enlarged(text: str, times: int) -> str:
    """Return a DBC file with all its messages repeated."""
    parts = [text]
    for number in range(1, times):
        high = _EXTENDED | number << 24
        repeated = _OF_ID.sub(
            lambda match, high=high: f"{match[1]}{high | int(match[2]) & 0xFFFFFF}",
            text,
        )  # type: ignore[misc]
        lines = _NAME.sub(rf"\g<1>_{number}", repeated).split("\n")
        parts.append(
            "\n".join(line for line in lines if re.match(r"\s*(BO_|SG_|VAL_) ", line))
        )
    return "\n\n".join(parts)


def measured(*words: object) -> str:
    """Return time and memory of an `icdgen` command.

    Exit status 1 is permitted: the command reports omissions.
    """
    environment = {**os.environ, "ICDGEN_CACHE": "off"}
    command = [sys.executable, "-m", "icdgen", *map(str, words)]
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(command)}: exit status {process.returncode}")
    return f"{usage.ru_utime + usage.ru_stime:6.1f} s, {usage.ru_maxrss / 1024:5.0f} MB"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--times", type=int, nargs="+", default=[1])
    options = parser.parse_args()
    for path in options.files:
        for times in options.times:
            with tempfile.TemporaryDirectory() as folder:
                file = path
                if times > 1:
                    file = Path(folder, path.name)
                    file.write_text(
                        enlarged(path.read_text(encoding="latin-1"), times),
                        encoding="latin-1",
                    )
                read = measured("import", file, "--out", f"{folder}/icd")
                texts = (
                    "\n" + path_of_icd.read_text().partition("\nmessages:\n")[2]
                    for path_of_icd in Path(folder, "icd").glob("*.yaml")
                )
                messages = sum(text.count("\n  - name: ") for text in texts)
                print(f"{path.name} x{times}: import {read}", end="", flush=True)
                print(
                    f"; check {measured('check', f'{folder}/icd')}", end="", flush=True
                )
                generated = measured(
                    "--lang", "c", "--out", f"{folder}/c", f"{folder}/icd"
                )
                print(f"; C {generated}; {messages} messages held", flush=True)


if __name__ == "__main__":
    main()
