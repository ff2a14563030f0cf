"""Backend of another package. Its errors are reported with its name and entry point.

`icdgen.backends.get` wraps each plug-in in a `PlugIn`, so that an exception in it is a
message for its author and no traceback of icdgen.
"""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import EntryPoint
from pathlib import Path, PurePath, PurePosixPath
from typing import Any

from icdgen.errors import UserError
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Icd


class PlugIn:
    """Backend of an entry point.

    Raises `UserError` for each exception of the backend; its own `UserError` is passed
    on.
    """

    def __init__(self, point: EntryPoint) -> None:
        self._point = point
        with self._named("cannot be loaded"):
            backend = point.load()()
            self.name: str = backend.name
            self.title: str = getattr(backend, "title", backend.name)
            self.templates: Path | None = getattr(backend, "templates", None)
            self.runtime: Path | None = getattr(backend, "runtime", None)
            self.reserved = frozenset(backend.reserved)
            self._files, self._identifiers = backend.files, backend.identifiers
        # Otherwise `--lang` and the template folder would have different names.
        if self.name != point.name:
            raise UserError(
                f"the entry point `{point.name} = {point.value}`{_package(point)} leads to a backend called `{self.name}`",
                "it is a fault of that package, the two must be the same: report it to its makers",
            )

    @classmethod
    def of(cls, points: list[EntryPoint]) -> PlugIn:
        """Return the backend of the entry points of one name.

        Raises `UserError` if several packages define it.
        """
        if len(points) > 1:
            each = " and ".join(f"`{point.value}`{_package(point)}" for point in points)
            raise UserError(
                f"there are {len(points)} backends `{points[0].name}`: {each}",
                "uninstall all but one",
            )
        return cls(points[0])

    def files(
        self, icd: Icd, render: Any
    ) -> Iterator[tuple[PurePosixPath, str | bytes]]:
        """Yield the files of the backend."""
        with self._named("failed"):
            for file in self._files(icd, render):
                path, text = file
                if not (isinstance(path, PurePath) and isinstance(text, (str, bytes))):
                    raise TypeError(
                        f"`files` gives pairs of path and text or bytes, not {file!r:.100}"
                    )
                yield PurePosixPath(path), text

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Yield the identifiers of the backend."""
        with self._named("failed"):
            yield from self._identifiers(icd)

    @contextmanager
    def _named(self, what: str) -> Iterator[None]:
        try:
            yield
        except UserError:
            raise
        except Exception as error:
            # The innermost frame, which is where the package failed.
            last = traceback.extract_tb(error.__traceback__)[-1]
            reason = f"{type(error).__name__}: {error}".rstrip(": ")
            raise UserError(
                f"the backend `{self._point.name}`{_package(self._point)} (entry point `{self._point.value}`) {what}: {reason}",
                f"it is a fault of that package, in {last.filename}, line {last.lineno}: report it to its makers",
            ) from error


def _package(point: EntryPoint) -> str:
    return f" of {point.dist.name}" if point.dist else ""
