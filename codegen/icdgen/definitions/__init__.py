"""Import of existing message definitions, such as DBC or XTCE, as ICDs.

The module `kinds` lists the readers.
"""
