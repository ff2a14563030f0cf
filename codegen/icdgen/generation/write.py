"""Writes generated files to a folder: atomically, only if their content changes, and
never over files of others.

`plan` compares the files of a language with the folder and returns a `WritePlan`;
`apply` executes it. The manifest (``manifest``) names the files of earlier runs. Such a
file is overwritten even if a user edited it. If it is no longer generated, it is
removed only if it was not edited. Other modules write single files with `replace`.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from icdgen.errors import UserError
from icdgen.generation import manifest


@dataclass(eq=False, repr=False)
class WritePlan:
    """Changes in the folder ``out`` after which it has exactly the generated files of a
    language.
    """

    out: Path
    language: str
    files: dict[str, bytes]
    digests: dict[str, str] = field(default_factory=dict)  # of ``files``
    write: list[str] = field(default_factory=list)
    remove: list[str] = field(default_factory=list)
    # No longer generated, but edited by a user: not removed.
    edited: list[str] = field(default_factory=list)
    manifest: str = ""

    @property
    def changes(self) -> bool:
        """Whether a file must be written or removed."""
        return bool(self.write or self.remove)


def plan(
    out: Path, language: str, files: Iterable[tuple[PurePosixPath, str | bytes]]
) -> WritePlan:
    """Compare generated files with a folder.

    Raises `UserError` if a file would overwrite a file that icdgen did not write, or if
    two names differ only in case.
    """
    result = WritePlan(out, language, {})
    folded: dict[str, str] = {}
    for path, content in files:
        name = str(path)
        other = folded.setdefault(name.casefold(), name)
        if other != name or name in result.files:
            raise UserError(
                f"two outputs would share the file name {name}",
                "names that differ only in case clash on some systems: give one of them an `identifier:`",
            )
        try:
            result.files[name] = (
                content if isinstance(content, bytes) else content.encode("utf-8")
            )
        except UnicodeEncodeError as error:
            character = f"U+{ord(error.object[error.start]):04X}, which is no character"
            raise UserError(
                f"{name} would hold {character}", "correct the template"
            ) from None
    written = manifest.read(out, language)
    for name, data in result.files.items():
        current = read_if_exists(os.path.join(out, name))
        if current == data:
            continue
        if current is not None and name not in written:
            raise UserError(
                f"{out / name} was not written by icdgen and would be overwritten",
                "move it away, or generate into another folder with --out",
            )
        result.write.append(name)
    for name, digest in written.items():
        if name not in result.files:
            current = read_if_exists(out / name) if os.path.isfile(out / name) else None
            if current is None:
                continue
            if manifest.digest(current) == digest:
                result.remove.append(name)
            else:
                result.edited.append(name)
    result.digests = {
        name: manifest.digest(data) for name, data in result.files.items()
    }
    result.manifest = manifest.text(result.digests)
    return result


def apply(changes: WritePlan) -> None:
    """Write and remove files. Raises `UserError` if the folder cannot be written."""
    out = changes.out
    written = manifest.read(out, changes.language)
    target = manifest.path(out, changes.language)
    try:
        # First extend the manifest: after an interruption, the next run must know all
        # files that this run wrote.
        if not changes.files.keys() <= written.keys():
            extended = written | {name: written.get(name, "") for name in changes.files}
            replace(target, manifest.text(extended).encode())
        for name in changes.write:
            replace(os.path.join(out, name), changes.files[name])
        for name in changes.remove:
            (out / name).unlink(missing_ok=True)
            _remove_empty(out, (out / name).parent)
        # Last: a file that the manifest no longer names is never removed.
        if read_if_exists(target) != changes.manifest.encode():
            replace(target, changes.manifest.encode())
    except OSError as error:
        message = f"cannot write {error.filename}: {error.strerror}"
        raise UserError(message, "choose another folder with --out") from None


def replace(target: str | Path, data: bytes) -> None:
    """Write a file so that other processes see the old or the new content, never a
    part.

    Preserves its mode.
    """
    target = os.fspath(target)
    try:
        mode = os.stat(target).st_mode
    except OSError:
        mode = None
    if mode is not None and not stat.S_ISREG(mode):
        raise FileExistsError(errno.EEXIST, "it is not a file", target)
    folder = os.path.dirname(target)
    try:
        handle, name = _new_file(folder)
    except FileNotFoundError:
        os.makedirs(folder, exist_ok=True)
        handle, name = _new_file(folder)
    try:
        with open(handle, "wb", buffering=0) as file:
            # An unbuffered `write` can write less than it was given.
            unwritten = memoryview(data)
            while unwritten:
                unwritten = unwritten[file.write(unwritten) :]
        if mode is not None:
            os.chmod(name, stat.S_IMODE(mode))
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise


def _new_file(folder: str) -> tuple[int, str]:
    """Create a file with a unique name; return its handle and name."""
    # Like `tempfile.mkstemp`, whose import and calls take longer than writing a file.
    name = os.path.join(folder, f".icdgen-{os.urandom(8).hex()}")
    return (
        os.open(
            name,
            os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0),
            0o666,
        ),
        name,
    )


def read_if_exists(path: str | Path) -> bytes | None:
    """Return the content of a file; None if it does not exist.

    Raises `UserError` if it cannot be read.
    """
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise UserError(
                f"{path} is in the way: it is not a file",
                "move it away, or choose another place",
            )
        with open(path, "rb") as file:
            return file.read()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise UserError(
            f"cannot read {path}: {error.strerror}", "choose another folder with --out"
        ) from None


def _remove_empty(top: Path, folder: Path) -> None:
    """Remove empty folders, from ``folder`` upwards to ``top``."""
    while folder != top and folder.is_relative_to(top):
        try:
            folder.rmdir()
        except OSError:
            return
        folder = folder.parent
