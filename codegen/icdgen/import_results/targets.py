"""The files of an import, new or laid over those that are there. Nothing is written before everything is ready."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding
from icdgen.errors import UserError, unreadable
from icdgen.icd import schema
from icdgen.icd.fmt import emit
from icdgen.import_results import update


@dataclass
class Target:
    """A file to be written. ``changes`` is None where there was none before."""

    path: Path
    text: str
    tree: dict[str, Any]
    changes: list[str] | None = None
    same: bool = False
    refused: bool = False  # one is there, and was not to be updated


def aim(
    trees: dict[str, dict[str, Any]], out: Path, over: bool, dry: bool = False, told: frozenset[str] = frozenset()
) -> list[Target]:
    """Prepares the files. Raises `UserError` where one exists and ``over`` does not allow to update it, unless none will
    be written anyway (``dry``). ``told``: keys that the source itself gives, of those that people add to manuals."""
    taken = [out / f"{name}.yaml" for name in trees if os.path.lexists(out / f"{name}.yaml")]
    if taken and not over and not dry:
        raise UserError(
            f"{', '.join(str(p) for p in taken)} already there",
            "--update lays what was read over them and keeps errata, identifiers and summaries; or choose another --out",
        )
    targets = []
    for name, tree in trees.items():
        path = out / f"{name}.yaml"
        if path not in taken:
            targets.append(Target(path, emit.text(tree), tree))
            continue
        try:
            old = path.read_text(encoding="utf-8")
        except OSError as error:
            raise unreadable(path, error) from None
        except UnicodeDecodeError:
            raise UserError(f"{path} is not UTF-8", "save it as UTF-8, or move it away") from None
        made = update.update(old, str(path), tree, told)
        targets.append(Target(path, made.text, tree, made.changes, made.text == old, not over))
    return targets


def check(targets: list[Target]) -> list[Finding]:
    """Return the findings that `icdgen check` has for the files of an import, written or not."""
    from icdgen.loading import load

    texts = {target.path: target.text.encode("utf-8") for target in targets}
    return load(list(texts), unsaved=texts).findings if texts else []


def write(targets: list[Target]) -> None:
    """Writes the files, each as a whole, and beside them the schema that they name. Raises `UserError` if one can't be written."""
    from icdgen.generation.write import replace

    files = {target.path: target.text.encode("utf-8") for target in targets if not target.same}
    for path in [path.with_name(schema.COPY) for path, data in files.items() if schema.LINE.encode() in data]:
        if not os.path.lexists(path):
            files[path] = schema.PATH.read_bytes()
    for path, data in files.items():
        try:
            replace(Path(os.path.realpath(path)), data)
        except OSError as error:
            raise UserError(f"cannot write {path}: {error.strerror}", "choose another folder with --out") from None
