"""Remembers, by content, what was checked and what was generated, so that a build step with nothing to do costs nothing.

A record holds data and lists files with the SHA-256 of each; it counts only while every one of them is as it was, the tool itself
included. Records live in the user's cache folder; ``ICDGEN_CACHE=off`` does without.

What is read here decides what is generated. So nothing counts that anybody but the user could have put there, and records are
plain data: nothing in them is ever run. This module is on the path of every start: it imports next to nothing.
"""

from __future__ import annotations

import os
import stat
from hashlib import sha256

from icdgen import fingerprints

MOST = 300  # records of one kind
_BYTES = 64 << 20  # no record of ours is larger
_TEXT = ("utf-8", "surrogateescape")


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


def key(*parts: str) -> str:
    """A name for a record about ``parts``, for this tool."""
    return sha256("\0".join((fingerprints.of_tool(), *parts)).encode(*_TEXT)).hexdigest()


def recall(kind: str, name: str) -> bytes | None:
    """The data of a record, if it is the user's own, whole, and every file it lists is unchanged."""
    top = folder()
    if top is None or not _is_private_folder(top) or not _is_private_folder(os.path.join(top, kind)):
        return None
    digest, _, rest = _content(os.path.join(top, kind, name)).partition(b"\n")
    if digest != sha256(rest).hexdigest().encode():
        return None
    head, _, data = rest.partition(b"\0")
    for line in head.decode(*_TEXT).splitlines():
        expected, _, path = line.partition(" ")
        if fingerprints.of_path(path) != expected:
            return None
    return data


def remember(kind: str, name: str, data: bytes, files: dict[str, str]) -> None:
    """Keeps a record. ``files``: path -> fingerprint of what was read or written there. Never fails."""
    if fingerprints.UNKNOWN in files.values() or any(len(path.splitlines()) != 1 for path in files):
        return
    top = folder()
    if top is None:
        return
    rest = "\n".join(f"{seen} {path}" for path, seen in files.items()).encode(*_TEXT) + b"\0" + data
    try:
        for place in (top, os.path.join(top, kind)):
            _make(place)
            if not _is_private_folder(place):
                return
        _write(os.path.join(top, kind, name), sha256(rest).hexdigest().encode() + b"\n" + rest)
        _prune(os.path.join(top, kind))
    except OSError:
        return


def _is_private(status: os.stat_result) -> bool:
    """Whether it belongs to the user, and nobody else may write to it."""
    if not hasattr(os, "getuid"):  # Windows: a profile's folders are its user's
        return True
    return status.st_uid == os.getuid() and not stat.S_IMODE(status.st_mode) & 0o022


def _is_private_folder(path: str) -> bool:
    try:
        status = os.lstat(path)
    except (OSError, ValueError):
        return False
    return stat.S_ISDIR(status.st_mode) and _is_private(status)


def _content(path: str) -> bytes:
    """The bytes of a file of the user's own; none if it is anything else."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        with open(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            ours = stat.S_ISREG(status.st_mode) and _is_private(status) and status.st_nlink == 1
            return file.read() if ours and status.st_size <= _BYTES else b""
    except OSError:
        return b""


def _make(place: str) -> None:
    if not os.path.isdir(place):
        os.makedirs(os.path.dirname(place) or ".", exist_ok=True)
        os.mkdir(place, 0o700)


def _write(target: str, data: bytes) -> None:
    """Writes a file, whole or not at all."""
    part = f"{target}.{os.getpid()}"
    handle = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600)
    try:
        with open(handle, "wb") as file:
            file.write(data)
        os.replace(part, target)
    except BaseException:
        os.unlink(part)
        raise


def _prune(top: str) -> None:
    """Removes the oldest files where there are more than `MOST`."""
    with os.scandir(top) as entries:
        files = list(entries)
    if len(files) > MOST:
        files.sort(key=lambda entry: entry.stat().st_mtime_ns)
        for entry in files[:-MOST]:
            os.unlink(entry.path)
