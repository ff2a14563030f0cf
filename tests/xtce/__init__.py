"""Generated XTCE files conform to the schema, can be imported again, and are decoded
alike by other programs.
"""
