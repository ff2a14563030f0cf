"""The ICD: files, checks and the model of a device interface.

`load` reads files with their errata overlays, `source` parses YAML with the place of
each value, `schema` and the package `rules` check it, and `build` makes the objects of
`model` and `layout`. Read `load` first, then `model`.
"""
