"""Progress of long commands on standard error, if it is a terminal.

A pipe and CI get no output. `items`, `pages` and `bytes_of` are contexts that yield a
function, through which the command reports its progress; `working` only shows the time.
The bar appears after `DELAY`, as the import of rich takes longer than most commands.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from rich.progress import Progress

# Seconds before progress is shown. Importing rich takes longer than most commands, so it
# is imported only then, and never without a terminal.
DELAY = 1.0
LEAST_BYTES = 10_000_000  # of a log whose conversion takes longer than that

T = TypeVar("T")


@contextmanager
def items(name: str, noun: str) -> Iterator[Callable[[Iterable[T]], Iterable[T]]]:
    """Count items, such as generated files. Yields a function that passes items on."""
    with _bar(name, "spinner", "{task.completed:,} " + noun, "elapsed") as bar:

        def counted(values: Iterable[T]) -> Iterable[T]:
            for number, value in enumerate(values, 1):
                bar.update(completed=number)
                yield value

        yield counted


@contextmanager
def working(name: str) -> Iterator[None]:
    """Show that a command works on something that has no parts to count."""
    with _bar(name, "spinner", "elapsed"):
        yield


@contextmanager
def pages(name: str) -> Iterator[Callable[[int, int, int], None]]:
    """Count the pages of a document and the tables on them.

    Yields a function of pages, all pages, and tables.
    """
    with _bar(
        name, "bar", "count", "pages, {task.fields[tables]} tables", "remaining"
    ) as bar:
        bar.update(tables=0)
        yield lambda done, total, tables: bar.update(
            completed=done, total=total, tables=tables
        )


@contextmanager
def bytes_of(name: str, total: int) -> Iterator[Callable[[int], None]]:
    """Count the bytes of a log.

    Yields a function that adds a number of processed bytes.
    """
    with _bar(
        name, "bar", "download", "speed", "remaining", is_shown=total >= LEAST_BYTES
    ) as bar:
        bar.update(total=total)
        yield lambda size: bar.update(completed=bar.values.get("completed", 0) + size)


class _Bar:
    """A bar that is shown after `DELAY`; until then only its values are stored."""

    def __init__(self, name: str, columns: tuple[str, ...]) -> None:
        self.values: dict[str, Any] = {}
        self._name = name
        self._columns = columns
        self._progress: Progress | None = None

    def update(self, **values: Any) -> None:
        """Change values of the task: ``completed``, ``total``, or values that a column
        shows.
        """
        self.values |= values
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], **self.values)

    def start(self) -> None:
        from rich import progress
        from rich.console import Console

        kinds = {
            "spinner": progress.SpinnerColumn,
            "bar": progress.BarColumn,
            "count": progress.MofNCompleteColumn,
            "download": progress.DownloadColumn,
            "speed": progress.TransferSpeedColumn,
            "elapsed": progress.TimeElapsedColumn,
            "remaining": progress.TimeRemainingColumn,
        }
        columns = [
            kinds[column]() if column in kinds else progress.TextColumn(column)
            for column in self._columns
        ]
        # Names of files can contain brackets, which rich would read as markup.
        name = progress.TextColumn("{task.description}", markup=False)
        shown = progress.Progress(
            name, *columns, console=Console(stderr=True), transient=True
        )
        shown.add_task(self._name, **{"total": None} | self.values)
        shown.start()
        self._progress = shown

    def stop(self) -> None:
        if self._progress is not None:
            self._progress.stop()


@contextmanager
def _bar(name: str, *columns: str, is_shown: bool = True) -> Iterator[_Bar]:
    bar = _Bar(name, columns)
    if not is_shown or sys.stderr is None or not sys.stderr.isatty():
        yield bar
        return
    # A thread, so that the command goes on while rich is imported.
    timer = Timer(DELAY, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield bar
    finally:
        timer.cancel()
        # The timer may just be running: a bar that it starts later would never be
        # stopped.
        timer.join()
        bar.stop()
