"""Python: with the interpreter that runs the tests, and with the oldest that is supported, where it is there."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

from tests.conformance.build import BuildError
from tests.conformance.languages import Language


def build(source: Path, out: Path, interpreter: str) -> list[str]:
    """Nothing is built: the package is run from its source."""
    found = sorted((source / "python").rglob("testee.py"), key=lambda path: len(path.parts))
    if not found:
        raise BuildError("the Python package has no testee.py")
    package = found[0].parent
    return [
        "env",
        f"PYTHONPATH={package.parent}",
        "PYTHONDONTWRITEBYTECODE=1",
        interpreter,
        "-m",
        f"{package.name}.testee",
    ]


LANGUAGES = [
    Language("python", ("python",), (), partial(build, interpreter=sys.executable)),
    Language("python3.9", ("python",), ("python3.9",), partial(build, interpreter="python3.9")),
]
