"""Comparison of everything that two revisions of icdgen generate from the same ICDs."""
