"""Comparison of two sets of ICDs: changes with their layer, their severity and the
parties that they affect.
"""
