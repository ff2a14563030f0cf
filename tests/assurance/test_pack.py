"""The files of the verification package: pages to print, tables for a spreadsheet, and
measurements of the same ICDs.
"""

from __future__ import annotations

import csv
import io
import json
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from icdgen.backends.assurance import measured
from icdgen.backends.assurance import pack as pack_module
from icdgen.cli import icdgen
from icdgen.errors import UserError
from icdgen.loading import load
from tests.site import hostile
from tests.site.conftest import program, tool

VALIDATE = Path(__file__).parent.parent / "site" / "npm" / ".htmlvalidate.json"


def make(icd: Path, out: Path, *more: str) -> Path:
    done = CliRunner().invoke(
        icdgen, ["--lang", "assurance", "--out", str(out), *more, str(icd)], obj={}
    )
    if isinstance(done.exception, Exception) and not isinstance(
        done.exception, SystemExit
    ):
        raise done.exception
    assert done.exit_code == 0, done.output
    return out


@pytest.fixture(scope="module")
def pack(tmp_path_factory) -> Path:
    """The package of ICDs with hostile texts."""
    folder = tmp_path_factory.mktemp("strange")
    return make(hostile.write(folder / "icd"), folder / "pack")


def test_the_pages_are_valid_html_without_script(pack):
    pages = sorted(pack.glob("*.html"))
    assert len(pages) > 2
    command = [
        program("node"),
        str(tool("html-validate/bin/html-validate.mjs")),
        "--config",
        str(VALIDATE),
        "-f",
        "text",
    ]
    done = subprocess.run([*command, *map(str, pages)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert not any("<script" in page.read_text("utf-8") for page in pages)


def test_every_link_of_the_pages_leads_to_a_file_of_the_pack(pack):
    links = {
        link
        for page in pack.glob("*.html")
        for link in re.findall(r'href="([^"]*)"', page.read_text("utf-8"))
    }
    assert links >= {"trace.csv", "changes.csv"} and all(
        (pack / link).is_file() for link in links
    )


def test_the_tables_are_csv_with_a_header_and_as_many_cells_in_each_row(pack):
    for path in pack.glob("*.csv"):
        data = path.read_bytes()
        assert b"\r\n" in data and data.endswith(b"\r\n")
        rows = list(
            csv.reader(io.StringIO(data.decode("utf-8"), newline=""), strict=True)
        )
        assert (
            len(rows) > 1
            and {len(row) for row in rows} == {len(rows[0])}
            and all(rows[0])
        )


def test_each_paper_names_the_digest_of_the_icds(pack, tmp_path):
    digest = measured.icd_digest(load([pack.parent / "icd"]).icd)
    assert all(digest in page.read_text("utf-8") for page in pack.glob("*.html"))


def measurement(demo: Path, **changes: object) -> dict:
    icd = load([demo]).icd
    return {
        "icdgen_measurement": 1, "name": "sizes", "title": "Sizes", "says": ["Bytes."], "icd": measured.icd_digest(icd),
        "code": {}, "made_by": ["a command"], "facts": [["All", "12"]], "columns": ["message", "bytes"], "rows": [["Roll", 12]],
        **changes,
    }  # fmt: skip


def write_measurement(folder: Path, data: object) -> Path:
    folder.mkdir()
    (folder / "sizes.json").write_text(json.dumps(data), "utf-8")
    return folder


def test_a_measurement_goes_into_the_pack(demo, tmp_path):
    folder = write_measurement(tmp_path / "measured", measurement(demo))
    out = make(demo, tmp_path / "pack", "--measured", str(folder))
    assert (out / "sizes.csv").read_bytes() == b"message,bytes\r\nRoll,12\r\n"
    assert "sizes.html" in (out / "index.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"icd": "0" * 64},
            "it measures other ICDs: the digest is 0000000000000000 there and ",
        ),
        (
            {"code": {"c": "0" * 64}},
            "it measures other code: the digest of `c` is 0000000000000000 there and ",
        ),
        ({"icdgen_measurement": 2}, "not a measurement"),
        ({"rows": [["Roll"]]}, "a row has not as many cells as there are columns"),
        ({"name": "../up"}, "`name` is no name for a file"),
        ({"columns": "bytes"}, "`columns` is missing or not of its kind"),
        ({"facts": [["All"]]}, "`facts` is missing or not of its kind"),
    ],
)
def test_a_measurement_of_something_else_is_rejected_and_nothing_is_written(
    demo, tmp_path, changes, message
):
    folder = write_measurement(tmp_path / "measured", measurement(demo, **changes))
    with pytest.raises(UserError, match=message) as caught:
        make(demo, tmp_path / "pack", "--measured", str(folder))
    assert str(folder / "sizes.json") in str(caught.value) and caught.value.help
    assert not (tmp_path / "pack").exists()


def test_a_measurement_of_this_very_code_is_taken(demo, tmp_path):
    from icdgen.backends.assurance.pack import code_now

    folder = write_measurement(
        tmp_path / "measured",
        measurement(demo, code={"c": code_now(load([demo]).icd, "c")}),
    )
    make(demo, tmp_path / "pack", "--measured", str(folder))


@pytest.mark.parametrize("text", ["", "[", "[]", "\0"])
def test_a_file_that_is_no_measurement_is_rejected(demo, tmp_path, text):
    (tmp_path / "measured").mkdir()
    (tmp_path / "measured" / "sizes.json").write_text(text)
    with pytest.raises(UserError, match=r"sizes\.json"):
        make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))


def test_measurements_are_rejected_for_other_outputs(demo, tmp_path):
    with pytest.raises(UserError, match="measurements go into the assurance pack only"):
        CliRunner().invoke(
            icdgen,
            ["--lang", "c", "--measured", str(tmp_path), str(demo)],
            obj={},
            catch_exceptions=False,
        )


def test_the_first_page_counts_elements_and_changes_of_each_node_and_of_all():
    def element(kind: str, *detected: dict) -> SimpleNamespace:
        changes = tuple(SimpleNamespace(detected=lines) for lines in detected)
        return SimpleNamespace(kind=kind, changes=changes)

    noticed, unnoticed = {"a": [1]}, {}
    elements = {
        "a": [
            element("node", noticed),
            *[element("message", noticed)] * 2,
            *[element("field", noticed, unnoticed, unnoticed)] * 500,
            element("struct"),
        ],
        "b": [
            element("enumeration"),
            *[element("member", noticed)] * 3,
            element("message"),
        ],
    }
    nodes = [SimpleNamespace(name=name, title=name.upper()) for name in elements]
    rows = pack_module._counts(SimpleNamespace(nodes=nodes), elements)
    assert rows == [
        ["A", "2", "500", "0", "0", "1,503", "1,000"],
        ["B", "1", "0", "1", "3", "3", "0"],
        ["All", "3", "500", "1", "3", "1,506", "1,000"],
    ]
    assert len(pack_module._COLUMNS) == len(rows[0])


def test_the_page_of_a_measurement_has_its_facts_tools_and_digests_in_this_order():
    page = pack_module._page_of_measurement(
        measured.Measurement(
            "sizes",
            "Sizes",
            ("Bytes.",),
            {"c": "1a", "python": "2b"},
            ("gcc 12", "size 2"),
            (("All", "12"),),
            ("message", "bytes"),
            [["Roll", "12"]],
        )
    )
    assert (page.file, page.title, page.data) == (
        "sizes.html",
        "Sizes",
        ("sizes.csv",),
    )
    assert page.facts == (
        ("All", "12"),
        ("Measured with", "gcc 12"),
        ("Measured with", "size 2"),
        ("Digest of the generated C", "1a"),
        ("Digest of the generated Python", "2b"),
    )
    assert [group.rows for group in page.groups] == [[["Roll", "12"]]]
    assert (page.says, page.columns) == (("Bytes.",), ("message", "bytes"))
