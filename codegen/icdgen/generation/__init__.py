"""Generation of files from a checked model: rendering, comparison with the disk, and
writing.

`generate.run` is the entry. `write` and ``manifest`` change only files that icdgen
wrote itself; ``differences`` is the output of ``--check``.
"""
