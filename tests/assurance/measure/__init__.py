"""Commands that measure generated code with compilers.

They write files for `icdgen --lang assurance --measured`.
"""
