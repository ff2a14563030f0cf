"""Load ICDs: read files with their includes and errata overlays, build the model, and
check the rules.

`load` takes files or folders and returns a `Loaded`: model, findings, texts and
fingerprints of the files. Bad input gives findings, never an exception. The rules are
skipped if a file cannot be read. This module does not depend on the backends;
`icdgen.loading` passes it the languages whose names the rules check.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import fingerprints
from icdgen.diagnostics import Finding, Findings, Fix, Lines, Place, in_order
from icdgen.icd import errata, folders, source
from icdgen.icd.build import NodeBuilder, NodeScope
from icdgen.icd.loaded import Loaded
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Icd, Node, closure

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

INCLUDE = "ICD004"


def load(
    paths: list[Path], check: bool = True, languages: Sequence[Language] = (), unsaved: Mapping[Path, bytes] | None = None
) -> Loaded:  # fmt: skip
    """Load the ICDs of ``paths`` and the files that they include.

    Folders are searched with their subfolders.

    Bad input gives findings, never an exception. The rules about names check the names
    of the ``languages``. ``unsaved`` has the contents of files that are open in an
    editor and differ from the disk.
    """
    loader = _Loader({_resolved(path): data for path, data in (unsaved or {}).items()})
    for path in paths:
        for file in loader.icds_of_folder(path) if os.path.isdir(path) else [path]:
            loader.load_node(file, ())
    icd = Icd(tuple(loader.nodes))
    findings = loader.findings
    # With an unreadable file, the rules would report all that it declares as missing.
    if check and not loader.unreadable:
        from icdgen.icd import rules

        findings += rules.check(
            icd, loader.applied, not loader.broken, languages, loader.texts
        )
    return Loaded(
        icd,
        _with_sound_fixes(in_order(findings), loader.texts),
        loader.inputs,
        loader.texts,
    )


def _with_sound_fixes(
    findings: list[Finding], texts: Mapping[str, str]
) -> list[Finding]:
    """Return the findings, without the fixes of values that span several lines.

    The place of such a value is only its first character, so a fix would replace that
    and leave the other lines.
    """
    files = {finding.fix.place.file for finding in findings if finding.fix is not None}
    lines = {file: Lines(texts[file]) for file in files}
    sound: list[Finding] = []
    for finding in findings:
        if finding.fix is not None and not _is_word(
            lines[finding.fix.place.file], finding.fix.place
        ):
            finding = finding._replace(fix=None)
        sound.append(finding)
    return sound


def _is_word(lines: Lines, place: Place) -> bool:
    """Return whether a place covers a complete value of one line."""
    after = place._replace(column=place.column + place.length, length=1)
    # `place_of` gives a value of several lines the length 1, as a value of one
    # character has it. Only behind the latter the value ends.
    return place.length > 1 or lines.marked(after) in ("", *" \t,:]}")


class _Loader:
    """Reads files and collects nodes, findings and fingerprints."""

    def __init__(self, unsaved: Mapping[Path, bytes]) -> None:
        self.unsaved = unsaved
        self.nodes: list[Node] = []
        self.by_path: dict[Path, Node | None] = {}
        self.findings: list[Finding] = []
        self.inputs: dict[Path, str] = {}
        self.contents: dict[Path, bytes] = {}
        # Resolved path -> the path by which the file was read.
        self.first: dict[Path, Path] = {}
        self.texts: dict[str, str] = {}
        self.applied: list[errata.AppliedErrata] = []
        self.broken: set[int] = set()
        # References to all trees, because ``broken`` and `AppliedErrata.by_mapping` have the id() of
        # mappings, which could be reused.
        self.trees: list[Map] = []
        self.unreadable = False

    def icds_of_folder(self, path: Path) -> list[Path]:
        """Return the ICDs of a folder and its subfolders."""
        result = folders.search(path)
        other_files = [*result.overlays, *result.other_files]
        for examined in (*result.folders, *other_files):
            self.inputs[examined] = fingerprints.of_path(str(examined))
        if not result.is_complete:
            text = f"the folder has more than {folders.MOST_FOLDERS} folders below it"
            self.findings.append(
                Finding("ICD001", text, Place(str(path)), "name the folder of the ICDs")
            )
            self.unreadable = True
        elif not result.icds:
            text = "the folder has no ICD: no file *.yaml in it, or in a folder below"
            help = "name another folder, or a file"
            if other_files:
                name = other_files[0].name
                text = f"the folder has no ICD: no file *.yaml has the key `icdgen`, `{name}` for instance"
                help = "name another folder or the file of an ICD, which begins with `icdgen: 1`"
            self.findings.append(Finding("ICD001", text, Place(str(path)), help))
            self.unreadable = True
        return result.icds

    def load_node(self, path: Path, stack: tuple[Path, ...]) -> Node | None:
        """Load a file and its includes; return its node, or None if it cannot be built.

        ``stack`` has the files that include this one, the outermost first.
        """
        key = _resolved(path)
        if key in self.by_path:
            # Two paths can lead to one file. The cache checks both, because a link can
            # change.
            self.inputs[path] = self.inputs[self.first[key]]
            return self.by_path[key]
        # Before the includes: a file that includes itself, directly or not, ends here.
        self.by_path[key], self.first[key] = None, path
        tree = self.read_tree(path, "icd")
        if tree is None:
            return None
        included = self.load_includes(tree, path, (*stack, key))
        overlay_path = self.overlay_path(tree, path)
        overlay = self.read_overlay(overlay_path)
        applied = errata.apply(tree, overlay, self.broken)
        # Values of the overlay must conform to the schema, too.
        if any(entry.changes for entry in applied.entries):
            self.check_structure(tree, "icd")
        self.findings += applied.findings
        self.applied.append(applied)
        digest = hashlib.sha256(self.contents[path])
        digest.update(
            self.contents[overlay_path]
            if overlay_path is not None and overlay is not None
            else b""
        )
        for included_node in included:
            digest.update(included_node.digest.encode())
        names = tuple(dict.fromkeys(included_node.name for included_node in included))
        node = NodeBuilder(
            tree, applied, self.broken, NodeScope(closure(self.nodes, names))
        ).node(names, digest.hexdigest())
        if node is not None:
            self.nodes.append(node)
        self.by_path[key] = node
        return node

    def read_tree(self, path: Path, document: str) -> Map | None:
        """Read a file and check its structure; return its tree, or None if it is not
        valid YAML.
        """
        name = str(path)
        # Until the file is read: an unreadable file never counts as unchanged.
        self.inputs[path] = fingerprints.UNKNOWN
        try:
            unsaved = self.unsaved.get(_resolved(path))
            data = self.contents[path] = (
                source.contents(path, name) if unsaved is None else unsaved
            )
            self.inputs[path] = hashlib.sha256(data).hexdigest()
            self.texts[name] = data.decode("utf-8", "replace")
            tree, ambiguous = source.parse_with_findings(data, name)
        except Findings as error:
            self.findings += error.findings
            self.unreadable = True
            return None
        self.trees.append(tree)
        if document == "icd" and "errata" in tree and "icdgen" not in tree:
            text = "this is an errata overlay, not an ICD"
            self.findings.append(
                Finding(
                    "ICD010",
                    text,
                    tree.place,
                    "name the ICD; icdgen finds its errata file in the same folder",
                )
            )
            self.findings += ambiguous
            self.unreadable = True
            return None
        self.check_structure(tree, document, ambiguous)
        return tree

    def check_structure(
        self, tree: Map, document: str, ambiguous: Sequence[Finding] = ()
    ) -> None:
        """Check a tree against the schema.

        The type that the schema requires decides the fix of an ``ambiguous`` scalar,
        such as `yes`: quotes, or `true`.
        """
        from icdgen.icd import schema

        findings, broken = schema.check(tree, document, self.texts)
        violations = {finding.place: finding for finding in findings}
        if ambiguous:  # which is rare, and the module is large
            from icdgen.icd import remedies

            lines = Lines(self.texts.get(tree.place.file, ""))
        for finding in ambiguous:
            text = remedies.of_type("string", lines.marked(finding.place))
            fix = Fix(finding.place, text) if text else None
            self.findings.append(finding._replace(fix=fix))
        # Also earlier findings: the type of a value of an overlay is known only when it
        # has replaced the value of the ICD.
        places: set[Place] = set()
        for index, finding in enumerate(self.findings):
            if finding.code == source.AMBIGUOUS and finding.place in violations:
                fix = violations[finding.place].fix
                self.findings[index] = finding._replace(fix=fix)
                places.add(finding.place)
        self.findings += (
            finding for finding in findings if finding.place not in places
        )
        self.broken |= broken

    def overlay_path(self, tree: Map, path: Path) -> Path | None:
        """Return the path of the errata overlay of a file, `errata/NODE.yaml`; None if
        the name of the node is invalid.
        """
        head = tree.get("node")
        if not isinstance(head, Map) or id(head) in self.broken:
            return None
        return path.parent / "errata" / f"{head['name']}.yaml"

    def read_overlay(self, overlay: Path | None) -> Map | None:
        """Read an errata overlay; return None if there is no such file."""
        if overlay is None:
            return None
        if _is_absent(overlay):
            self.inputs[overlay] = fingerprints.ABSENT
            return None
        return self.read_tree(overlay, "errata")

    def load_includes(
        self, tree: Map, path: Path, stack: tuple[Path, ...]
    ) -> list[Node]:
        """Load the files that a file includes; return their nodes."""
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
            node = self.load_node(path.parent / item, stack)
            if node is not None:
                nodes.append(node)
        return nodes

    def include_problem(
        self, item: str, path: Path, stack: tuple[Path, ...]
    ) -> tuple[str, str] | None:
        """Return message and help if an include is not possible, else None."""
        target = _resolved(path.parent / item)
        folder = _resolved(path.parent)
        if not target.is_relative_to(folder):
            return (
                f"`{item}` is outside the folder of this file",
                "move it to the folder of this file or below",
            )
        if target in stack:
            names = " -> ".join(
                file.name for file in (*stack[stack.index(target) :], target)
            )
            return (
                f"files include each other in a circle: {names}",
                "remove one `include`",
            )
        if target not in self.unsaved and not os.path.isfile(target):
            return f"there is no file `{item}` beside this one", "check the name"
        return None


def _resolved(path: Path) -> Path:
    """Return the absolute path without links.

    Unlike `Path.resolve`, it does not raise for a cycle of links.
    """
    return Path(os.path.realpath(path))


def _is_absent(path: Path) -> bool:
    """Return whether a path certainly does not exist.

    Broken links and unreadable folders count as existing.
    """
    try:
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return True
    except OSError:
        return False
    return False
