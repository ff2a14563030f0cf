"""Golden vectors, produced by the reference codec and tested against the code of each
language.

`make` builds the vectors of messages and `write` formats them; `protocol` builds the
vectors of links, clients and procedures, with the requests in ``wire``.
``vectors.schema.json`` and ``protocol.schema.json`` in the parent package define the
formats.
"""
