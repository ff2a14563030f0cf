"""Rules of the diff.

Each rule is a pure function of a theme module; ``<theme>.md`` contains its explanation
and example.
"""
