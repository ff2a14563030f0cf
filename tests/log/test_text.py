"""CSV and JSON lines: the complete text of rows with values of each kind."""

from __future__ import annotations

import io
import math

import pytest

from icdgen.logfile.text import to_csv, to_json_lines

NAMES = ["time", "a", "b"]


@pytest.mark.parametrize(
    ("rows", "csv", "json"),
    [
        ([], "time,a,b\n", ""),
        (
            [["t", 0, False], ["u", None, True]],
            "time,a,b\nt,0,false\nu,,true\n",
            '{"time": "t", "a": 0, "b": false}\n{"time": "u", "b": true}\n',
        ),
        (
            [["", 0.0, "True"]],
            "time,a,b\n,0.0,True\n",
            '{"time": "", "a": 0.0, "b": "True"}\n',
        ),
        (
            [["t", math.nan, -math.inf]],
            "time,a,b\nt,nan,-inf\n",
            '{"time": "t", "a": null, "b": null}\n',
        ),
        (
            [["a,b", 'say "x"', "one\ntwo"]],
            'time,a,b\n"a,b","say ""x""","one\ntwo"\n',
            '{"time": "a,b", "a": "say \\"x\\"", "b": "one\\ntwo"}\n',
        ),
        (
            [["°C", 2**64 - 1, 1e-7]],
            "time,a,b\n°C,18446744073709551615,1e-07\n",
            '{"time": "°C", "a": 18446744073709551615, "b": 1e-07}\n',
        ),
    ],
)
def test_rows_have_this_text(rows, csv, json):
    for write, expected in ((to_csv, csv), (to_json_lines, json)):
        file = io.StringIO()
        write(NAMES, rows, file)
        assert file.getvalue() == expected


def test_a_row_with_another_number_of_values_is_refused():
    with pytest.raises(ValueError, match="shorter"):
        to_json_lines(NAMES, [["t", 1]], io.StringIO())
