"""ICDs as XTCE and back: what `icdgen import` reads of the file that is generated is
compared with the ICD that it was made of.
"""

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
class Compared:
    """``differences`` are lines for people; ``notes`` what files say that XTCE has no
    word for.
    """

    nodes: int = 0
    messages: int = 0
    fields: int = 0
    differences: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def write(icd: Icd, out: Path) -> dict[str, Path]:
    """The files of a set of ICDs, by the names of their nodes."""
    backend, found = XtceBackend(), {}
    for name, text in backend.files(icd, Renderer.of_backend(backend)):
        found[name.stem] = out / name
        (out / name).write_text(text, encoding="utf-8")
    return found


def compare(icds: list[Path], out: Path, into: Compared) -> None:
    """Generates XTCE of ICDs into a folder, and reads it back."""
    loaded = load(icds)
    assert loaded.ok, [one.message for one in loaded.findings]
    for name, file in write(loaded.icd, out).items():
        node = loaded.icd.node(name)
        into.nodes += 1
        into.notes += [
            f"{name}: {one.text}"
            for one in ElementTree.parse(file).iterfind(f".//{SPACE}Note")
        ]
        ours = messages(loaded.icd, node)
        into.messages += len({name for _, name in ours})
        into.fields += sum(len(one["fields"]) for one in ours.values())
        into.differences += [
            f"{name}: {one}" for one in _differences(ours, read_back(file, out))
        ]


def read_back(file: Path, out: Path) -> dict[tuple[str, str], dict]:
    """What is said by a file, as `messages` gives it; nothing where it has no messages."""
    try:
        read = run.read(file, xtce.Xtce())
    except Findings as error:
        assert "none is defined" in error.findings[0].message, error.findings[0].message
        return {}
    (tree,) = read.trees.values()
    path = out / f"{file.stem}.yaml"
    path.write_text(json.dumps(tree), encoding="utf-8")  # JSON is YAML
    loaded = load([path])
    assert loaded.ok, [one.message for one in loaded.findings]
    node: Node = loaded.icd.nodes[0]
    return messages(loaded.icd, node)


def _differences(ours: dict, theirs: dict) -> list[str]:
    found = [
        f"{' '.join(key)} is {'new' if key in theirs else 'gone'}"
        for key in ours.keys() ^ theirs.keys()
    ]
    for key in ours.keys() & theirs.keys():
        found += _unlike(" ".join(key), ours[key], theirs[key])
    return sorted(found)


def _unlike(where: str, one: dict, other: dict) -> list[str]:
    found = []
    for key in one.keys() | other.keys():
        mine, its = one.get(key), other.get(key)
        if key == "fields" or (where.endswith(" fields") and mine and its):
            found += _unlike(f"{where} {key}", mine, its)
        elif mine != its:
            found.append(f"{where} {key}: {mine} became {its}")
    return found
