"""Files of an import: new, or updated.

Trees of ICDs with their paths go in. No file is written before all are ready.
"""

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
    """A file to write.

    ``changes``: descriptions of the changes to an existing file; None for a new file.
    """

    path: Path
    text: str
    tree: dict[str, Any]
    changes: list[str] | None = None
    same: bool = False
    refused: bool = False  # the file exists, and no update is allowed


def prepare(
    trees: dict[str, dict[str, Any]],
    out: Path,
    over: bool,
    dry: bool = False,
    given_keys: frozenset[str] = frozenset(),
) -> list[Target]:
    """Prepare the files.

    ``given_keys`` are the keys in the source among the keys that users add to manuals.
    Raise `UserError` if a file exists and ``over`` does not allow an update, unless
    ``dry`` is set.
    """
    # All conflicts are reported before any file is written. A link without target
    # exists, too.
    existing = [
        out / f"{name}.yaml" for name in trees if os.path.lexists(out / f"{name}.yaml")
    ]
    if existing and not over and not dry:
        raise UserError(
            f"{', '.join(str(p) for p in existing)} already there",
            "--update lays what was read over them and keeps errata, identifiers and summaries; or choose another --out",
        )
    targets = []
    for name, tree in trees.items():
        path = out / f"{name}.yaml"
        if path not in existing:
            targets.append(Target(path, emit.canonical_yaml(tree), tree))
            continue
        try:
            old = path.read_text(encoding="utf-8")
        except OSError as error:
            raise unreadable(path, error) from None
        except UnicodeDecodeError:
            raise UserError(
                f"{path} is not UTF-8", "save it as UTF-8, or move it away"
            ) from None
        updated = update.update(old, str(path), tree, given_keys)
        targets.append(
            Target(
                path, updated.text, tree, updated.changes, updated.text == old, not over
            )
        )
    return targets


def check(targets: list[Target]) -> list[Finding]:
    """Return the findings of `icdgen check` for the files of an import, written or not."""
    from icdgen.loading import load

    texts = {target.path: target.text.encode("utf-8") for target in targets}
    return load(list(texts), unsaved=texts).findings if texts else []


def write(targets: list[Target]) -> None:
    """Write each file completely, and the schema that they refer to.

    Raise `UserError` if a file cannot be written.
    """
    from icdgen.generation.write import replace

    files = {
        target.path: target.text.encode("utf-8")
        for target in targets
        if not target.same
    }
    for path in [
        path.with_name(schema.COPY)
        for path, data in files.items()
        if schema.LINE.encode() in data
    ]:
        # An existing copy is not replaced: `icdgen schema --out` renews it.
        if not os.path.lexists(path):
            files[path] = schema.PATH.read_bytes()
    for path, data in files.items():
        try:
            # A symbolic link stays one: its target is replaced.
            replace(Path(os.path.realpath(path)), data)
        except OSError as error:
            raise UserError(
                f"cannot write {path}: {error.strerror}",
                "choose another folder with --out",
            ) from None
