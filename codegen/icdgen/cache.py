"""Cache of checked models and of finished runs, so that a build step without changes
takes almost no time.

A record has data and a list of files with their SHA-256. It is valid only while all
these files, and icdgen itself, are unchanged. Records are in the cache folder of the
user; ``ICDGEN_CACHE=off`` disables the cache.

Records determine what is generated. Therefore a record is ignored if anyone other than
the user could have written it, and records are plain data that is never executed. Every
start imports this module, so it imports almost nothing.
"""

from __future__ import annotations

import os
import stat
from hashlib import sha256

from icdgen import fingerprints

MOST = 300  # records of one kind
_BYTES = 64 << 20  # size limit of a record
_TEXT = ("utf-8", "surrogateescape")


def folder() -> str | None:
    """Return the cache folder; None if the cache is disabled or the user has no home
    folder.
    """
    chosen = os.environ.get("ICDGEN_CACHE")
    if chosen in ("off", "0"):
        return None
    if chosen:
        return chosen
    base = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(base):
        home = os.path.expanduser("~")
        # A service may have no home folder, and icdgen must not create one.
        if not os.path.isdir(home):
            return None
        base = os.path.join(home, ".cache")
    return os.path.join(base, "icdgen")


def key(*parts: str) -> str:
    """Return the name of a record about ``parts`` that is valid for this version of
    icdgen.
    """
    return sha256(
        "\0".join((fingerprints.of_tool(), *parts)).encode(*_TEXT)
    ).hexdigest()


def recall(kind: str, name: str) -> bytes | None:
    """Return the data of a record; None if it is absent, damaged, not private, or if a
    file that it lists has changed.
    """
    top = folder()
    if (
        top is None
        or not _is_private_folder(top)
        or not _is_private_folder(os.path.join(top, kind))
    ):
        return None
    digest, _, body = _read_private_file(os.path.join(top, kind, name)).partition(b"\n")
    if digest != sha256(body).hexdigest().encode():
        return None
    head, _, data = body.partition(b"\0")
    for line in head.decode(*_TEXT).splitlines():
        expected, _, path = line.partition(" ")
        if fingerprints.of_path(path) != expected:
            return None
    return data


def remember(kind: str, name: str, data: bytes, files: dict[str, str]) -> None:
    """Write a record.

    ``files`` has the fingerprint of each file that was read or written. Does not raise
    `OSError`.
    """
    # Paths are stored one per line, so those with a line break cannot be recorded.
    if fingerprints.UNKNOWN in files.values() or any(
        len(path.splitlines()) != 1 for path in files
    ):
        return
    top = folder()
    if top is None:
        return
    head = "\n".join(
        f"{fingerprint} {path}" for path, fingerprint in files.items()
    ).encode(*_TEXT)
    body = head + b"\0" + data
    try:
        for place in (top, os.path.join(top, kind)):
            if not os.path.isdir(place):
                os.makedirs(os.path.dirname(place) or ".", exist_ok=True)
                os.mkdir(place, 0o700)
            if not _is_private_folder(place):
                return
        _write_atomically(
            os.path.join(top, kind, name),
            sha256(body).hexdigest().encode() + b"\n" + body,
        )
        _prune(os.path.join(top, kind))
    except OSError:
        return


def _is_private(status: os.stat_result) -> bool:
    """Return whether a file or folder belongs to the user, and no other user can write
    to it.
    """
    # On Windows, other users cannot write to the folders of a profile.
    if not hasattr(os, "getuid"):
        return True
    return status.st_uid == os.getuid() and not stat.S_IMODE(status.st_mode) & 0o022


def _is_private_folder(path: str) -> bool:
    """Return whether a path is a private folder, and not a link."""
    try:
        status = os.lstat(path)
    except (OSError, ValueError):
        return False
    return stat.S_ISDIR(status.st_mode) and _is_private(status)


def _read_private_file(path: str) -> bytes:
    """Return the bytes of a private file; empty for anything else, such as a link or a
    pipe.
    """
    # Without O_NONBLOCK, opening a pipe waits for a writer.
    flags = (
        os.O_RDONLY
        | getattr(os, "O_NOFOLLOW", 0)
        | getattr(os, "O_NONBLOCK", 0)
        | getattr(os, "O_BINARY", 0)
    )
    try:
        with open(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            # A second hard link could be in a folder that others can write to.
            is_own = (
                stat.S_ISREG(status.st_mode)
                and _is_private(status)
                and status.st_nlink == 1
            )
            return file.read() if is_own and status.st_size <= _BYTES else b""
    except OSError:
        return b""


def _write_atomically(target: str, data: bytes) -> None:
    """Write a file atomically."""
    # Builds in parallel write the same record.
    part = f"{target}.{os.getpid()}"
    handle = os.open(
        part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600
    )
    try:
        with open(handle, "wb") as file:
            file.write(data)
        os.replace(part, target)
    except BaseException:
        os.unlink(part)
        raise


def _prune(top: str) -> None:
    """Remove the oldest files of a folder with more than `MOST` files."""
    with os.scandir(top) as entries:
        files = list(entries)
    if len(files) > MOST:
        files.sort(key=lambda entry: entry.stat().st_mtime_ns)
        for entry in files[:-MOST]:
            os.unlink(entry.path)
