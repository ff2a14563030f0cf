"""Remembers, by content, what was checked and what was generated, so that a build step with nothing to do costs nothing.

A record lists files with the SHA-256 of each; it holds only while every one of them is as it was, the tool itself included.
Records live in the user's cache folder; ``ICDGEN_CACHE=off`` does without. This module is on the path of every start: it imports
next to nothing.
"""

from __future__ import annotations

import os
import stat
import sys
from hashlib import sha256

ABSENT = "-"
UNKNOWN = "?"  # what can't be read, or not twice; never equal to anything
MOST = 300  # files of one kind in the cache


def folder() -> str | None:
    """The cache folder, or None if it is switched off."""
    chosen = os.environ.get("ICDGEN_CACHE")
    if chosen in ("off", "0"):
        return None
    if chosen:
        return chosen
    base = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(base):
        home = os.path.expanduser("~")
        if not os.path.isdir(home):  # as that of a service is not, and it is not for us to make
            return None
        base = os.path.join(home, ".cache")
    return os.path.join(base, "icdgen")


def fingerprint(path: str) -> str:
    """SHA-256 of a file, of a folder's list of names, or `ABSENT`, or `UNKNOWN`."""
    try:
        mode = os.stat(path).st_mode
        if stat.S_ISREG(mode):
            with open(path, "rb") as file:
                return sha256(file.read()).hexdigest()
        if stat.S_ISDIR(mode):
            return sha256("\0".join(sorted(os.listdir(path))).encode("utf-8", "surrogateescape")).hexdigest()
    except (FileNotFoundError, NotADirectoryError):
        return ABSENT
    except OSError:
        return UNKNOWN
    return UNKNOWN


_known: list[str] = []  # the digest of the tool, once it is needed


def tool() -> str:
    """Digest of everything that decides what the tool does: its own files, its templates and runtimes, the interpreter, jinja2.

    As of when it is first asked for: what changes later is not what runs.
    """
    if not _known:
        _known.append(_digest())
    return _known[0]


def _digest() -> str:
    package = os.path.dirname(os.path.abspath(__file__))
    data = os.path.join(package, "data")
    root = data if os.path.isdir(data) else os.path.dirname(os.path.dirname(package))
    digest = sha256(sys.version.encode())
    for top in (package, os.path.join(root, "templates"), os.path.join(root, "runtime")):
        for path in sorted(_files(top)):
            digest.update(path.encode("utf-8", "surrogateescape"))
            with open(path, "rb") as file:
                digest.update(file.read())
    for place in sys.path:
        try:
            status = os.stat(os.path.join(place, "jinja2", "__init__.py"))
        except OSError:
            continue
        digest.update(f"{status.st_size} {status.st_mtime_ns}".encode())
        break
    return digest.hexdigest()


def _files(top: str) -> list[str]:
    found = []
    with os.scandir(top) as entries:
        for entry in entries:
            if entry.is_dir():
                if entry.name not in ("__pycache__", "data"):
                    found += _files(entry.path)
            elif entry.name.endswith((".py", ".json", ".j2", ".js", ".css", ".h", ".rs")):
                found.append(entry.path)
    return found


def key(*parts: str) -> str:
    """A name for a record about ``parts``, for this tool."""
    return sha256("\0".join((tool(), *parts)).encode("utf-8", "surrogateescape")).hexdigest()


def holds(kind: str, name: str) -> str | None:
    """The note of the record if there is one and every file it lists is unchanged, else None."""
    data = recall(kind, name)
    if data is None:
        return None
    note, *lines = data.decode("utf-8", "surrogateescape").split("\n")
    for line in lines:
        expected, _, path = line.partition(" ")
        if fingerprint(path) != expected:
            return None
    return note


def remember(kind: str, name: str, note: str, files: dict[str, str]) -> None:
    """Keeps a record: path -> fingerprint of what was read or written there. Never fails."""
    if UNKNOWN in files.values() or any("\n" in path for path in files):
        return
    body = "\n".join([note, *(f"{print_} {path}" for path, print_ in files.items())])
    seal(kind, name, body.encode("utf-8", "surrogateescape"))


def recall(kind: str, name: str) -> bytes | None:
    """What `seal` kept under this name, if it is still exactly that."""
    top = folder()
    if top is None:
        return None
    try:
        with open(os.path.join(top, kind, name), "rb") as file:
            digest, _, data = file.read().partition(b"\n")
    except OSError:
        return None
    return data if sha256(data).hexdigest().encode() == digest else None


def seal(kind: str, name: str, data: bytes) -> None:
    """Keeps data with its digest. Never fails; a cache that can't be written is no cache."""
    keep(kind, name, sha256(data).hexdigest().encode() + b"\n" + data)


def keep(kind: str, name: str, data: bytes) -> None:
    """Writes a file of the cache, whole or not at all."""
    top = folder()
    if top is None:
        return
    target = os.path.join(top, kind, name)
    part = f"{target}.{os.getpid()}"
    try:
        os.makedirs(os.path.dirname(target), mode=0o700, exist_ok=True)
        try:
            with open(part, "wb") as file:
                file.write(data)
            os.replace(part, target)
        except BaseException:
            os.unlink(part)
            raise
        _prune(os.path.dirname(target))
    except OSError:
        return


def _prune(top: str) -> None:
    """Removes the oldest files where there are more than `MOST`."""
    with os.scandir(top) as entries:
        files = list(entries)
    if len(files) > MOST:
        files.sort(key=lambda entry: entry.stat().st_mtime_ns)
        for entry in files[:-MOST]:
            os.unlink(entry.path)
