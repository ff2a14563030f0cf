"""Facts that a user of generated code relies on in every language: stated once, and
checked by statements of C, Python and Rust.

A module per subject has a `Story`: an ICD and claims about the code that is generated
from it. `test_stories` compiles all stories of a language as one program. Tests of what
only one language has (columns, clippy, MISRA) are in the folder of that language.
"""
