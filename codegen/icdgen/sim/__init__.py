"""Simulated device, generated from its ICD, for `icdgen sim`.

`computer.Computer` is the device, without clock and without I/O. `line.Line` connects
it to a UART, with faults on demand. `serve` carries that line over a pseudo-terminal,
TCP or UDP. Framing, checksums, logs and index files use the Python runtime.
Importing this package makes it importable.
"""

from icdgen import shipped

shipped.provide_runtime()
