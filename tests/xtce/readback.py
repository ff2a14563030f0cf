"""Generates XTCE from ICDs, imports it again, and compares the result with the ICDs."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.backends.xtce import XtceBackend
from icdgen.definitions import run, xtce
from icdgen.diagnostics import Findings
from icdgen.icd.model import Icd, Node
from icdgen.loading import load
from icdgen.render import Renderer
from tests.xtce.meaning import messages

SPACE = "{http://www.omg.org/spec/XTCE/20180204}"


@dataclass
class Comparison:
    """Counts and results of a comparison.

    ``differences`` are lines for people; ``notes`` are the remarks in the files about
    parts that XTCE cannot represent.
    """

    nodes: int = 0
    messages: int = 0
    fields: int = 0
    differences: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def write(icd: Icd, out: Path) -> dict[str, Path]:
    """Write the files of a set of ICDs and return them by the names of their nodes."""
    backend, files = XtceBackend(), {}
    for name, text in backend.files(icd, Renderer.of_backend(backend)):
        files[name.stem] = out / name
        (out / name).write_text(text, encoding="utf-8")
    return files


def compare(icds: list[Path], out: Path, into: Comparison) -> None:
    """Generate XTCE of ICDs into a folder, import it and add the result to ``into``."""
    loaded = load(icds)
    assert loaded.ok, [finding.message for finding in loaded.findings]
    for name, file in write(loaded.icd, out).items():
        node = loaded.icd.node(name)
        into.nodes += 1
        into.notes += [
            f"{name}: {note.text}"
            for note in ElementTree.parse(file).iterfind(f".//{SPACE}Note")
        ]
        ours = messages(loaded.icd, node)
        into.messages += len({name for _, name in ours})
        into.fields += sum(len(message["fields"]) for message in ours.values())
        into.differences += [
            f"{name}: {difference}"
            for difference in _differences(ours, read_back(file, out))
        ]


def read_back(file: Path, out: Path) -> dict[tuple[str, str], dict]:
    """Return the messages of a file, as `messages` does of an ICD; empty if it has
    none.
    """
    try:
        read = run.read(file, xtce.Xtce())
    except Findings as error:
        # A node without messages has a file without containers.
        assert "none is defined" in error.findings[0].message, error.findings[0].message
        return {}
    (tree,) = read.trees.values()
    path = out / f"{file.stem}.yaml"
    path.write_text(json.dumps(tree), encoding="utf-8")  # JSON is YAML
    loaded = load([path])
    assert loaded.ok, [finding.message for finding in loaded.findings]
    node: Node = loaded.icd.nodes[0]
    return messages(loaded.icd, node)


def _differences(ours: dict, theirs: dict) -> list[str]:
    differences = [
        f"{' '.join(key)} is {'new' if key in theirs else 'gone'}"
        for key in ours.keys() ^ theirs.keys()
    ]
    for key in ours.keys() & theirs.keys():
        differences += _unlike(" ".join(key), ours[key], theirs[key])
    return sorted(differences)


def _unlike(where: str, ours: dict, theirs: dict) -> list[str]:
    differences = []
    for key in ours.keys() | theirs.keys():
        old, new = ours.get(key), theirs.get(key)
        if key == "fields" or (where.endswith(" fields") and old and new):
            differences += _unlike(f"{where} {key}", old, new)
        elif old != new:
            differences.append(f"{where} {key}: {old} became {new}")
    return differences
