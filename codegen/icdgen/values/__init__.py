"""Decoding and encoding single messages with the reference codec: ``icdgen decode`` and
``icdgen encode``.
"""
