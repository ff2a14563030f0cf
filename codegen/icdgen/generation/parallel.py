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
    results: int  # the pipe that its pickled results come from


def results(tasks: Sequence[Callable[[], _T]]) -> list[_T]:
    """What the tasks return, in their order. They may not rely on each other, and what they return must pickle.

    They are shared out to a process a core, this one included, where that is safe. A task that fails there is done here again, when
    all others are through: errors are those of a plain loop.
    """
    workers = min(len(tasks), _cores())
    if workers < 2:
        return [task() for task in tasks]
    queue, feed = os.pipe()  # a byte a task: who reads it does it
    os.write(feed, bytes(range(len(tasks))))
    os.close(feed)
    children: list[_Child] = []
    found: dict[int, _T] = {}
    try:
        while len(children) < workers - 1 and (child := _started(tasks, queue)):
            children.append(child)
        found |= _worked(tasks, queue)
        while children:
            found |= _received(children.pop())
    finally:
        os.close(queue)
        for child in children:
            _end(child)
    return [found[number] if number in found else task() for number, task in enumerate(tasks)]


def _cores() -> int:
    """How many processes are worth having; one where a fork would cut off another thread in the middle of something."""
    if not hasattr(os, "fork") or not hasattr(os, "sched_getaffinity"):
        return 1
    threading = sys.modules.get("threading")
    return 1 if threading is not None and threading.active_count() > 1 else len(os.sched_getaffinity(0))


def _worked(tasks: Sequence[Callable[[], _T]], queue: int) -> dict[int, _T]:
    """Results of the tasks that this process got hold of, by their number."""
    found = {}
    while number := os.read(queue, 1):
        try:
            found[number[0]] = tasks[number[0]]()
        except Exception:  # it shows again when the task is done anew
            continue
    return found


def _started(tasks: Sequence[Callable[[], object]], queue: int) -> _Child | None:
    """A process that takes its share; None if there can't be one."""
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
            data = pickle.dumps(_worked(tasks, queue), protocol=5)
            with open(sink, "wb") as file:
                file.write(data)
            os._exit(0)
        finally:  # whatever happened: nothing of the parent's is flushed, printed or unwound here
            os._exit(1)
    os.close(sink)
    return _Child(pid, source)


def _received(child: _Child) -> dict[int, _T]:
    """Its results; none if it failed."""
    try:
        with open(child.results, "rb", closefd=False) as file:
            data = file.read()
    finally:
        os.close(child.results)
        _, status = os.waitpid(child.pid, 0)
    return pickle.loads(data) if status == 0 else {}


def _end(child: _Child) -> None:
    os.close(child.results)
    os.kill(child.pid, signal.SIGKILL)
    os.waitpid(child.pid, 0)
