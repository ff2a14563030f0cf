"""Public definitions of devices, converted to ICDs and compared with their established
libraries.

``python -m tests.devices`` turns the tables of these libraries into ICDs, drops what
`icdgen check` rejects, generates code, and compares each value that it decodes with the
library's value. The repository contains no part of the libraries: their definitions are
read where they are installed.
"""
