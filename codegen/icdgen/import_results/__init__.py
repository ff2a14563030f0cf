"""Results of an import, of a manual or of definitions: findings, ICD files, and their
reports.
"""
