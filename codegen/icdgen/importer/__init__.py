"""Import of a vendor's document as reviewable ICDs: ``icdgen import``.

The steps, in order: `reading` makes a `document` of a file of any kind (`pages` finds
the tables of a PDF), `rules` give the tables a meaning according to a `profile`,
`assemble` builds a tree for each node, and `console` and `html` report the result.
`run` connects the steps; read it first. `workbench` applies them while a profile is
being written.
"""
