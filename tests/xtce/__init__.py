"""XTCE that is generated: the schema of the standard, what is read back of it, and what
other programs decode with it.
"""
