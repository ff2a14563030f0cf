"""Rules of a profile, which state what each kind of table means.

`language` has the roles and patterns; `rule` reads and checks the rules of a profile;
`selection` decides which rule applies to a table; `rows` turns a table into rows;
`cells` takes roles out of rows; `fields` makes fields of roles; `interpret`, `build`
and `attach` put a document together; `explain` and `explore` show people what happens.
Start with `interpret`.
"""
