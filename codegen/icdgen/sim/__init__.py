"""Simulated device, generated from its ICD, for `icdgen sim`.

`computer.Computer` is the device, without clock and without I/O; `program.Program` is
the program that it runs. `line.UartLine` connects it to a UART,
`framed_line.FramedLine` to a link with a packet format, with faults on demand
(``faults``). `run` builds the device, ``control`` executes scripts, and ``serve``
carries the line over a pseudo-terminal, TCP or UDP. Framing, checksums, logs and index
files use the Python runtime. Importing this package makes it importable.
"""

from icdgen import shipped

shipped.provide_runtime()
