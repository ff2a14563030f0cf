"""Commands that measure generated code with compilers and write what they found for
`icdgen --lang assurance --measured`.
"""
