"""The rules of the diff. Each is one pure function of a theme module; its explanation and example stand in ``<theme>.md``."""
