"""Result of loading ICDs."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Finding
from icdgen.icd.model import Icd


@dataclass(eq=False, repr=False)
class Loaded:
    """Result of loading ICDs. The model is complete only if no finding is an error."""

    icd: Icd
    findings: list[Finding]
    inputs: dict[Path, str]  # fingerprint of each file and folder that was read, or that was absent
    texts: dict[str, str] = field(default_factory=dict)  # text of each file, by its name in findings, for excerpts

    @property
    def ok(self) -> bool:
        """Whether no finding is an error."""
        return not any(f.severity == "error" for f in self.findings)
