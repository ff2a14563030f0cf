"""Load and check small ICDs that tests give as text."""

from __future__ import annotations

import re
from pathlib import Path

from icdgen.diagnostics import Finding
from icdgen.icd.loaded import Loaded
from icdgen.loading import load

HEAD = (
    "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
)

_FILE = re.compile(r"^# ([a-z_/]+\.yaml)\n", re.MULTILINE)


def status(*fields: str, length: int = 2) -> str:
    """Return a message `Status` with these fields, each the inside of a flow mapping."""
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    head = f"messages:\n  - name: Status\n    id: 130\n    kind: telemetry\n    length: {length}\n"
    return head + (f"    fields:\n{rows}" if fields else "")


def write(folder: Path, text: str) -> Path:
    """Write ``demo.yaml``, and further files that start with a line such as ``#
    errata/demo.yaml``.
    """
    main, *parts = _FILE.split(text)
    path = folder / "demo.yaml"
    path.write_text(
        main if main.startswith("icdgen:") else HEAD + main, encoding="utf-8"
    )
    for name, content in zip(parts[0::2], parts[1::2], strict=True):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(content, encoding="utf-8")
    return path


def loaded(folder: Path, text: str) -> Loaded:
    """Load the text, with the further files next to ``demo.yaml``."""
    beside = [folder / name for name in _FILE.findall(text) if "/" not in name]
    return load([write(folder, text), *beside])


def findings(folder: Path, text: str) -> list[Finding]:
    """Return the findings of the text."""
    return loaded(folder, text).findings


def codes(folder: Path, text: str) -> list[str]:
    """Return the codes of the findings of the text, in order."""
    return [f.code for f in findings(folder, text)]
