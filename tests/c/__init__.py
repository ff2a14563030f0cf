"""The C that is generated: it compiles everywhere, and does what the reference codec
does.
"""
