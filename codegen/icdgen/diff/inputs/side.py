"""Side of a comparison: its ICDs, its label, and the texts that its places refer to.

Files of a git revision are loaded from a temporary folder; the side replaces the path
of this folder in places and messages by the revision.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Finding, Place
from icdgen.diff.inputs.git import Spec
from icdgen.errors import UserError
from icdgen.icd.loaded import Loaded
from icdgen.icd.model import Icd
from icdgen.loading import load

# Reading errors: the model of the ICD is incomplete
_READING = ("ICD001", "ICD002", "ICD003", "ICD004", "ICD010")


@dataclass
class ComparisonSide:
    """Side of a comparison.

    ``label``: name as given by the user. ``folder``: temporary folder of the files;
    reported places omit it.
    """

    label: str
    icd: Icd
    findings: list[Finding] = field(default_factory=list)
    texts: dict[str, str] = field(default_factory=dict)
    folder: str = ""
    prefix: str = ""  # replacement of `folder` in places: "v1.2:"

    def is_comparable(self, unchecked: bool = False) -> bool:
        """Return whether the ICDs can be compared: valid, or with ``unchecked`` at
        least readable.
        """
        errors = [finding for finding in self.findings if finding.severity == "error"]
        return not any(not unchecked or finding.code in _READING for finding in errors)

    def place(self, place: Place | None) -> Place | None:
        """Return the place in the file as the user named it."""
        if place is None or not place.file:
            return None
        return place if not self.folder else place._replace(file=self.name(place.file))

    def name(self, file: str) -> str:
        """Return the name of the file as the user named it."""
        return (
            self.prefix + file.removeprefix(self.folder)
            if self.folder and file.startswith(self.folder)
            else file
        )


def from_paths(paths: list[Path], unchecked: bool = False) -> ComparisonSide:
    """Return the side of ICD files and folders."""
    return _side(", ".join(map(str, paths)), load(paths, check=not unchecked))


def from_git(spec: Spec, unchecked: bool = False) -> ComparisonSide:
    """Return the side of the ICDs of a git revision.

    Raises `UserError`.
    """
    # Includes and errata are found by paths, so the loader needs real files.
    with tempfile.TemporaryDirectory(prefix="icdgen-diff-") as name:
        # Findings contain resolved paths; on macOS the temporary folder is a symbolic
        # link.
        folder = os.path.realpath(name)
        paths = spec.extract(Path(folder))
        if not paths:
            what = " ".join(map(str, spec.paths)) or "the folder"
            raise UserError(
                f"{spec.revision} has no ICD in {what}",
                "name another path: REVISION:PATH",
            )
        loaded = load(paths, check=not unchecked)
    side = _side(spec.label, loaded)
    # From here on, the side shows the revision in place of the temporary folder.
    side.folder, side.prefix = folder + os.sep, f"{spec.revision}:"
    side.findings = [
        finding._replace(
            place=side.place(finding.place) or finding.place,
            message=finding.message.replace(side.folder, side.prefix),
            help=finding.help.replace(side.folder, side.prefix),
        )
        for finding in side.findings
    ]
    side.texts = {side.name(file): text for file, text in side.texts.items()}
    return side


def _side(label: str, loaded: Loaded) -> ComparisonSide:
    return ComparisonSide(label, loaded.icd, loaded.findings, loaded.texts)
