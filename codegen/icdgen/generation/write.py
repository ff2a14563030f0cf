"""Brings a folder to the generated state: atomically, touching only what changes, never a file that is not ours."""

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
class Plan:
    """What would have to change below ``out`` so that it holds exactly the generated files."""

    out: Path
    language: str
    files: dict[str, bytes]
    digests: dict[str, str] = field(default_factory=dict)  # of ``files``
    write: list[str] = field(default_factory=list)
    remove: list[str] = field(default_factory=list)
    edited: list[str] = field(default_factory=list)  # ours once, no longer generated, but changed by hand: kept
    manifest: str = ""

    @property
    def changes(self) -> bool:
        return bool(self.write or self.remove)


def plan(out: Path, language: str, files: Iterable[tuple[PurePosixPath, str | bytes]]) -> Plan:
    """Compares. Raises `UserError` where a file that is not ours stands in the way, or two outputs differ only in case."""
    made = Plan(out, language, {})
    folded: dict[str, str] = {}
    for path, content in files:
        name = str(path)
        other = folded.setdefault(name.casefold(), name)
        if other != name or name in made.files:
            raise UserError(
                f"two outputs would share the file name {name}",
                "names that differ only in case clash on some systems: give one of them an `identifier:`",
            )
        try:
            made.files[name] = content if isinstance(content, bytes) else content.encode("utf-8")
        except UnicodeEncodeError as error:
            what = f"U+{ord(error.object[error.start]):04X}, which is no character"
            raise UserError(f"{name} would hold {what}", "mend the template") from None
    ours = manifest.read(out, language)
    for name, data in made.files.items():
        now = read(os.path.join(out, name))
        if now == data:
            continue
        if now is not None and name not in ours:
            raise UserError(
                f"{out / name} was not written by icdgen and would be overwritten",
                "move it away, or generate into another folder with --out",
            )
        made.write.append(name)
    for name, digest in ours.items():
        if name not in made.files:
            now = read(out / name) if os.path.isfile(out / name) else None
            if now is not None:
                (made.remove if manifest.digest(now) == digest else made.edited).append(name)
    made.digests = {name: manifest.digest(data) for name, data in made.files.items()}
    made.manifest = manifest.text(made.digests)
    return made


def apply(made: Plan) -> None:
    """Writes and removes. Raises `UserError` if the folder can't be written."""
    ours = manifest.read(made.out, made.language)
    try:
        if not made.files.keys() <= ours.keys():  # so that an interrupted run still knows what it wrote
            known = ours | {name: ours.get(name, "") for name in made.files}
            replace(manifest.path(made.out, made.language), manifest.text(known).encode())
        for name in made.write:
            replace(os.path.join(made.out, name), made.files[name])
        target = manifest.path(made.out, made.language)
        if read(target) != made.manifest.encode():
            replace(target, made.manifest.encode())
        for name in made.remove:
            (made.out / name).unlink(missing_ok=True)
            _remove_empty(made.out, (made.out / name).parent)
    except OSError as error:
        what = f"cannot write {error.filename}: {error.strerror}"
        raise UserError(what, "choose another folder with --out") from None


def replace(target: str | Path, data: bytes) -> None:
    """Writes a file so that a reader sees the old content or the new one, never a part. The file's mode stays."""
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
            rest = memoryview(data)
            while rest:
                rest = rest[file.write(rest) :]
        if mode is not None:
            os.chmod(name, stat.S_IMODE(mode))
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise


def _new_file(folder: str) -> tuple[int, str]:
    """A file of a name that nobody has, for writing. (`tempfile` costs more than the writing.)"""
    name = os.path.join(folder, f".icdgen-{os.urandom(8).hex()}")
    return os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666), name


def read(path: str | Path) -> bytes | None:
    """The content of what we may write; None if it is not there. Raises `UserError` if it can't be read."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise UserError(f"{path} is in the way: it is not a file", "move it away, or choose another place")
        with open(path, "rb") as file:
            return file.read()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise UserError(f"cannot read {path}: {error.strerror}", "choose another folder with --out") from None


def _remove_empty(top: Path, folder: Path) -> None:
    while folder != top and folder.is_relative_to(top):
        try:
            folder.rmdir()
        except OSError:
            return
        folder = folder.parent
