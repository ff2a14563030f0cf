"""The outcome of loading ICDs."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Finding
from icdgen.icd.model import Icd


@dataclass(eq=False, repr=False)
class Loaded:
    """``icd`` holds what could be built; it is whole only if no finding is an error."""

    icd: Icd
    findings: list[Finding]
    inputs: dict[Path, str]  # each file and folder read, or looked for and absent -> its fingerprint when read
    texts: dict[str, str] = field(default_factory=dict)  # file name as in findings -> its text, for excerpts

    @property
    def ok(self) -> bool:
        return not any(f.severity == "error" for f in self.findings)
