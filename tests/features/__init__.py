"""Which output has which feature of the format: measured, and the page of the documents
that is made of it.
"""
