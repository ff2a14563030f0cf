"""Remembers, by content, what was checked and what was generated, so that a build step with nothing to do costs nothing.

A record lists files with the SHA-256 of each; it holds only while every one of them is as it was, the tool itself included.
Records live in the user's cache folder; ``ICDGEN_CACHE=off`` does without. This module is on the path of every start: it imports
next to nothing.
"""

from __future__ import annotations

import os
from hashlib import sha256

from icdgen import fingerprints

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


def key(*parts: str) -> str:
    """A name for a record about ``parts``, for this tool."""
    return sha256("\0".join((fingerprints.of_tool(), *parts)).encode("utf-8", "surrogateescape")).hexdigest()


def holds(kind: str, name: str) -> str | None:
    """The note of the record if there is one and every file it lists is unchanged, else None."""
    data = recall(kind, name)
    if data is None:
        return None
    note, *lines = data.decode("utf-8", "surrogateescape").split("\n")
    for line in lines:
        expected, _, path = line.partition(" ")
        if fingerprints.of_path(path) != expected:
            return None
    return note


def remember(kind: str, name: str, note: str, files: dict[str, str]) -> None:
    """Keeps a record: path -> fingerprint of what was read or written there. Never fails."""
    if fingerprints.UNKNOWN in files.values() or any("\n" in path for path in files):
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
