"""What a file holds, in 64 digits: by these we know whether an input, an output or the tool itself is still what it was.

This module is on the path of every start: it imports next to nothing.
"""

from __future__ import annotations

import os
import stat
import sys
from hashlib import sha256

ABSENT = "-"
_CHUNK = 1 << 16  # bytes
_READ = os.O_RDONLY | getattr(os, "O_BINARY", 0)
UNKNOWN = "?"  # what can't be read, or not twice; never equal to anything


def of_path(path: str) -> str:
    """SHA-256 of a file, of a folder's list of names, or `ABSENT`, or `UNKNOWN`."""
    try:
        status = os.stat(path)
        if stat.S_ISREG(status.st_mode):
            return _of_file(path, status.st_size)
        if stat.S_ISDIR(status.st_mode):
            return sha256("\0".join(sorted(os.listdir(path))).encode("utf-8", "surrogateescape")).hexdigest()
    except (FileNotFoundError, NotADirectoryError):
        return ABSENT
    except OSError:
        return UNKNOWN
    return UNKNOWN


def _of_file(path: str, size: int) -> str:
    """By the system's own calls, and no more of them than it has bytes for: every start reads a thousand files."""
    digest = sha256()
    handle = os.open(path, _READ)
    try:
        while data := os.read(handle, _CHUNK):
            digest.update(data)
            size -= len(data)
            if size == 0:  # what is longer now is another file, and so is its digest; what is shorter ends by itself
                break
    finally:
        os.close(handle)
    return digest.hexdigest()


_known: list[str] = []  # the digest of the tool, once it is needed


def of_tool() -> str:
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
        for path in sorted(_files(top, data)):
            digest.update(f"\0{path}\0{of_path(path)}".encode("utf-8", "surrogateescape"))
    for place in sys.path:
        try:
            status = os.stat(os.path.join(place, "jinja2", "__init__.py"))
        except OSError:
            continue
        digest.update(f"{status.st_size} {status.st_mtime_ns}".encode())
        break
    return digest.hexdigest()


def _files(top: str, without: str) -> list[str]:
    """Every file below a folder, whatever it is called; not what Python and other tools leave there."""
    found = []
    try:
        with os.scandir(top) as entries:
            for entry in entries:
                if not entry.is_dir():
                    found.append(entry.path)
                elif entry.name != "__pycache__" and entry.name[0] != "." and entry.path != without:
                    found += _files(entry.path, without)
    except FileNotFoundError:  # not every folder of sources is there
        return []
    return found
