"""Golden vectors, produced by the reference codec and tested against the code of each
language.

`make` builds them and `write` formats them. ``vectors.schema.json`` in the parent
package defines the format.
"""
