"""A backend of another package is used through its entry point, and each of its
exceptions is a message for its author.
"""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from types import SimpleNamespace

import pytest

from icdgen.backends.plug_in import PlugIn
from icdgen.errors import UserError
from icdgen.icd.model import Icd

ICD = Icd(())


class Backend:
    """Backend with all attributes, which tests change."""

    name = "ada"
    reserved = ["begin", "end"]  # noqa: RUF012 - tests may change it

    def files(self, icd, render):
        yield PurePosixPath("a.adb"), "text"
        yield Path("b.bin"), b"\0"

    def identifiers(self, icd):
        yield "identifier"


def point(backend=Backend, name="ada", package="icdgen-ada"):
    def load():
        if isinstance(backend, Exception):
            raise backend
        return backend

    return SimpleNamespace(
        name=name,
        value="their_ada:Backend",
        load=load,
        dist=package and SimpleNamespace(name=package),
    )


def test_a_backend_has_its_own_attributes_or_defaults():
    plain = PlugIn(point())
    assert (plain.name, plain.title) == ("ada", "ada")
    assert (plain.templates, plain.runtime) == (None, None)
    assert plain.reserved == frozenset({"begin", "end"})
    changed = type(
        "Changed",
        (Backend,),
        {"title": "Ada 2012", "templates": Path("t"), "runtime": Path("r")},
    )
    full = PlugIn(point(changed))
    assert (full.title, full.templates, full.runtime) == (
        "Ada 2012",
        Path("t"),
        Path("r"),
    )


def test_files_and_identifiers_are_those_of_the_backend():
    backend = PlugIn(point())
    assert list(backend.files(ICD, None)) == [
        (PurePosixPath("a.adb"), "text"),
        (PurePosixPath("b.bin"), b"\0"),
    ]
    assert all(type(path) is PurePosixPath for path, _ in backend.files(ICD, None))
    assert list(backend.identifiers(ICD)) == ["identifier"]


@pytest.mark.parametrize(
    ("package", "of"), [("icdgen-ada", " of icdgen-ada"), (None, "")]
)
def test_a_backend_of_another_name_than_its_entry_point_is_refused(package, of):
    with pytest.raises(UserError) as raised:
        PlugIn(point(name="lovelace", package=package))
    assert str(raised.value) == (
        f"the entry point `lovelace = their_ada:Backend`{of} leads to a backend "
        "called `ada`"
    )
    assert raised.value.help == (
        "it is a fault of that package, the two must be the same: report it to its "
        "makers"
    )


@pytest.mark.parametrize(
    ("backend", "reason"),
    [
        (ImportError("no module"), "ImportError: no module"),
        (KeyError(), "KeyError"),
        (object, "AttributeError: 'object' object has no attribute 'name'"),
        (SimpleNamespace, "AttributeError: "),
        (lambda: 1 // 0, "ZeroDivisionError: "),
    ],
)
def test_a_backend_that_cannot_be_loaded_is_reported_with_its_reason(backend, reason):
    with pytest.raises(UserError) as raised:
        PlugIn(point(backend))
    start = (
        "the backend `ada` of icdgen-ada (entry point `their_ada:Backend`) "
        f"cannot be loaded: {reason}"
    )
    text = str(raised.value)
    assert text.startswith(start) if reason.endswith(": ") else text == start
    assert isinstance(raised.value.__cause__, Exception)


def with_files(*files):
    return type("Changed", (Backend,), {"files": lambda self, icd, render: files})


@pytest.mark.parametrize(
    "file",
    [
        ("a.txt", "text"),
        (PurePosixPath("a.txt"), 7),
        (PurePosixPath("a.txt"), bytearray(b"a")),
    ],
)
def test_a_file_that_is_no_pair_of_path_and_content_is_refused(file):
    files = PlugIn(point(with_files((PurePosixPath("a"), "a"), file))).files(ICD, None)
    assert next(files) == (PurePosixPath("a"), "a")
    with pytest.raises(UserError) as raised:
        next(files)
    assert str(raised.value) == (
        "the backend `ada` of icdgen-ada (entry point `their_ada:Backend`) failed: "
        f"TypeError: `files` gives pairs of path and text or bytes, not {file!r:.100}"
    )


def test_a_failure_names_the_line_that_raised_it():
    def fail(self, icd):
        raise ValueError("no id")

    backend = PlugIn(point(type("Changed", (Backend,), {"identifiers": fail})))
    with pytest.raises(UserError) as raised:
        list(backend.identifiers(ICD))
    assert str(raised.value).endswith(" failed: ValueError: no id")
    line = fail.__code__.co_firstlineno + 1
    assert raised.value.help == (
        f"it is a fault of that package, in {__file__}, line {line}: report it to its "
        "makers"
    )


def test_an_error_that_a_backend_explains_itself_is_passed_on():
    def fail(self, icd):
        raise UserError("too many messages", "split the node")

    backend = PlugIn(point(type("Changed", (Backend,), {"identifiers": fail})))
    with pytest.raises(UserError, match=r"\Atoo many messages\Z") as raised:
        list(backend.identifiers(ICD))
    assert raised.value.help == "split the node"


def test_several_packages_with_one_name_are_reported_and_one_is_used():
    assert PlugIn.of([point()]).name == "ada"
    with pytest.raises(UserError) as raised:
        PlugIn.of([point(), point(package=None), point(package="other")])
    assert str(raised.value) == (
        "there are 3 backends `ada`: `their_ada:Backend` of icdgen-ada and "
        "`their_ada:Backend` and `their_ada:Backend` of other"
    )
    assert raised.value.help == "uninstall all but one"
