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
    "c-selftest": "icdgen.backends.c_conformance:CSelftestBackend",
    "c-testee": "icdgen.backends.c_conformance:CTesteeBackend",
    "rust-testee": "icdgen.backends.rust_testee:RustTesteeBackend",
    "html": "icdgen.backends.html:HtmlBackend",
    "js-testee": "icdgen.backends.js_testee:JsTesteeBackend",
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

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """Every file as relative path and text, in a fixed order."""

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that ``files`` declares, for the name rules."""


class UnknownBackend(LookupError):
    """No backend of that name; the message lists those there are."""


def names() -> tuple[str, ...]:
    """Names of the built-in backends."""
    return tuple(_BUILT_IN)


def get(name: str) -> Backend:
    """The backend called ``name``. Raises `UnknownBackend`."""
    if name in _BUILT_IN:
        return _load(_BUILT_IN[name])
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
