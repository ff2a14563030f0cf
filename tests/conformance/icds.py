"""The ICDs under test and their test vectors."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.vectors.make import make_vectors
from icdgen.vectors.write import vector_file_text
from tests.conformance import ROOT

SHIPPED = ROOT / "icd"
LINKS = ROOT / "tests" / "conformance" / "links"
COMMITTED = ROOT / "generated" / "vectors"


def icd_of(paths: list[Path] | None = None) -> Icd:
    """Return the checked ICDs of ``paths``, by default those of the repository. Raises
    `ValueError` with the findings.
    """
    loaded = load(paths or [SHIPPED])
    if not loaded.ok:
        raise ValueError(
            "\n".join(
                f"{f.place}: {f.code} {f.message}"
                for f in loaded.findings
                if f.severity == "error"
            )
        )
    return loaded.icd


@cache
def shipped() -> Icd:
    """Return the ICDs of the project with errata applied."""
    return read_unchecked(SHIPPED)


def read_unchecked(*paths: Path) -> Icd:
    """Read ICDs without applying the rules, because some tests use invalid ones."""
    loaded = load(list(paths), check=False)
    assert not loaded.findings, loaded.findings
    return loaded.icd


def vectors_of(icd: Icd) -> dict[str, dict]:
    """Generate the content of each node's vector file."""
    return {
        node.name: json.loads(vector_file_text(make_vectors(icd, node)))
        for node in icd.nodes
    }


def read_vectors(folder: Path) -> dict[str, dict]:
    """Read the vector files of a folder, by node."""
    files = (
        json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("*.json"))
    )
    return {data["node"]: data for data in files if "icdgen_vectors" in data}
