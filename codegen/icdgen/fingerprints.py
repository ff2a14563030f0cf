"""Fingerprints (SHA-256) of files, to detect changes of inputs, outputs and icdgen
itself.

Every start imports this module, so it imports almost nothing.
"""

from __future__ import annotations

import os
import stat
import sys
from hashlib import sha256

ABSENT = "-"
_CHUNK = 1 << 16  # bytes
# Without O_BINARY, which only Windows has, `os.read` converts line endings there.
_READ = os.O_RDONLY | getattr(os, "O_BINARY", 0)
# Of a path that cannot be read, or only once, such as a pipe; records with it are never
# valid.
UNKNOWN = "?"


def of_path(path: str) -> str:
    """Return the SHA-256 of a file, or of the names in a folder; `ABSENT` or `UNKNOWN`
    for other paths.
    """
    try:
        status = os.stat(path)
        if stat.S_ISREG(status.st_mode):
            return _of_file(path, status.st_size)
        if stat.S_ISDIR(status.st_mode):
            # Sorted, because the order of `os.listdir` depends on the file system.
            # File names that are not UTF-8 have surrogates.
            return sha256(
                "\0".join(sorted(os.listdir(path))).encode("utf-8", "surrogateescape")
            ).hexdigest()
    except (FileNotFoundError, NotADirectoryError):
        return ABSENT
    except OSError:
        return UNKNOWN
    return UNKNOWN


def _of_file(path: str, size: int) -> str:
    """Return the SHA-256 of a file of ``size`` bytes."""
    # Every start reads hundreds of files, so this uses the calls of the operating
    # system, and not one more than necessary.
    digest = sha256()
    handle = os.open(path, _READ)
    try:
        while data := os.read(handle, _CHUNK):
            digest.update(data)
            size -= len(data)
            # Saves the call that would return no data. If the file has grown meanwhile,
            # the digest is that of its start.
            if size == 0:
                break
    finally:
        os.close(handle)
    return digest.hexdigest()


_cached: list[str] = []  # the digest of icdgen, after the first use


def of_tool() -> str:
    """Return the digest of icdgen: its modules, templates and runtimes, the interpreter
    and jinja2.

    It is computed once, because a file that changes later does not change the running
    program.
    """
    if not _cached:
        _cached.append(_digest())
    return _cached[0]


def _digest() -> str:
    """Compute the digest of icdgen."""
    package = os.path.dirname(os.path.abspath(__file__))
    data = os.path.join(package, "data")
    root = data if os.path.isdir(data) else os.path.dirname(os.path.dirname(package))
    digest = sha256(sys.version.encode())
    for top in (
        package,
        os.path.join(root, "templates"),
        os.path.join(root, "runtime"),
    ):
        for path in sorted(_files(top, data)):
            # The runtimes have modules, too, but their text becomes output.
            is_module = top is package and path.endswith(".py")
            fingerprint = _of_module(path) if is_module else of_path(path)
            digest.update(f"\0{path}\0{fingerprint}".encode("utf-8", "surrogateescape"))
    # An import would find this copy of jinja2, too, but would slow down every start.
    for place in sys.path:
        fingerprint = _of_module(os.path.join(place, "jinja2", "__init__.py"))
        if fingerprint != ABSENT:
            digest.update(fingerprint.encode())
            break
    return digest.hexdigest()


def _of_module(path: str) -> str:
    """Return size and modification time of a module, or `ABSENT` if it is not readable.

    A hash of the content would not detect more: Python also decides by size and
    modification time whether the compiled code of a module is current.
    """
    try:
        status = os.stat(path)
    except OSError:  # also a lock of an editor: a link to nothing
        return ABSENT
    return f"{status.st_size} {status.st_mtime_ns}"


def _files(top: str, without: str) -> list[str]:
    """Return all files below a folder, except in the folder ``without``, in hidden
    folders and in ``__pycache__``.
    """
    paths = []
    try:
        with os.scandir(top) as entries:
            for entry in entries:
                if not entry.is_dir():
                    paths.append(entry.path)
                elif (
                    entry.name != "__pycache__"
                    and entry.name[0] != "."
                    and entry.path != without
                ):
                    paths += _files(entry.path, without)
    except FileNotFoundError:  # an installed icdgen lacks some folders
        return []
    return paths
