"""A measurement as a file for the verification package."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.backends.assurance.measured import FORMAT, icd_digest
from icdgen.backends.assurance.pack import code_now
from icdgen.icd.model import Icd
from tests.conformance.languages import version


@dataclass
class MeasurementFile:
    """The result of a command.

    ``remarks`` are paragraphs of the page. ``language`` is the language of the code.
    ``tools`` are the programs whose versions are recorded.
    """

    name: str
    title: str
    remarks: Sequence[str]
    language: str
    command: str
    tools: Sequence[str]
    columns: Sequence[str]
    rows: list[Sequence[object]]
    facts: list[tuple[str, str]] = field(default_factory=list)

    def write(self, icd: Icd, folder: Path) -> Path:
        """Write ``NAME.json`` and return its path."""
        data = {
            "icdgen_measurement": FORMAT, "name": self.name, "title": self.title, "says": list(self.remarks),
            "icd": icd_digest(icd), "code": {self.language: code_now(icd, self.language)},
            "made_by": [self.command, *map(_version, self.tools)], "facts": self.facts,
            "columns": list(self.columns), "rows": [[str(cell) for cell in row] for row in self.rows],
        }  # fmt: skip
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{self.name}.json"
        path.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", "utf-8")
        return path


def _version(tool: str) -> str:
    """Return the first line of the version of a tool, without the path of the tool."""
    text, path = version(tool), shutil.which(tool)
    assert text is not None and path is not None, f"{tool} is not installed"
    return text.removeprefix(path).strip().split("\n")[0]


def share(done: int, of: int) -> str:
    """Return ``12,345 of 12,345 (100.00 %)``; the percentage is never rounded up to
    100.
    """
    hundredths = 10_000 if not of else 10_000 * done // of
    return f"{done:,} of {of:,} ({hundredths // 100}.{hundredths % 100:02} %)"


def total(rows: Iterable[Sequence[object]], column: int) -> int:
    """Return the sum of a column of numbers."""
    return sum(int(str(row[column])) for row in rows)
