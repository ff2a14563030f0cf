"""Rows at page breaks, drawn line by line like engines place them, never move to the
next row.
"""

from __future__ import annotations

from pathlib import Path

from reportlab.pdfgen.canvas import Canvas

from tests.importer.conftest import imported

COLUMNS = (40, 90, 140, 240, 300)  # where the cells of a message's table begin
HEADS = ["Offset", "Length", "Name", "Data Type", "Description"]
STEP = 11  # points from line to line of a cell


class Sheet:
    """Text at positions on pages; y grows downwards."""

    def __init__(self, path: Path) -> None:
        self.canvas = Canvas(str(path), pagesize=(500, 400), invariant=1)

    def line(
        self,
        y: float,
        *cells: str,
        columns: tuple[int, ...] = COLUMNS,
        bold: bool = False,
    ) -> None:
        self.canvas.setFont("Helvetica-Bold" if bold else "Helvetica", 8)
        for x, text in zip(columns, cells, strict=False):
            self.canvas.drawString(x, 400 - y, text)

    def down(self, top: float, bottom: float, *places: float) -> None:
        for x in places:
            self.canvas.line(x, 400 - top, x, 400 - bottom)

    def across(self, y: float, x0: float, x1: float) -> None:
        self.canvas.line(x0, 400 - y, x1, 400 - y)

    def page(self) -> None:
        self.canvas.showPage()

    def message(self) -> None:
        """Draw the start of a message with one field of 16 bits."""
        self.line(250, "Table 1: Pump State Telemetry Format", bold=True)
        self.line(270, "ID", "140", "Frame Length (bytes)", "4")
        self.line(
            290,
            *[f"{title} (bits)" if i < 2 else title for i, title in enumerate(HEADS)],
            bold=True,
        )


def fields(path: Path) -> list[tuple[str, str | None]]:
    _, trees = imported(path)
    [message] = next(iter(trees.values()))["messages"]
    return [(field["name"], field.get("formula")) for field in message["fields"]]


def test_the_end_of_a_row_above_the_only_other_row_of_a_page_stays_with_its_row(
    tmp_path,
):
    sheet = Sheet(tmp_path / "pump.pdf")
    sheet.message()
    sheet.line(310, "0", "16", "Speed", "UINT", "Formatted value is obtained using")
    sheet.down(280, 330, 36, 86, 136, 236, 296, 460)
    sheet.page()
    sheet.line(
        60,
        *[f"{title} (bits)" if i < 2 else title for i, title in enumerate(HEADS)],
        bold=True,
    )
    sheet.line(80, "", "", "", "", "the formula: (formatted value) = RAWVAL*0.5")
    sheet.line(100, "16", "16", "Flow", "UINT", "Formatted value is obtained using")
    sheet.line(
        100 + STEP, "", "", "", "", "the formula: (formatted value) = RAWVAL*0.25"
    )
    sheet.down(50, 120, 36, 86, 136, 236, 296, 460)
    sheet.page()
    sheet.canvas.save()
    assert fields(tmp_path / "pump.pdf") == [("Speed", "raw*0.5"), ("Flow", "raw*0.25")]


def test_a_line_above_the_key_of_a_row_centred_in_height_begins_that_row(tmp_path):
    sheet = Sheet(tmp_path / "pump.pdf")
    sheet.message()
    sheet.line(310, "0", "8", "Mode", "UINT", "How it runs")
    sheet.down(280, 330, 36, 86, 136, 236, 296, 460)
    sheet.page()
    for row, at in enumerate((8, 16, 24)):
        y = 60 + 40 * row
        sheet.line(y, "", "", "", "", "Formatted value is obtained")
        sheet.line(y + STEP / 2, "", "", f"Channel {row}")
        sheet.line(y + STEP, str(at), "8", "", "UINT", "using the formula:")
        sheet.line(y + 1.5 * STEP, "", "", "of the pump")
        sheet.line(y + 2 * STEP, "", "", "", "", "(formatted value) = RAWVAL*0.5")
    sheet.down(45, 180, 36, 86, 136, 236, 296, 460)
    sheet.page()
    sheet.canvas.save()
    assert fields(tmp_path / "pump.pdf") == [
        ("Mode", None),
        *[(f"Channel {n} of the pump", "raw*0.5") for n in range(3)],
    ]


LIST = (40, 62, 84, 200, 400)


def groups(path: Path) -> dict[str, str | None]:
    """Return the groups of the messages by name."""
    _, trees = imported(path)
    return {
        message["name"]: message.get("group")
        for message in next(iter(trees.values()))["messages"]
    }


def listing(sheet: Sheet, y: float, rows: list[tuple[str, ...]]) -> float:
    for row in rows:
        sheet.line(y, *row, columns=LIST, bold=len(row) == 1)
        y += 16
    return y


MESSAGES = [("21", "136", "Pump Setting", "Table 2: Pump Setting Message Format", "1"),
            ("22", "137", "Valve Setting", "Table 3: Valve Setting Message Format", "1")]  # fmt: skip
TITLES = ("Set", "Get", "Name", "Description", "Length (bytes)")


def formats(sheet: Sheet, y: float) -> None:
    """Return the formats of the messages of the list."""
    for number, (first_id, two, name, _, _) in enumerate(MESSAGES, 2):
        sheet.line(y, f"Table {number}: {name} Message Format", bold=True)
        sheet.line(
            y + 16, "Set ID/Get ID", f"{first_id}/{two}", columns=(40, 110), bold=True
        )
        sheet.line(
            y + 16, "Parameters Length (bytes)", "1", columns=(200, 330), bold=True
        )
        sheet.line(
            y + 32,
            *[f"{title} (bits)" if i < 2 else title for i, title in enumerate(HEADS)],
            bold=True,
        )
        sheet.line(y + 48, "0", "8", "Level", "UINT", "How much")
        y += 80


def test_a_group_heading_wider_than_the_column_of_ids_below_it_is_one(tmp_path):
    sheet = Sheet(tmp_path / "pump.pdf")
    sheet.line(60, "Table 1: List of Pump Configuration Messages", bold=True)
    sheet.line(80, *TITLES, columns=LIST, bold=True)
    sheet.line(80 + STEP, "ID", "ID", columns=LIST, bold=True)
    listing(sheet, 110, [("Configuration",), *MESSAGES])
    formats(sheet, 190)
    sheet.page()
    sheet.canvas.save()
    assert groups(tmp_path / "pump.pdf") == {
        "Pump Setting": "Configuration",
        "Valve Setting": "Configuration",
    }


def test_a_group_heading_that_ends_a_page_below_the_rules_of_its_list_is_one(tmp_path):
    columns = (40, 80, 120, 210, 400)
    sheet = Sheet(tmp_path / "pump.pdf")
    sheet.line(250, "Table 1: List of Pump Configuration Messages", bold=True)
    for top, rows in (
        (262, [("Set ID", "Get ID", *TITLES[2:]), MESSAGES[0]]),
        (52, [MESSAGES[1]]),
    ):
        for index, row in enumerate(rows):
            sheet.line(top + 11 + 16 * index, *row, columns=columns)
        bottom = top + 16 * len(rows)
        sheet.across(bottom, 34, 470)
        sheet.across(top + 16, 34, 470)
        sheet.down(top, bottom, 76, 116, 206, 396)
        if top > 60:
            sheet.line(bottom + 11, "Access", bold=True)
            sheet.page()
    formats(sheet, 120)
    sheet.page()
    sheet.canvas.save()
    assert groups(tmp_path / "pump.pdf") == {
        "Pump Setting": None,
        "Valve Setting": "Access",
    }


def test_group_headings_over_all_columns_do_not_part_a_table_whose_sides_run_along_it(
    tmp_path,
):
    columns = (40, 80, 120, 210, 400)
    sheet = Sheet(tmp_path / "pump.pdf")
    sheet.line(250, "Table 1: List of Pump Configuration Messages", bold=True)
    sheet.line(273, "Set ID", "Get ID", *TITLES[2:], columns=columns)
    sheet.across(262, 34, 470)
    sheet.across(278, 34, 470)
    sheet.down(262, 278, 34, 76, 116, 206, 396, 470)
    sheet.page()
    sheet.across(50, 34, 470)  # below the running head, as wide as the table
    sheet.down(50, 120, 34, 470)  # the sides; top and bottom are on other pages
    for top, group, row in ((50, "Access", MESSAGES[0]), (85, "Control", MESSAGES[1])):
        sheet.line(top + 11, group, bold=True)
        sheet.line(top + 27, *row, columns=columns)
        sheet.down(top + 16, top + 33, 76, 116, 206, 396)
    formats(sheet, 160)
    sheet.page()
    sheet.canvas.save()
    assert groups(tmp_path / "pump.pdf") == {
        "Pump Setting": "Access",
        "Valve Setting": "Control",
    }


def test_a_table_whose_first_cell_is_empty_is_read_or_reported(tmp_path):
    sheet = Sheet(tmp_path / "pump.pdf")
    formats(sheet, 60)
    for y, row in ((250, ("", "Shade", "Hue")), (262, ("", "dark", "red"))):
        sheet.line(y, *row)
        sheet.across(y - 9, 36, 236)
    sheet.across(265, 36, 236)
    sheet.down(241, 265, 36, 86, 136, 236)
    sheet.page()
    sheet.canvas.save()
    result, _ = imported(tmp_path / "pump.pdf")
    assert "Shade | Hue" in [
        " | ".join(filter(None, table.titles)) for table in result.tables
    ]
