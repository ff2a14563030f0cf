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
    # Fingerprint of each file and folder that was read, or that was absent.
    inputs: dict[Path, str]
    # Text of each file, by its name in findings, for excerpts.
    texts: dict[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Whether no finding is an error."""
        return not any(f.severity == "error" for f in self.findings)
