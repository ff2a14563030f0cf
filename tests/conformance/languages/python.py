"""Python: with the interpreter that runs the tests, and with the oldest that is
supported, where it is there.
"""

from __future__ import annotations

import shutil
import sys
from functools import partial
from pathlib import Path

from tests.conformance.languages import Language

BACKENDS = ("python", "python-testee")


def build(source: Path, out: Path, interpreter: str) -> list[str]:
    """Nothing is built: the package is run from its source, with the testee laid over
    it.
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
