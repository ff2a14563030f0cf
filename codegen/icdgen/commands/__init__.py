"""Commands of ``icdgen``: options, a call into the library, and output.

They contain no logic. `icdgen.cli` finds a command by the name of its module, and
imports it only when it is used; so the modules import the library inside of functions.
"""
