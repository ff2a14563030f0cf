"""Pages of a PDF -> words and rules -> tables, headings and text."""
