"""Independent pieces of work side by side, in forked processes: a fork starts at once, with everything loaded."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

_T = TypeVar("_T")


class _Child(NamedTuple):
    pid: int
    pipe: int  # its pickled result comes from here


def results(tasks: Sequence[Callable[[], _T]]) -> list[_T]:
    """What the tasks return, in their order. They must not write, and what they return must pickle.

    The first runs here, each of the others in a process of its own where that is safe and helps. What a process does not deliver
    is done here again, so that errors are those of a plain loop.
    """
    if len(tasks) < 2 or not _can_fork():
        return [task() for task in tasks]
    children = [_started(task) for task in tasks[1:]]
    try:
        found = [tasks[0]()]
        for number, task in enumerate(tasks[1:]):
            child, children[number] = children[number], None
            data = _received(child) if child else b""
            found.append(pickle.loads(data) if data else task())
        return found
    finally:
        for child in filter(None, children):
            os.close(child.pipe)
            os.kill(child.pid, signal.SIGKILL)
            os.waitpid(child.pid, 0)


def _can_fork() -> bool:
    """Whether there is a second core, and no other thread that a fork would cut off in the middle of something."""
    if not hasattr(os, "fork") or not hasattr(os, "sched_getaffinity") or len(os.sched_getaffinity(0)) < 2:
        return False
    threading = sys.modules.get("threading")
    return threading is None or threading.active_count() == 1


def _started(task: Callable[[], object]) -> _Child | None:
    """A process that does the task; None if there can't be one."""
    try:
        source, sink = os.pipe()
    except OSError:
        return None
    try:
        pid = os.fork()
    except OSError:
        os.close(source)
        os.close(sink)
        return None
    if pid == 0:
        try:
            os.close(source)
            data = pickle.dumps(task(), protocol=5)
            with open(sink, "wb") as file:
                file.write(data)
            os._exit(0)
        finally:  # whatever happened: nothing of the parent's is flushed, printed or unwound here
            os._exit(1)
    os.close(sink)
    return _Child(pid, source)


def _received(child: _Child) -> bytes:
    """Its pickled result; nothing if it failed."""
    try:
        with open(child.pipe, "rb") as file:
            data = file.read()
    finally:
        _, status = os.waitpid(child.pid, 0)
    return data if status == 0 else b""
