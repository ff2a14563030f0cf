"""Measures the golden vectors: one number of the ICD is changed at a time, and the
unchanged vectors must notice.
"""
