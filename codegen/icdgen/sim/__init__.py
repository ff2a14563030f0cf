"""A device made from its ICD, for tests and for trying things out: what `icdgen sim` runs.

`computer.Computer` is the device, without clock and without I/O; `line.Line` puts it on a UART with faults on demand;
`serve` carries that line over a pseudo-terminal, TCP or UDP. Framing, checksums, logs, hole maps and index files are those of the
Python runtime, which importing this makes importable; what a device does with them is here.
"""

from icdgen import shipped

shipped.provide_runtime()
