"""Conversion of log files to tables: listing, CSV, JSON lines and Parquet, in constant
memory.

The Python runtime computes calibrations. Importing this package makes it importable.
"""

from icdgen import shipped

shipped.provide_runtime()
