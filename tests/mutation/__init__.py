"""Measures how well the golden vectors detect changes: one number of the ICD is changed
at a time, and the unchanged vectors must fail.
"""
