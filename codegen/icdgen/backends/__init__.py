"""Registry of backends. A backend is a class and a folder of templates; adding one
changes no other module.

A backend in another package (plug-in) is found by the entry point group
``icdgen.backends``: see docs/guides/add-a-language.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Protocol

from icdgen.errors import UserError
from icdgen.icd.identifiers import Identifier as Identifier
from icdgen.icd.identifiers import Language
from icdgen.icd.model import Icd
from icdgen.suggest import close_words

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from icdgen.render import Renderer

GROUP = "icdgen.backends"

_BUILT_IN = {
    "c": "icdgen.backends.c:CBackend",
    "python": "icdgen.backends.python:PythonBackend",
    "rust": "icdgen.backends.rust:RustBackend",
    "vectors": "icdgen.backends.vectors:VectorsBackend",
    "c-selftest": "icdgen.backends.c_selftest:CSelftestBackend",
    "html": "icdgen.backends.html:HtmlBackend",
    "assurance": "icdgen.backends.assurance:AssuranceBackend",
    "xtce": "icdgen.backends.xtce:XtceBackend",
    "xlsx": "icdgen.backends.tables:XlsxBackend",
    "csv": "icdgen.backends.tables:CsvBackend",
}


TITLES = {"c": "C", "python": "Python", "rust": "Rust"}
"""Spelling of the languages of generated programs in texts."""


class Backend(Language, Protocol):
    """Interface of a backend.

    Its ``name`` is the value of ``--lang`` and the name of its template folder.
    """

    # Optional: `named_in`, the languages whose declared names its output contains
    # (default: its own language). Plug-ins only: `templates` and `runtime`, the folders
    # (`Path`) of its templates and of files to copy. Files of `--templates` have
    # precedence over both.

    def files(
        self, icd: Icd, render: Renderer
    ) -> Iterator[tuple[PurePosixPath, str | bytes]]:
        """Yield each file as relative path and content (text or bytes), in a fixed
        order.
        """


class UnknownBackend(UserError):
    """No backend has this name. The message lists the existing ones."""


_registered: dict[str, str] = {}


def register(name: str, target: str) -> None:
    """Register a backend in this process only, for tests.

    ``target``: ``module:Class``, as in an entry point.
    """
    _registered[name] = target


def names() -> tuple[str, ...]:
    """Return the names of the built-in backends."""
    return tuple(_BUILT_IN)


def plug_ins() -> dict[str, list[EntryPoint]]:
    """Return the entry points of backends in other packages by name, in order.

    Entry points with the name of a built-in backend are ignored.
    """
    from importlib.metadata import entry_points

    points_by_name: dict[str, list[EntryPoint]] = {}
    for point in sorted(
        entry_points(group=GROUP), key=lambda point: (point.name, point.value)
    ):
        if point.name not in _BUILT_IN and point not in points_by_name.setdefault(
            point.name, []
        ):
            points_by_name[point.name].append(point)
    return points_by_name


def get(name: str) -> Backend:
    """Return the backend ``name``.

    Raises `UnknownBackend`, and `UserError` for an unusable plug-in.
    """
    targets = _registered | _BUILT_IN
    if name in targets:
        return _load(targets[name])
    points_by_name = plug_ins()
    if name not in points_by_name:
        available = sorted({*_BUILT_IN, *points_by_name})
        # A prefix such as `py` is too short for a similarity search.
        close = close_words(name, available, 1) or [
            candidate for candidate in available if candidate.startswith(name.lower())
        ]
        help = "install the package of the backend in the environment of icdgen"
        raise UnknownBackend(
            f"there is no backend `{name}`; there are: {', '.join(available)}",
            f"did you mean `{close[0]}`?" if close else help,
        )
    from icdgen.backends.plug_in import PlugIn

    return PlugIn.of(points_by_name[name])


def not_ours(languages: Iterable[str]) -> list[Backend]:
    """Return the backends of languages that are not built in.

    Raises the errors of `get`.
    """
    return [get(name) for name in dict.fromkeys(languages) if name not in _BUILT_IN]


def named_in(chosen: Iterable[Backend]) -> tuple[str, ...]:
    """Return the built-in languages whose declared names the output of these backends
    contains.
    """
    languages = (
        name
        for backend in chosen
        for name in getattr(backend, "named_in", (backend.name,))
    )
    return tuple(name for name in dict.fromkeys(languages) if name in _BUILT_IN)


def _load(target: str) -> Backend:
    module, _, attribute = target.partition(":")
    backend: Backend = getattr(import_module(module), attribute)()
    return backend
