"""The registry of backends. A backend is one class and one folder of templates, and touches nothing else.

A backend of another package, a plug-in, is found through the entry point group ``icdgen.backends``:
see docs/guides/add-a-language.md.
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
"""How people write the languages that programs are generated for."""


class Backend(Language, Protocol):
    """What a backend offers: its ``name`` is as in ``--lang``, and that of its template folder."""

    # Optional: `named_in`, the languages whose names its output contains, if not those of the backend itself alone.
    # Not of ours, but of plug-ins: `templates` and `runtime`, the folders (`Path`) of what it renders and of what it copies.
    # Files of `--templates` go before those of either.

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str | bytes]]:
        """Every file as relative path and content, a text or bytes, in a fixed order."""


class UnknownBackend(UserError):
    """No backend of that name; the message lists those there are."""


_registered: dict[str, str] = {}


def register(name: str, target: str) -> None:
    """Makes a backend known to this process, but not to users: ``target`` is ``module:Class``, as in an entry point."""
    _registered[name] = target


def names() -> tuple[str, ...]:
    """Names of the built-in backends."""
    return tuple(_BUILT_IN)


def plug_ins() -> dict[str, list[EntryPoint]]:
    """The entry points of backends in other packages by name, in order; one that is named like ours is never asked."""
    from importlib.metadata import entry_points

    found: dict[str, list[EntryPoint]] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda point: (point.name, point.value)):
        if point.name not in _BUILT_IN and point not in found.setdefault(point.name, []):
            found[point.name].append(point)
    return found


def get(name: str) -> Backend:
    """The backend called ``name``. Raises `UnknownBackend`, and `UserError` for a plug-in that can't be used."""
    known = _registered | _BUILT_IN
    if name in known:
        return _load(known[name])
    found = plug_ins()
    if name not in found:
        there = sorted({*_BUILT_IN, *found})
        close = close_words(name, there, 1) or [one for one in there if one.startswith(name.lower())]
        help = "install the package of the backend in the environment of icdgen"
        raise UnknownBackend(
            f"there is no backend `{name}`; there are: {', '.join(there)}",
            f"did you mean `{close[0]}`?" if close else help,
        )
    from icdgen.backends.plug_in import PlugIn

    return PlugIn.of(found[name])


def not_ours(languages: Iterable[str]) -> list[Backend]:
    """Those of the languages that are not built in. Raises like `get`."""
    return [get(name) for name in dict.fromkeys(languages) if name not in _BUILT_IN]


def named_in(chosen: Iterable[Backend]) -> tuple[str, ...]:
    """Return the built-in languages whose declared names the output of these backends contains."""
    languages = (name for backend in chosen for name in getattr(backend, "named_in", (backend.name,)))
    return tuple(name for name in dict.fromkeys(languages) if name in _BUILT_IN)


def _load(target: str) -> Backend:
    module, _, attribute = target.partition(":")
    made: Backend = getattr(import_module(module), attribute)()
    return made
