"""Files -> checked model: reading, overlays, includes and rules in one call."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import fingerprints
from icdgen.diagnostics import Finding, Findings, Fix, Lines, Place, in_order
from icdgen.icd import errata, folders, source
from icdgen.icd.build import Builder, Scope
from icdgen.icd.loaded import Loaded
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Icd, Node, closure

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

INCLUDE = "ICD004"


def load(
    paths: list[Path], check: bool = True, languages: Sequence[Language] = (), unsaved: Mapping[Path, bytes] | None = None
) -> Loaded:  # fmt: skip
    """The ICDs of ``paths`` with all that they include; folders are searched with those below them. Never raises for bad input.

    Names must do for the ``languages``. ``unsaved``: contents of files that are not written yet, or differ from what is.
    """
    loader = _Loader({_resolved(path): data for path, data in (unsaved or {}).items()})
    for path in paths:
        for file in loader.folder(path) if os.path.isdir(path) else [path]:
            loader.node(file, ())
    icd = Icd(tuple(loader.nodes))
    findings = loader.findings
    if check and not loader.unreadable:
        from icdgen.icd import rules

        findings += rules.check(icd, loader.applied, not loader.broken, languages, loader.texts)
    return Loaded(icd, _with_sound_fixes(in_order(findings), loader.texts), loader.inputs, loader.texts)


def _with_sound_fixes(findings: list[Finding], texts: Mapping[str, str]) -> list[Finding]:
    """The findings without corrections of values that span lines: the place of such a value is its first character."""
    lines = {one.fix.place.file: Lines(texts[one.fix.place.file]) for one in findings if one.fix is not None}
    return [
        one if one.fix is None or _is_word(lines[one.fix.place.file], one.fix.place) else one._replace(fix=None)
        for one in findings
    ]


def _is_word(lines: Lines, place: Place) -> bool:
    """Whether what stands at a place ends with it."""
    behind = place._replace(column=place.column + place.length, length=1)
    return place.length > 1 or lines.marked(behind) in ("", *" \t,:]}")


class _Loader:
    def __init__(self, unsaved: Mapping[Path, bytes]) -> None:
        self.unsaved = unsaved
        self.nodes: list[Node] = []
        self.by_path: dict[Path, Node | None] = {}
        self.findings: list[Finding] = []
        self.inputs: dict[Path, str] = {}
        self.contents: dict[Path, bytes] = {}
        self.first: dict[Path, Path] = {}  # resolved path -> the path by which the file was read
        self.texts: dict[str, str] = {}
        self.applied: list[errata.Applied] = []
        self.broken: set[int] = set()
        self.trees: list[Map] = []  # kept alive: ``broken`` and the overlays go by identity
        self.unreadable = False

    def folder(self, path: Path) -> list[Path]:
        """The ICDs of a folder and of those below it."""
        result = folders.search(path)
        others = [*result.overlays, *result.others]
        for one in (*result.folders, *others):
            self.inputs[one] = fingerprints.of_path(str(one))
        if not result.is_complete:
            text = f"the folder has more than {folders.MOST_FOLDERS} folders below it"
            self.findings.append(Finding("ICD001", text, Place(str(path)), "name the folder of the ICDs"))
            self.unreadable = True
        elif not result.icds:
            text, help = (
                "the folder has no ICD: no file *.yaml in it, or in a folder below",
                "name another folder, or a file",
            )
            if others:
                text = f"the folder has no ICD: no file *.yaml has the key `icdgen`, `{others[0].name}` for instance"
                help = "name another folder or the file of an ICD, which begins with `icdgen: 1`"
            self.findings.append(Finding("ICD001", text, Place(str(path)), help))
            self.unreadable = True
        return result.icds

    def node(self, path: Path, stack: tuple[Path, ...]) -> Node | None:
        key = _resolved(path)
        if key in self.by_path:
            self.inputs[path] = self.inputs[self.first[key]]  # a link may lead elsewhere tomorrow
            return self.by_path[key]
        self.by_path[key], self.first[key] = None, path
        tree = self.read(path, "icd")
        if tree is None:
            return None
        included = self.include(tree, path, (*stack, key))
        beside = self.overlay_path(tree, path)
        overlay = self.overlay(beside)
        applied = errata.apply(tree, overlay, self.broken)
        if any(entry.changes for entry in applied.entries):
            self.check_structure(tree, "icd")  # what the overlay holds must fit the format too
        self.findings += applied.findings
        self.applied.append(applied)
        digest = hashlib.sha256(self.contents[path])
        digest.update(self.contents[beside] if beside is not None and overlay is not None else b"")
        for one in included:
            digest.update(one.digest.encode())
        names = tuple(dict.fromkeys(n.name for n in included))
        node = Builder(tree, applied, self.broken, Scope(closure(self.nodes, names))).node(names, digest.hexdigest())
        if node is not None:
            self.nodes.append(node)
        self.by_path[key] = node
        return node

    def read(self, path: Path, document: str) -> Map | None:
        """The tree of a file, its structure checked; None if it is not YAML at all."""
        name = str(path)
        self.inputs[path] = fingerprints.UNKNOWN
        try:
            unsaved = self.unsaved.get(_resolved(path))
            data = self.contents[path] = source.contents(path, name) if unsaved is None else unsaved
            self.inputs[path] = hashlib.sha256(data).hexdigest()
            self.texts[name] = data.decode("utf-8", "replace")
            tree, treacherous = source.parse_on(data, name)
        except Findings as error:
            self.findings += error.findings
            self.unreadable = True
            return None
        self.trees.append(tree)
        if document == "icd" and "errata" in tree and "icdgen" not in tree:
            text = "this is an errata overlay, not an ICD"
            self.findings.append(
                Finding("ICD010", text, tree.place, "name the ICD; icdgen finds its errata file in the same folder")
            )
            self.findings += treacherous
            self.unreadable = True
            return None
        self.check_structure(tree, document, treacherous)
        return tree

    def check_structure(self, tree: Map, document: str, ambiguous: Sequence[Finding] = ()) -> None:
        """Check the structure; the format decides whether an ``ambiguous`` word such as `yes` is a text or a truth value."""
        from icdgen.icd import remedies, schema

        lines = Lines(self.texts.get(tree.place.file, ""))
        findings, broken = schema.check(tree, document, lines)
        violations = {one.place: one for one in findings}
        for one in ambiguous:
            violation = violations.get(one.place)
            text = remedies.of_type("string", lines.marked(one.place)) if violation is None else ""
            fix = Fix(one.place, text) if text else violation.fix if violation else None
            self.findings.append(one._replace(fix=fix))
        places = {one.place for one in ambiguous}
        self.findings += (one for one in findings if one.place not in places)
        self.broken |= broken

    def overlay_path(self, tree: Map, path: Path) -> Path | None:
        head = tree.get("node")
        if not isinstance(head, Map) or id(head) in self.broken:
            return None
        return path.parent / "errata" / f"{head['name']}.yaml"

    def overlay(self, overlay: Path | None) -> Map | None:
        """The errata overlay at this place, if there is one."""
        if overlay is None:
            return None
        if _is_absent(overlay):
            self.inputs[overlay] = fingerprints.ABSENT
            return None
        return self.read(overlay, "errata")

    def include(self, tree: Map, path: Path, stack: tuple[Path, ...]) -> list[Node]:
        nodes: list[Node] = []
        items = tree.get("include")
        for item, place in items.placed() if isinstance(items, Seq) else ():
            if not isinstance(item, str):
                continue
            problem = self.include_problem(item, path, stack)
            if problem:
                self.findings.append(Finding(INCLUDE, problem[0], place, problem[1]))
                self.broken.add(id(tree))
                continue
            node = self.node(path.parent / item, stack)
            if node is not None:
                nodes.append(node)
        return nodes

    def include_problem(self, item: str, path: Path, stack: tuple[Path, ...]) -> tuple[str, str] | None:
        target = _resolved(path.parent / item)
        folder = _resolved(path.parent)
        if not target.is_relative_to(folder):
            return f"`{item}` is outside the folder of this file", "move it to the folder of this file or below"
        if target in stack:
            names = " -> ".join(p.name for p in (*stack[stack.index(target) :], target))
            return f"files include each other in a circle: {names}", "remove one `include`"
        if target not in self.unsaved and not os.path.isfile(target):
            return f"there is no file `{item}` beside this one", "check the name"
        return None


def _resolved(path: Path) -> Path:
    """Absolute and without links; unlike `Path.resolve` also for links that lead in a circle."""
    return Path(os.path.realpath(path))


def _is_absent(path: Path) -> bool:
    """Whether there is surely nothing; what can't be looked at, or is a link to nothing, is not absent."""
    try:
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return True
    except OSError:
        return False
    return False
