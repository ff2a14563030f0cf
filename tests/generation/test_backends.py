"""Backends are found by their names: built-in ones, and those of other packages."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from icdgen import backends
from icdgen.errors import UserError


@pytest.fixture
def installed(monkeypatch):
    """Install the entry points of two backends, of which one has a built-in name."""
    points = [
        EntryPoint("zig", "their_zig:Backend", backends.GROUP),
        EntryPoint("zig", "their_zig:Backend", backends.GROUP),
        EntryPoint("rust", "their_rust:Backend", backends.GROUP),
        EntryPoint("ada", "their_ada:Backend", backends.GROUP),
        EntryPoint("ada", "another_ada:Backend", backends.GROUP),
    ]
    monkeypatch.setattr(
        "importlib.metadata.entry_points",
        lambda group: points if group == backends.GROUP else [],
    )


@pytest.mark.parametrize(
    ("name", "help"),
    [
        ("zigg", "did you mean `zig`?"),
        ("Zi", "did you mean `zig`?"),
        ("py", "did you mean `python`?"),
        ("pyhton", "did you mean `python`?"),
        (
            "cobol",
            "install the package of the backend in the environment of icdgen",
        ),
    ],
)
def test_an_unknown_backend_is_reported_with_all_names_and_the_closest(
    installed, name, help
):
    with pytest.raises(backends.UnknownBackend) as raised:
        backends.get(name)
    assert str(raised.value) == (
        f"there is no backend `{name}`; there are: ada, assurance, c, c-selftest, "
        "csv, html, python, rust, vectors, xlsx, xtce, zig"
    )
    assert raised.value.help == help


def test_backends_of_other_packages_are_listed_once_in_a_fixed_order(installed):
    modules = {
        name: [point.module for point in points]
        for name, points in backends.plug_ins().items()
    }
    assert modules == {"ada": ["another_ada", "their_ada"], "zig": ["their_zig"]}


def test_no_other_package_replaces_a_built_in_backend(installed):
    assert type(backends.get("rust")).__module__ == "icdgen.backends.rust"


def test_every_built_in_backend_has_its_own_name():
    assert [backends.get(name).name for name in backends.names()] == [*backends.names()]
    assert backends.not_ours(backends.names()) == []


def test_declared_names_count_for_the_languages_of_the_output_once():
    chosen = [backends.get(name) for name in ("csv", "rust", "c-selftest", "rust")]
    assert backends.named_in(chosen) == ("rust", "c")


def test_several_packages_with_one_backend_are_reported(installed):
    with pytest.raises(UserError) as raised:
        backends.get("ada")
    assert str(raised.value) == (
        "there are 2 backends `ada`: `another_ada:Backend` and `their_ada:Backend`"
    )
    assert raised.value.help == "uninstall all but one"
