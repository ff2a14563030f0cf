"""Conversion of log files to tables: listing, CSV, JSON lines and Parquet, in constant
memory.

`log.open_log` opens a log file of a device (``source``, ``columns``, ``rows``,
``parquet``) or a recording of a link (``recording``, ``sheet``, ``sheet_parquet``),
both with the interface of `log.Log`. ``integrity`` finds damaged parts of log files.

The Python runtime computes calibrations. Importing this package makes it importable.
"""

from icdgen import shipped

shipped.provide_runtime()
