"""Claims over intervals of a diagram's values: proved over the whole box, refuted, or checked.

`box` says which values vary, `family` writes the diagram with these as symbols, `conditions` turns
a claim into polynomials, `bernstein` shows their signs over the box in exact arithmetic, `worst`
searches the box for where the claim fails, and `over_box` puts all of that together.
"""
