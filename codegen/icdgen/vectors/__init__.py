"""Golden vectors, made by the reference codec alone: what every language's code is held to.

`make` builds them, `write` lays them out; their form is described by ``vectors.schema.json`` beside this package.
"""
