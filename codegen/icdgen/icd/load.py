"""Files -> checked model: reading, overlays, includes and rules in one call."""

from __future__ import annotations

import hashlib
from pathlib import Path

from icdgen.diagnostics import Finding, Findings, in_order
from icdgen.icd import errata, source
from icdgen.icd.build import Builder, Scope
from icdgen.icd.loaded import Loaded
from icdgen.icd.model import Icd, Node
from icdgen.icd.tree import Map

INCLUDE = "ICD004"


def load(paths: list[Path], check: bool = True) -> Loaded:
    """The ICDs of ``paths`` (files, or folders of files) with all that they include. Never raises for bad input."""
    loader = _Loader()
    for path in paths:
        for file in sorted(path.glob("*.yaml")) if path.is_dir() else [path]:
            loader.node(file, ())
    icd = Icd(tuple(loader.nodes))
    findings = loader.findings
    if check and not loader.unreadable:
        from icdgen.icd import rules

        findings = findings + rules.check(icd, loader.applied, complete=not loader.broken)
    return Loaded(icd, in_order(findings), loader.inputs, loader.texts)


class _Loader:
    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.by_path: dict[Path, Node | None] = {}
        self.findings: list[Finding] = []
        self.inputs: dict[Path, bytes | None] = {}
        self.texts: dict[str, str] = {}
        self.applied: list[errata.Applied] = []
        self.broken: set[int] = set()
        self.trees: list[Map] = []  # kept alive: ``broken`` and the overlays go by identity
        self.unreadable = False

    def node(self, path: Path, stack: tuple[Path, ...]) -> Node | None:
        key = path.resolve()
        if key in self.by_path:
            return self.by_path[key]
        self.by_path[key] = None
        tree = self.read(path, "icd")
        if tree is None:
            return None
        included = self.include(tree, path, (*stack, key))
        overlay = self.overlay(tree, path)
        applied = errata.apply(tree, overlay, self.broken)
        if any(entry.changes for entry in applied.entries):
            self.check_structure(tree, "icd")  # what the overlay holds must fit the format too
        self.findings += applied.findings
        self.applied.append(applied)
        digest = hashlib.sha256(self.inputs[path])
        digest.update((self.inputs.get(self.overlay_path(tree, path)) if overlay else None) or b"")
        for one in included:
            digest.update(one.digest.encode())
        names = tuple(dict.fromkeys(n.name for n in included))
        node = Builder(tree, applied, self.broken, Scope(self.closure(included))).node(names, digest.hexdigest())
        if node is not None:
            self.nodes.append(node)
        self.by_path[key] = node
        return node

    def read(self, path: Path, document: str) -> Map | None:
        """The tree of a file, its structure checked; None if it is not YAML at all."""
        name = str(path)
        try:
            tree = source.read(path, name)
        except Findings as error:
            self.findings += error.findings
            self.unreadable = True
            self.remember(path, name)
            return None
        self.remember(path, name)
        self.trees.append(tree)
        if document == "icd" and "errata" in tree and "icdgen" not in tree:
            self.findings.append(
                Finding("ICD010", "this is an errata overlay, not an ICD", tree.place,
                        "name the ICD; its overlay is found beside it")
            )  # fmt: skip
            self.unreadable = True
            return None
        self.check_structure(tree, document)
        return tree

    def check_structure(self, tree: Map, document: str) -> None:
        from icdgen.icd import schema

        findings, broken = schema.check(tree, document)
        self.findings += findings
        self.broken |= broken

    def remember(self, path: Path, name: str) -> None:
        try:
            data = path.read_bytes() if path.stat().st_size <= source.MAX_BYTES else b""
        except OSError:
            data = None
        self.inputs[path] = data
        self.texts[name] = (data or b"").decode("utf-8", "replace")

    def overlay_path(self, tree: Map, path: Path) -> Path | None:
        head = tree.get("node")
        if not isinstance(head, Map) or id(head) in self.broken:
            return None
        return path.parent / "errata" / f"{head['name']}.yaml"

    def overlay(self, tree: Map, path: Path) -> Map | None:
        """The errata overlay beside the ICD, if there is one."""
        overlay = self.overlay_path(tree, path)
        if overlay is None:
            return None
        if not overlay.is_file():
            self.inputs[overlay] = None
            return None
        return self.read(overlay, "errata")

    def include(self, tree: Map, path: Path, stack: tuple[Path, ...]) -> list[Node]:
        nodes = []
        items = tree.get("include")
        for index, item in enumerate(items if isinstance(items, list) else ()):
            if not isinstance(item, str):
                continue
            place = items.items_at[index]
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
        target = (path.parent / item).resolve()
        folder = path.parent.resolve()
        if not target.is_relative_to(folder):
            return f"`{item}` lies outside the folder of this file", "move it beside this file or below"
        if target in stack:
            names = " -> ".join(p.name for p in (*stack[stack.index(target) :], target))
            return f"files include each other in a circle: {names}", "take one `include` out"
        if not target.is_file():
            return f"there is no file `{item}` beside this one", "check the name"
        return None

    def closure(self, nodes: list[Node]) -> list[Node]:
        names: set[str] = set()
        queue = [n.name for n in nodes]
        while queue:
            name = queue.pop()
            if name not in names:
                names.add(name)
                queue += next((n.includes for n in self.nodes if n.name == name), ())
        return [n for n in self.nodes if n.name in names]

