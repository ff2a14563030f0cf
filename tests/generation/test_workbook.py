"""The workbook for reviews: formatted, without formulas, and the same bytes in each
run.
"""

from __future__ import annotations

import io
import time
import zipfile

import pytest

from icdgen.backends.tables import XlsxBackend
from icdgen.backends.tables.rows import HEADINGS
from icdgen.backends.tables.workbook import WIDEST
from tests.icd.files import loaded

openpyxl = pytest.importorskip("openpyxl", reason="pip install 'icdgen[import]'")

ICD = f"""\
messages:
  - {{name: Stop, id: 0, kind: telecommand, length: 0, summary: "=1+1"}}
  - {{name: Last, id: 255, kind: telecommand, length: 0, summary: {"x" * 70}}}
"""


@pytest.fixture
def icd(tmp_path):
    return loaded(tmp_path, ICD).icd


def data_of(icd):
    ((path, data),) = XlsxBackend().files(icd, None)
    assert str(path) == "demo.xlsx"
    return data


def test_title_and_headings_stay_visible_above_rows_that_can_be_filtered(icd):
    book = openpyxl.load_workbook(io.BytesIO(data_of(icd)))
    (sheet,) = book
    assert sheet.title == "Messages"
    assert sheet["A1"].value == "Demo (demo): little-endian, lsb0"
    assert [cell.value for cell in sheet[2]] == HEADINGS
    assert all(cell.font.bold for cell in sheet[2])
    assert not any(cell.font.bold for cell in sheet[3])
    assert [cell.value for cell in sheet[3]][:2] == ["Stop", 0]
    assert [cell.value for cell in sheet[4]][:2] == ["Last", 255]
    assert sheet.freeze_panes == "A3"
    assert sheet.auto_filter.ref == "A2:Z4"
    assert book.properties.creator == "icdgen"


def test_a_text_that_looks_like_a_formula_is_a_text(icd):
    sheet = openpyxl.load_workbook(io.BytesIO(data_of(icd))).active
    cell = sheet.cell(3, HEADINGS.index("Message description") + 1)
    assert (cell.value, cell.data_type) == ("=1+1", "s")


def test_columns_are_as_wide_as_their_longest_text_up_to_a_limit(icd):
    sheet = openpyxl.load_workbook(io.BytesIO(data_of(icd))).active

    def width(heading):
        letter = openpyxl.utils.get_column_letter(HEADINGS.index(heading) + 1)
        return sheet.column_dimensions[letter].width

    assert width("Message") == len("Message") + 2
    assert width("Kind") == len("telecommand") + 2
    assert width("Message description") == WIDEST == 60


def test_a_workbook_has_the_same_bytes_at_any_time(icd, monkeypatch):
    first = data_of(icd)
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        assert data_of(icd) == first
    finally:
        monkeypatch.undo()
        time.tzset()
    with zipfile.ZipFile(io.BytesIO(first)) as archive:
        for info in archive.infolist():
            assert info.date_time == (1980, 1, 1, 0, 0, 0)
            assert info.compress_type == zipfile.ZIP_STORED
        core = archive.read("docProps/core.xml").decode()
    assert core.count("1980-01-01T00:00:00Z") == 2
