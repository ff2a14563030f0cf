"""Manuals drawn from ICDs, in layouts that differ in everything that a page can differ
in.
"""
