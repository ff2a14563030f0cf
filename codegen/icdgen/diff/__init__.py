"""Comparison of two sets of ICDs: changes with their layer, their severity and the
parties that they affect.

`icdgen.diff.report.make_report` runs all steps: `match` pairs the objects of both
sides, `compare` runs the rules in `changes` on these pairs, `compatibility` and
`version` evaluate the result, and `reports` writes it. ``inputs`` reads the two sides.
"""
