"""Reader of ICDs in git revisions. It leaves the working tree unchanged.

`Git` resolves arguments such as ``v1.2``, ``v1.2:icd/a.yaml`` and ``v1.2..HEAD`` into
`Spec` objects, which extract their files into a temporary folder.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path, PurePosixPath

from icdgen.errors import UserError
from icdgen.frozen import NamedTuple

USUAL = "icd"  # default folder of the ICDs of a project
_SUFFIX = ".yaml"
_FILES = ("100644", "100755")  # modes of regular files


class Spec(NamedTuple):
    """ICDs of a revision.

    ``paths`` are relative to the top folder of the repository.
    """

    revision: str
    paths: list[PurePosixPath]
    label: str = ""
    top: str = "."

    def extract(self, folder: Path) -> list[Path]:
        """Write the ICDs and other YAML files of their folders into a folder.

        Return the paths to load.
        """
        extracted = []
        for path in self.paths:
            kind = _run(
                "cat-file", "-t", f"{self.revision}:{_name(path)}", top=self.top
            ).strip()
            # Included ICDs are searched in the folder of a file, so the whole folder is
            # needed.
            home = path if kind == "tree" else path.parent
            _export(self.revision, home, folder, self.top)
            if kind:
                extracted.append(folder / path)
        return extracted


class Git:
    """Repository of the current folder, if it exists."""

    @cached_property
    def top(self) -> str:
        """Top folder; empty without a repository or without git."""
        return _run("rev-parse", "--show-toplevel").rstrip("\n")

    def commit(self, revision: str) -> str:
        """Return the commit of a revision; empty if it is invalid."""
        # A leading dash would be an option of git.
        if not revision or revision.startswith("-") or not self.top:
            return ""
        return _run(
            "rev-parse",
            "--verify",
            "--quiet",
            "--end-of-options",
            f"{revision}^{{commit}}",
        ).strip()

    def span(self, word: str) -> tuple[str, str] | None:
        """Return both ends of ``A..B`` or ``A...B`` (changes since B branched off A).

        A missing end is HEAD. None if the word is no range.
        """
        first, dots, second = word.partition("..")
        if not dots or ":" in word or not self.top:
            return None
        since = second.startswith(".")
        ends = [end or "HEAD" for end in (first, second.lstrip("."))]
        if not all(map(self.commit, ends)):
            bad = next(end for end in ends if not self.commit(end))
            raise UserError(
                f"git knows no revision {bad}",
                "`git log --oneline` and `git tag` list them",
            )
        if since:
            # As `git diff A...B`: without the changes of A since B branched off.
            base = _run("merge-base", "--end-of-options", *ends).strip()
            ends[0] = base[:12] or ends[0]
        return ends[0], ends[1]

    def spec(self, word: str, usual: list[Path]) -> Spec | None:
        """Return the ICDs of ``REVISION`` or ``REVISION:PATH``; None if the word is
        neither.
        """
        revision, colon, path = word.partition(":")
        if not self.commit(revision):
            return None
        if not colon:
            return Spec(revision, self.usual(usual), word, top=self.top)
        here = PurePosixPath(
            os.path.relpath(os.path.realpath("."), self.top).replace(os.sep, "/")
        )
        inner = PurePosixPath(path)
        # `git show REVISION:./path` is relative to the current folder too.
        if path.startswith("./"):
            inner = here / inner
        if ".." in inner.parts or inner.is_absolute():
            help = "as `git show` takes it: REVISION:icd/a.yaml"
            raise UserError(f"{word}: the path must lie in the repository", help)
        if not _run("cat-file", "-t", f"{revision}:{_name(inner)}", top=self.top):
            raise UserError(
                f"{revision} has no {path}",
                f"`git ls-tree -r {revision}` lists what it has",
            )
        return Spec(revision, [inner], word, top=self.top)

    def inside(self, paths: Iterable[Path]) -> list[PurePosixPath]:
        """Return the paths relative to the top folder of the repository.

        Raises `UserError` for a path outside of it.
        """
        relative, top = [], os.path.realpath(self.top)
        for path in paths:
            full = os.path.realpath(path)
            if not self.top or os.path.commonpath([full, top]) != top:
                help = "name the ICDs: REVISION:PATH, or `icds` in icdgen.toml"
                raise UserError(f"{path} is not in this git repository", help)
            relative.append(
                PurePosixPath(os.path.relpath(full, top).replace(os.sep, "/"))
            )
        return relative

    def usual(self, paths: Iterable[Path]) -> list[PurePosixPath]:
        """Return the default paths in the repository.

        If they are outside of it, return its folder ``icd``.
        """
        try:
            return self.inside(paths)
        except UserError:
            if self.top and os.path.isdir(os.path.join(self.top, USUAL)):
                return [PurePosixPath(USUAL)]
            raise

    def outside(self, path: PurePosixPath) -> Path:
        """Return the path in the working tree."""
        return Path(os.path.relpath(os.path.join(self.top, path)))


def _name(path: PurePosixPath) -> str:
    return "" if str(path) == "." else str(path)


def _export(revision: str, home: PurePosixPath, folder: Path, top: str) -> None:
    below = ["--", f"{_name(home)}/"] if _name(home) else []
    blobs: list[tuple[str, str]] = []
    # -z: git would quote names with special characters otherwise.
    for line in _run(
        "ls-tree", "-r", "-z", "--full-tree", revision, *below, top=top
    ).split("\0"):
        head, _, path = line.partition("\t")
        if path.endswith(_SUFFIX):
            mode, _, blob = head.split(" ")
            blobs += [(blob, path)] if mode in _FILES else []
    for path, data in _contents(blobs, top):
        target = folder / PurePosixPath(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(data)
    (folder / home).mkdir(parents=True, exist_ok=True)


def _contents(blobs: list[tuple[str, str]], top: str) -> Iterable[tuple[str, bytes]]:
    """Yield path and content of each blob, in one run of git."""
    if not blobs:
        return
    request = "".join(f"{blob}\n" for blob, _ in blobs).encode()
    completed = subprocess.run(
        ["git", "-C", top, "cat-file", "--batch"],
        input=request,
        capture_output=True,
        check=False,
    )
    output = completed.stdout
    for _, path in blobs:
        head, _, output = output.partition(b"\n")
        words = head.split()
        if len(words) != 3:
            raise UserError(
                f"git cannot read {path}",
                completed.stderr.decode("utf-8", "replace").strip(),
            )
        size = int(words[2])
        yield path, output[:size]
        # `cat-file --batch` ends each content with a line break.
        output = output[size + 1 :]


def _run(*words: str, top: str = ".") -> str:
    """Return the output of git; empty if it fails or is not installed."""
    try:
        completed = subprocess.run(
            ["git", "-C", top, *words], capture_output=True, check=False
        )
    except OSError:
        return ""
    return (
        completed.stdout.decode("utf-8", "surrogateescape")
        if completed.returncode == 0
        else ""
    )
