"""Measures which output supports which feature of the format, and writes the page of
the documents about it.
"""
