"""Text and JSON forms of ICDs with their errata applied, for ``icdgen show``.

``people`` writes the text, with the table of ``fields``; ``machine`` writes JSON, which
`icdgen diff` can read again.
"""
