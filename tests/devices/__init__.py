"""Public definitions of other devices, held by the format and compared with the library
that everybody trusts.

``python -m tests.devices`` turns the tables of these libraries into ICDs, drops what
`icdgen check` refuses, generates code, and compares each value that it reads with the
library's. Nothing of the libraries is kept: their definitions are read where they are
installed.
"""
