"""Exclusive use of serial ports and terminals.

Two programs on one line would receive each other's responses. `lock_port` locks an open
port or raises `PortError`; `busy_error` returns this error with the program that uses
the port, as far as ``/proc`` of Linux shows it. The lock is advisory: a program that
does not use `flock` can still open the port.
"""

from __future__ import annotations

import os
from pathlib import Path

from icdgen.errors import UserError


class PortError(UserError):
    """The port cannot be opened, or the connection is lost."""


def lock_port(file: int, path: str) -> None:
    """Lock an open serial port or terminal for this process until it is closed.

    The lock is `flock`, which pyserial (``exclusive=True``), picocom and others use as
    well. Raise `PortError` that names the owner.
    """
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise busy_error(path) from None
    except OSError:
        pass  # this kind of file has no locks


def busy_error(path: str) -> PortError:
    """Return the error for a port that another program uses."""
    users = [f"{name} (process {pid})" for pid, name in users_of(path)]
    owner = f" by {', '.join(users)}" if users else " by another program"
    return PortError(
        f"{path} is in use{owner}; nothing was sent",
        "end that program, or connect to another port: a serial line serves one program at a time",
    )


def users_of(path: str) -> list[tuple[int, str]]:
    """Return other processes that have locked the file, or otherwise have opened it.

    Each has its id and command, as far as Linux shows them.
    """
    target = os.path.realpath(path)
    # Files of other users' processes are not visible, so this list can lack the owner
    # of a lock.
    try:
        pids = {int(name) for name in os.listdir("/proc") if name.isdecimal()}
    except OSError:
        pids = set()  # there is no /proc on other systems than Linux
    users = {pid for pid in pids - {os.getpid()} if _has_open(pid, target)}
    # A simulator has opened its own end of a pseudo-terminal. Only the owner of the
    # lock prevents the use.
    owners = _lock_owners(target)
    return [(pid, _command(pid)) for pid in sorted(users & owners or owners or users)]


def _lock_owners(path: str) -> set[int]:
    """Return the ids of processes with a lock on the file.

    Lines of ``/proc/locks`` are like ``1: FLOCK  ADVISORY  WRITE 4711 00:18:3 0 EOF``.
    """
    try:
        file = os.stat(path)
        lines = [
            line.split()
            for line in Path("/proc/locks").read_text(encoding="ascii").splitlines()
        ]
    except OSError:
        return set()
    place = f"{os.major(file.st_dev):02x}:{os.minor(file.st_dev):02x}:{file.st_ino}"
    owners = {
        int(words[4])
        for words in lines
        if len(words) > 5 and words[5] == place and words[1] == "FLOCK"
    }
    return {pid for pid in owners if pid > 0} - {os.getpid()}


def _has_open(pid: int, target: str) -> bool:
    """Return whether a process has opened a file."""
    try:
        return any(
            os.path.realpath(file) == target
            for file in Path(f"/proc/{pid}/fd").iterdir()
        )
    except OSError:
        return False  # the process has ended, or belongs to another user


def _command(pid: int) -> str:
    """Return the program of a process with its first argument, for a message."""
    try:
        command_line = Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return "unknown"
    words = [word for word in command_line.decode(errors="replace").split("\0") if word]
    if len(words) > 1 and os.path.basename(words[0]).startswith("python"):
        words = words[words.index("-m") + 1 :] if "-m" in words[:-1] else words[1:]
    # Only program and subcommand, as further arguments may be long or secret.
    return " ".join([os.path.basename(words[0]), *words[1:2]]) if words else "unknown"
