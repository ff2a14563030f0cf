"""The registry of backends. A backend is one class and one folder of templates, and touches nothing else.

A backend of another package is found through the entry point group ``icdgen.backends``.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pathlib import PurePosixPath
from typing import NamedTuple, Protocol

from icdgen.icd.located import Map
from icdgen.icd.model import Icd

GROUP = "icdgen.backends"

_BUILT_IN = {
    "c": "icdgen.backends.c:CBackend",
    "python": "icdgen.backends.python:PythonBackend",
    "rust": "icdgen.backends.rust:RustBackend",
    "vectors": "icdgen.backends.vectors:VectorsBackend",
    "c-selftest": "icdgen.backends.c_selftest:CSelftestBackend",
    "html": "icdgen.backends.html:HtmlBackend",
}


class Identifier(NamedTuple):
    """A name that generated code declares. Two equal names in one scope clash."""

    scope: str  # "members of struct demo_foo_t"
    text: str
    owner: str  # what it was made from, in a user's words: "field `Foo` of `Bar`"
    source: Map | None  # where that stands in the ICD


class Backend(Protocol):
    """What a backend offers. ``render`` comes from `icdgen.render.Renderer`."""

    name: str  # as in ``--lang``, and the name of its template folder
    reserved: frozenset[str]  # words that can't be identifiers

    # Optional: `templates` and `runtime`, the folders (`Path`) of its templates and of what it copies into the output, for backends
    # that are not part of icdgen. `--templates` goes before both.

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """Every file as relative path and text, in a fixed order."""

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that ``files`` declares, for the name rules."""


class UnknownBackend(LookupError):
    """No backend of that name; the message lists those there are."""


_registered: dict[str, str] = {}


def register(name: str, target: str) -> None:
    """Makes a backend known to this process: ``target`` is ``module:Class``, as an entry point would say it."""
    _registered[name] = target


def names() -> tuple[str, ...]:
    """Names of the built-in backends."""
    return tuple(_BUILT_IN)


def get(name: str) -> Backend:
    """The backend called ``name``. Raises `UnknownBackend`."""
    known = _registered | _BUILT_IN
    if name in known:
        return _load(known[name])
    from importlib.metadata import entry_points

    found = {point.name: point for point in entry_points(group=GROUP)}
    if name not in found:
        known = ", ".join(sorted({*_BUILT_IN, *found}))
        raise UnknownBackend(f"there is no backend `{name}`; there are: {known}")
    from icdgen.backends.plug_in import PlugIn

    return PlugIn(found[name])


def _load(target: str) -> Backend:
    module, _, attribute = target.partition(":")
    return getattr(import_module(module), attribute)()
