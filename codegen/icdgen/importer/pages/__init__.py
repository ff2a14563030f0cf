"""Tables, headings and text of the pages of a PDF.

The steps, in order: `extract` reads words and ruling lines of a page, `furniture`
removes running heads and feet, `flow` makes items in reading order, `tables` assembles
them to tables and `captions` assigns their captions. `reading/pdf.py` calls them.
"""
