"""Log files as tables: what is in them, and CSV, JSON lines and Parquet made of them, in constant memory.

Physical values by curves are those of the Python runtime, which importing this makes importable.
"""

from icdgen import shipped

shipped.provide_runtime()
