"""Commands of ``icdgen``: options, a call into the library, and output.

They contain no logic.
"""
