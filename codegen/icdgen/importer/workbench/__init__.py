"""Local page for writing the rules of a profile: `icdgen import FILE --workbench`.

`session` holds the document and the profile and answers questions about them;
`rule_text` edits the profile as text, so that comments stay; `valid_rules` replaces
rules with errors by their last valid form; `server` serves the page (`page.html`,
`page.css`, `page.js`) and the answers as JSON.
"""
