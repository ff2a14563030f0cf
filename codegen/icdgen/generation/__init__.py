"""Generation of files from a checked model: rendering, comparison with the disk, and
writing.
"""
