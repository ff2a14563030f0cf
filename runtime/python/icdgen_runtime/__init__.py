"""Runtime of the generated messages.

The generator copies these modules into each generated package.
"""
