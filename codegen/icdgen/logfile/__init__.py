"""Log files as tables: what is in them, and CSV, JSON lines and Parquet made of them, in constant memory."""
