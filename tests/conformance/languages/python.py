"""Python: with the interpreter that runs the tests, and with the oldest supported one
if it is installed.
"""

from __future__ import annotations

import shutil
import sys
from functools import partial
from pathlib import Path

from tests.conformance.languages import Language

BACKENDS = ("python", "python-testee")


def build(source: Path, out: Path, interpreter: str) -> list[str]:
    """Return the command line. The package runs from its source, with the testee copied
    into it.
    """
    shutil.copytree(source / "python-testee", source / "python", dirs_exist_ok=True)
    package = next((source / "python").glob("*/_testee.py")).parent
    return [
        "env",
        f"PYTHONPATH={package.parent}",
        "PYTHONDONTWRITEBYTECODE=1",
        interpreter,
        "-m",
        f"{package.name}._testee",
    ]


LANGUAGES = [
    Language("python", BACKENDS, (), partial(build, interpreter=sys.executable)),
    Language(
        "python3.9", BACKENDS, ("python3.9",), partial(build, interpreter="python3.9")
    ),
]
