"""How long `icdgen import` takes on a definition, and C of what it makes of it, how much memory, and how both grow.

    python bench/definitions.py FILE ... [--times 1 2 4]

With --times a DBC is enlarged first: all its messages again, with other ids and names. Seconds are the processor's,
memory is that of the process.
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
    r'^(\s*(?:BO_|VAL_|SIG_VALTYPE_|SG_MUL_VAL_|CM_ (?:BO_|SG_)|BA_ "\w+" (?:BO_|SG_)) )(\d+)', re.MULTILINE
)
_NAME = re.compile(r"^(\s*BO_ \d+ \w+?)(?=\s*:)", re.MULTILINE)
_EXTENDED = 1 << 31


def enlarged(text: str, times: int) -> str:
    """A DBC with all its messages so many times."""
    parts = [text]
    for number in range(1, times):
        high = _EXTENDED | number << 24
        again = _OF_ID.sub(lambda one, high=high: f"{one[1]}{high | int(one[2]) & 0xFFFFFF}", text)  # type: ignore[misc]
        lines = _NAME.sub(rf"\g<1>_{number}", again).split("\n")
        parts.append("\n".join(one for one in lines if re.match(r"\s*(BO_|SG_|VAL_) ", one)))
    return "\n\n".join(parts)


def measured(*words: object) -> str:
    """What a command of `icdgen` takes; it may exit with 1, which says that something is not held."""
    environment = {**os.environ, "ICDGEN_CACHE": "off"}
    command = [sys.executable, "-m", "icdgen", *map(str, words)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(command)}: exit status {process.returncode}")
    return f"{usage.ru_utime + usage.ru_stime:6.1f} s, {usage.ru_maxrss / 1024:5.0f} MB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--times", type=int, nargs="+", default=[1])
    options = parser.parse_args()
    for path in options.files:
        for times in options.times:
            with tempfile.TemporaryDirectory() as folder:
                file = path
                if times > 1:
                    file = Path(folder, path.name)
                    file.write_text(enlarged(path.read_text(encoding="latin-1"), times), encoding="latin-1")
                read = measured("import", file, "--out", f"{folder}/icd")
                texts = (
                    "\n" + one.read_text().partition("\nmessages:\n")[2] for one in Path(folder, "icd").glob("*.yaml")
                )
                messages = sum(text.count("\n  - name: ") for text in texts)
                print(f"{path.name} x{times}: import {read}", end="", flush=True)
                print(f"; check {measured('check', f'{folder}/icd')}", end="", flush=True)
                made = measured("--lang", "c", "--out", f"{folder}/c", f"{folder}/icd")
                print(f"; C {made}; {messages} messages held", flush=True)


if __name__ == "__main__":
    main()
