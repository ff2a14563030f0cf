"""Conversion to CSV and JSON lines."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Sequence
from typing import TextIO

from icdgen.logfile.rows import Value


def to_csv(names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO) -> None:
    """Write the names of the columns and the rows as CSV: RFC 4180, but with LF.

    Missing values are empty.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    for values in rows:
        writer.writerow([_csv_value(value) for value in values])


def to_json_lines(
    names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO
) -> None:
    """Write an object for each row, without missing values.

    NaN and infinity become null, as JSON cannot represent them.
    """
    for values in rows:
        present = (
            (name, value)
            for name, value in zip(names, values, strict=True)
            if value is not None
        )
        record = {
            name: None if isinstance(v, float) and not math.isfinite(v) else v
            for name, v in present
        }
        file.write(json.dumps(record, ensure_ascii=False) + "\n")


def _csv_value(value: Value) -> Value:
    return str(value).lower() if isinstance(value, bool) else value
