"""Rendering of the site, and writing it to a folder."""

from __future__ import annotations

import pytest

from icdgen.backends.html import guide
from icdgen.backends.packages import Packages
from icdgen.errors import UserError
from icdgen.site.make import Site, make_site, write_site
from tests.icd.files import status, write

FIELD = "at: 0, bits: 8, name: Level, type: uint"


@pytest.fixture(autouse=True)
def without_guide(monkeypatch):
    """Leave out the documentation of icdgen, which takes long to render."""
    monkeypatch.setattr(guide, "pages", tuple)


def test_a_site_has_its_pages_and_the_files_on_which_it_depends(tmp_path):
    path = write(tmp_path, status(FIELD, length=1))
    watched = []

    def watch(files):
        for name, page in files:
            watched.append(str(name))
            yield name, page

    site = make_site(
        [path], packages=Packages(c="probe", rust="probe_icd"), watch=watch
    )
    assert site.ok and site.findings == []
    assert list(site.files) == watched and "demo/status.html" in watched
    page = site.files["demo/status.html"]
    assert "probe_demo_status_t" in page and "probe_icd::demo" in page
    assert "changes.html" not in site.files
    assert path in site.inputs


def test_own_templates_are_among_the_files_on_which_a_site_depends(tmp_path):
    path = write(tmp_path, status(FIELD, length=1))
    folder = tmp_path / "templates" / "html"
    folder.mkdir(parents=True)
    (folder / "units.html.j2").write_text("own {{ types | length }}")
    site = make_site([path], templates=folder.parent)
    assert site.files["units.html"] == "own 7"
    assert {path, folder / "units.html.j2", folder / "style.css"} <= set(site.inputs)


def test_icds_with_errors_have_findings_and_no_pages(tmp_path):
    path = write(tmp_path, status(FIELD, length=0))
    site = make_site([path], "no such release")
    assert not site.ok and site.files == {}
    assert [finding.severity for finding in site.findings][:1] == ["error"]
    assert site.texts[site.findings[0].place.file].startswith("icdgen: 1\n")
    assert path in site.inputs


@pytest.mark.parametrize("length", [1, 0])
def test_an_older_release_with_errors_prevents_the_site(tmp_path, length):
    for name, size in (("new", 1), ("old", length)):
        (tmp_path / name).mkdir()
        write(tmp_path / name, status(FIELD, length=size))
    site = make_site([tmp_path / "new"], str(tmp_path / "old"))
    assert site.ok == bool(length) == ("changes.html" in site.files)
    files = {finding.place.file for finding in site.findings}
    assert bool(files) != site.ok
    assert all("old" in name and name in site.texts for name in files)


def test_a_release_that_cannot_be_read_is_an_error(tmp_path):
    path = write(tmp_path, status(FIELD, length=1))
    with pytest.raises(UserError):
        make_site([path], "no such release")


def test_a_check_writes_nothing(tmp_path):
    site = Site(True, [], {}, {"index.html": "one\n", "demo/a.html": "two\n"})
    assert write_site(site, tmp_path / "out", check=True) is not None
    assert not (tmp_path / "out").exists()
    write_site(site, tmp_path / "out")
    written = {
        path.relative_to(tmp_path / "out").as_posix(): path.read_text()
        for path in (tmp_path / "out").rglob("*.html")
    }
    assert written == site.files
